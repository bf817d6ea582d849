#pragma once

namespace ajar {

/// Closing damping of a closer, spread evenly over EN sizes 1-7 between the 40 and 120 N m s/rad of the closers that the
/// door table was made with. [N m s/rad]
[[nodiscard]] constexpr double closing_damping_of_size(int size) noexcept { return 40.0 + 80.0 * (size - 1) / 6.0; }

}  // namespace ajar
