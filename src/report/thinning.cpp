#include "thinning.hpp"

#include <algorithm>
#include <cmath>

namespace ajar {
namespace {

/// Peaks are kept per window of this many shown rows: ten at 100 Hz are 0.1 s, about a pixel of a plot of a minute.
constexpr std::size_t kWindow = 10;

/// The row in [begin, end) with the extreme value by `better`; end if no value is finite.
template <typename Better>
std::size_t extreme(const std::vector<double>& values, std::size_t begin, std::size_t end, Better better) {
  std::size_t best = end;
  for (std::size_t i = begin; i < end; ++i) {
    if (std::isfinite(values[i]) && (best == end || better(values[i], values[best]))) best = i;
  }
  return best;
}

}  // namespace

std::vector<std::size_t> choose_rows(const ThinningInput& input, double period) {
  const std::size_t rows = input.time.size();
  if (rows == 0) return {};
  std::vector<bool> keep(rows, false);
  keep.front() = keep.back() = true;
  const double tick = rows > 1 ? (input.time.back() - input.time.front()) / static_cast<double>(rows - 1) : period;
  const auto step = static_cast<std::size_t>(std::max(1.0, std::round(period / std::max(tick, 1e-9))));
  for (std::size_t i = 0; i < rows; i += step) keep[i] = true;
  for (std::size_t i = 1; i < rows; ++i) {
    if (input.phase[i] != input.phase[i - 1]) keep[i] = keep[i - 1] = true;
  }
  for (const auto* values : input.peaked) {
    for (std::size_t begin = 0; begin < rows; begin += step * kWindow) {
      const std::size_t end = std::min(rows, begin + step * kWindow);
      const std::size_t peak = extreme(*values, begin, end, std::greater<>());
      if (peak < end) keep[peak] = true;
    }
  }
  for (const auto* values : input.ranged) {
    for (const std::size_t row : {extreme(*values, 0, rows, std::greater<>()), extreme(*values, 0, rows, std::less<>())}) {
      if (row < rows) keep[row] = true;
    }
  }
  std::vector<std::size_t> chosen;
  for (std::size_t i = 0; i < rows; ++i) {
    if (keep[i]) chosen.push_back(i);
  }
  return chosen;
}

}  // namespace ajar
