#pragma once

#include "ajar/core/random.hpp"
#include "ajar/mechanism/builders.hpp"

namespace ajar {

/// Largest force along the handle's way that a drawn mechanism may need anywhere on its travel [N].
inline constexpr double kLargestDrawnForce = 40.0;

/// Draws a door, cabinet door or drawer to pull: 60 % hinges (r 0.3-0.95 m, both sides, stop at 80-115°, 5-40 kg scaled
/// by r / 0.9, friction 0.5-4 N m), of which 20 % with a closer of 10-25 N and 15 % with a seal of 10-30 N at the handle;
/// 40 % drawers (0.3-0.5 m, 3-30 kg, friction 2-12 N). Breakaway 1-1.5. Bars stand or lie with either kind.
/// Set-up only.
[[nodiscard]] MechanismConfig sample_pull(Random& random);

/// Draws an oven or dishwasher: horizontal hinge below, r 0.35-0.5 m, stop at 86-93°, springs that carry 60-110 % of the
/// weight. Set-up only.
[[nodiscard]] MechanismConfig sample_oven(Random& random);

/// Draws a sliding door to either side: 10-50 kg, friction 5-20 N, travel 0.6-0.9 m, upright bar. Set-up only.
[[nodiscard]] MechanismConfig sample_sliding(Random& random);

/// Draws a door to push through: r 0.7-0.95 m, both sides, stop at 80-115°, 10-40 kg, friction 0.5-4 N m. Set-up only.
[[nodiscard]] MechanismConfig sample_push(Random& random);

/// Draws a hinge (65 %) or slide of any kind: radius 0.2-1.2 m; axes upright, level above or below the handle, or at any
/// tilt; doors that open away among the upright ones; drawers askew by up to 15°, doors that slide along the wall, sashes.
/// A quarter each runs freely (0.5-4 N), rubs (4-20 N), has a spring (2-15 N at rest and as much again over its way) or a
/// closer (8-20 N). Set-up only.
[[nodiscard]] MechanismConfig sample_any(Random& random);

}  // namespace ajar
