#pragma once

#include <array>
#include <optional>
#include <string>

#include "ajar/planning/grasp_planner.hpp"

namespace ajar {

/// Cameras misread the normal of a leaf by less. [rad]
inline constexpr double kLargestMisreading = 0.21;

/// Which side a felt leaf is hinged on, as the robot sees it.
enum class HingeSide { Left, Right };

/// Side on which a leaf looks as if it were hinged: the one farther from its handle. Without a doorway: right.
[[nodiscard]] HingeSide likely_side(const HandleBelief& belief) noexcept;

/// The doorway of a leaf that opens away, from what is seen now and the side that was felt. (docs/equations.md#passage)
/// @return nothing without a seen doorway or with one that has no width
[[nodiscard]] std::optional<Passage> make_passage(const HandleBelief& belief, HingeSide side);

/// The passage of a leaf that was felt to turn about an axis within its width: the part beyond the axis swings towards the
/// robot, the way lies between the axis and where the leaf shuts. (docs/equations.md#passage)
/// @param radius  Of the grip about the axis, as felt [m]
/// @return nothing where the felt axis is that of a leaf hinged at its frame
[[nodiscard]] std::optional<Passage> pivot_passage(const HandleBelief& belief, const Passage& passage, double radius);

/// Point on the believed hinge axis at the height of the grip: in the plane of the leaf's far face, beside the frame. [m]
[[nodiscard]] Vector3d passage_axis(const HandleBelief& belief, const Passage& passage);

/// Curvature vector of the grip's way about that axis into the doorway, horizontal arm. [1/m]
[[nodiscard]] Vector3d passage_curvature(const HandleBelief& belief, const Passage& passage);

/// Direction in which the grip starts to move, unit.
[[nodiscard]] Vector3d passage_direction(const HandleBelief& belief, const Passage& passage);

/// What the camera misread about the vertical, as touch tells: the angle from the direction in which the grip should start
/// to move to the one in which it did. (docs/equations.md#passage)
/// @param direction  Felt after `arc`, unit  @param arc  [m]
/// @return at most what a camera can err, ±12° [rad]
[[nodiscard]] double felt_misreading(const HandleBelief& belief, const Passage& passage, const Vector3d& direction,
                                     double arc) noexcept;

/// What is seen, turned about the handle and the vertical: handle, bar and doorway. @param angle  [rad]
[[nodiscard]] HandleBelief turned_about_handle(const HandleBelief& belief, double angle) noexcept;

/// Way of the base: straight, in the middle of what the open leaf leaves free.
[[nodiscard]] BaseLine passage_line(const Passage& passage);

/// Width that the leaf leaves free when it stands open at a right angle. [m]
[[nodiscard]] double passage_width(const Passage& passage);

/// Width of what the base carries, about its own forward axis. [m]
[[nodiscard]] double base_width(const RobotModel& model);

/// In words how the robot fits through: "base 0.58 m wide, opening 0.62 m: 0.02 m each side".
[[nodiscard]] std::string passage_room(const Passage& passage, const RobotModel& model);

/// Walls on both sides of the doorway: where the leaf shuts, where it is hinged.
[[nodiscard]] std::array<Box, 2> passage_walls(const Passage& passage);

/// How far the frame beside the handle stands before the leaf's face: the depth of the reveal. 0 without a seen doorway
/// and for a leaf that is flush with its frame or stands before it. [m]
[[nodiscard]] double reveal_depth(const HandleBelief& belief) noexcept;

/// Frame and wall to the left and the right of a leaf that lies behind them, for a hand that reaches between them.
/// (docs/equations.md#passage)
/// @return nothing where the frame does not stand out before the believed wall
[[nodiscard]] std::optional<std::array<Box, 2>> reveal_walls(const HandleBelief& belief);

/// Turns a hand that meets the leaf along its normal towards the hinge, so that it does not meet the frame when the leaf
/// takes it along. @param yaw  [rad]
[[nodiscard]] Matrix3d turned_to_hinge(const Matrix3d& R, const Passage& passage, double yaw);

}  // namespace ajar
