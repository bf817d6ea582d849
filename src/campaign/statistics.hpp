#pragma once

#include <optional>
#include <vector>

#include "ajar/campaign/result.hpp"

namespace ajar {

/// Mean over the last n samples; summed anew each time so that no rounding error builds up (n is about ten).
class MovingMean {
 public:
  /// @param samples  n ≥ 1
  explicit MovingMean(int samples) : ring_(static_cast<std::size_t>(samples), 0.0) {}
  void clear() noexcept { count_ = 0; }
  /// Takes a sample; true once n samples are there. Samples that are not finite are left out.
  bool push(double value) noexcept;
  [[nodiscard]] double mean() const noexcept;

 private:
  std::vector<double> ring_;
  std::size_t count_ = 0;
};

/// Keeps the larger of what is there and a finite value.
void raise(std::optional<double>& kept, double value) noexcept;
/// Keeps the smaller of what is there and a finite value.
void lower(std::optional<double>& kept, double value) noexcept;

/// Quantile p of values by linear interpolation between order statistics; empty for no values. Sorts `values`.
[[nodiscard]] std::optional<double> quantile(std::vector<double>& values, double p);

[[nodiscard]] TickTimes tick_times(std::vector<float> tick_us);

}  // namespace ajar
