#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace ajar {

/// What decides which rows of a log are kept.
struct ThinningInput {
  const std::vector<double>& time;                 ///< [s]
  const std::vector<std::string>& phase;           ///< Every change of phase is kept
  std::vector<const std::vector<double>*> peaked;  ///< Curves that keep their largest value of every window
  std::vector<const std::vector<double>*> ranged;  ///< Curves that keep their smallest and largest value of the run
};

/// Rows to show, ascending: one per `period` [s], the first and the last, and the extremes of the input's curves.
[[nodiscard]] std::vector<std::size_t> choose_rows(const ThinningInput& input, double period);

}  // namespace ajar
