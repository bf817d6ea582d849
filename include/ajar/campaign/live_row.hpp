#pragma once

#include <string>
#include <vector>

#include "ajar/campaign/judge.hpp"

namespace ajar {

/// One tick as numbers for a page that shows a run while it goes on: the columns that the page of a finished run shows,
/// without means over time.
class LiveRow {
 public:
  /// @param joints  Number of arm joints
  LiveRow(JointKind kind, int joints);

  [[nodiscard]] const std::vector<std::string>& names() const noexcept { return names_; }

  /// Fills the values of a tick, shape (names().size()); NaN = nothing to show. No allocation, no exception.
  void fill(const TickView& tick, std::vector<double>& values) const noexcept;

 private:
  bool slide_;
  int joints_;
  std::vector<std::string> names_;
};

/// Names of all phases; a row has the index of its phase.
[[nodiscard]] std::vector<std::string> phase_names();

}  // namespace ajar
