#pragma once

#include <array>

#include "ajar/model/clearance.hpp"
#include "ajar/planning/grasp_planner.hpp"

namespace ajar {

/// Axes of a leaf or wall as the robot sees it: to the right, into the wall, up; right-handed for every horizontal normal.
/// @param normal  Outward, not vertical; its horizontal part counts
[[nodiscard]] Matrix3d leaf_axes(const Vector3d& normal) noexcept;

/// The wall behind a closed handle as an obstacle: an upright slab whose face stands 2 cm before the leaf.
[[nodiscard]] Box believed_wall(const HandleBelief& belief) noexcept;

/// The same wall for a normal that was misread to either side: beside the handle a wall stands nearer than it looks.
/// @param share  Of the largest misreading, 0 … 1
[[nodiscard]] std::array<Box, 2> misread_walls(const HandleBelief& belief, double share) noexcept;

/// Leaf of which only the handle is known: a small box behind it. (docs/equations.md#scene-belief)
/// @param R     Axes of the leaf as it stands
/// @param foot  Point of its face behind the grip [m]
[[nodiscard]] Box leaf_behind_handle(const Matrix3d& R, const Vector3d& foot) noexcept;

/// Leaf of a hinge: from beside its axis to beyond the handle. (docs/equations.md#scene-belief)
/// @param centre   Any point of the axis [m]
/// @param upright  The axis is vertical; else it lies level
[[nodiscard]] Box leaf_from_axis(const Matrix3d& R, const Vector3d& foot, const Vector3d& centre, bool upright) noexcept;

/// A flap that stands open by `angle`, as it is pressed on. (docs/equations.md#press)
[[nodiscard]] Box leaf_pressed(const HandleBelief& belief, const FlapPress& press, double angle) noexcept;

/// What of the hand may come near the leaf while it holds the handle: round a level bar the fingers only, as the hand may
/// turn about it until the palm lies on the leaf. (docs/equations.md#free-grip)
[[nodiscard]] MayTouch holding_hand(const HandleBelief& belief) noexcept;

}  // namespace ajar
