#include "statistics.hpp"

#include <algorithm>
#include <cmath>

namespace ajar {

bool MovingMean::push(double value) noexcept {
  if (!std::isfinite(value)) return false;
  ring_[count_ % ring_.size()] = value;
  ++count_;
  return count_ >= ring_.size();
}

double MovingMean::mean() const noexcept {
  double sum = 0.0;
  for (const double value : ring_) sum += value;
  return sum / static_cast<double>(ring_.size());
}

void raise(std::optional<double>& kept, double value) noexcept {
  if (std::isfinite(value) && (!kept || value > *kept)) kept = value;
}

void lower(std::optional<double>& kept, double value) noexcept {
  if (std::isfinite(value) && (!kept || value < *kept)) kept = value;
}

std::optional<double> quantile(std::vector<double>& values, double p) {
  if (values.empty()) return std::nullopt;
  std::sort(values.begin(), values.end());
  const double place = std::clamp(p, 0.0, 1.0) * static_cast<double>(values.size() - 1);
  const auto below = static_cast<std::size_t>(place);
  const std::size_t above = std::min(below + 1, values.size() - 1);
  return values[below] + (place - static_cast<double>(below)) * (values[above] - values[below]);
}

TickTimes tick_times(std::vector<float> tick_us) {
  std::vector<double> values(tick_us.begin(), tick_us.end());
  TickTimes times;
  times.p50 = quantile(values, 0.50).value_or(0.0);
  times.p99 = quantile(values, 0.99).value_or(0.0);
  times.p999 = quantile(values, 0.999).value_or(0.0);
  times.max = values.empty() ? 0.0 : values.back();
  return times;
}

}  // namespace ajar
