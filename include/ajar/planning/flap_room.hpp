#pragma once

#include "ajar/navigation/navigator.hpp"
#include "ajar/planning/grasp_planner.hpp"

namespace ajar {

/// What a base keeps out of beside a flap that stands open by `angle` [rad]: the wall and what it covers of the floor.
/// @param belief  Position and standoff are those of the closed handle
[[nodiscard]] KeepOut beside_flap(const HandleBelief& belief, const FlapPress& press, double angle) noexcept;

/// How far a base drives straight on, forward positive, until it can turn on the spot beside it: the shorter of both senses,
/// never towards the wall. (docs/equations.md#press)
/// @return 0 where it can turn already, or nothing gets it there [m]
[[nodiscard]] double way_off_flap(const BasePose& base, const KeepOut& flap) noexcept;

}  // namespace ajar
