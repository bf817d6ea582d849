#include "ajar/planning/believed_scene.hpp"

#include <algorithm>
#include <cmath>

#include "ajar/core/so3.hpp"
#include "ajar/planning/passage.hpp"

namespace ajar {

namespace {

constexpr double kFront = 0.02;         // the believed wall stands this far before the leaf's face: its error [m]
constexpr double kWallThickness = 0.3;  // anything thicker than a base step between two ticks [m]
constexpr double kLatchEdge = 0.09;     // the leaf goes on this far beyond the handle [m]
constexpr double kHingeRoom = 0.05;     // leaf and frame meet here; no robot part fits between [m]
constexpr double kLevel = 0.7071;       // sine: a bar that lies rather than stands
constexpr double kLargestReach = 1.1;   // from the handle to the axis: wider leaves are cut off [m]

}  // namespace

Matrix3d leaf_axes(const Vector3d& normal) noexcept {
  Matrix3d R;
  R.col(0) = Vector3d(-normal.y(), normal.x(), 0.0).normalized();
  R.col(1) = -Vector3d(normal.x(), normal.y(), 0.0).normalized();
  R.col(2) = R.col(0).cross(R.col(1));
  return R;
}

Box believed_wall(const HandleBelief& belief) noexcept {
  Box wall;
  wall.half_extents = Vector3d(2.5, 0.5 * kWallThickness, 1.5);
  wall.pose.linear() = leaf_axes(belief.normal);
  // Where a flap was held its grip and axis were felt: nothing stands before the plane of its face.
  const double front = belief.press ? 0.0 : kFront;
  wall.pose.translation() = belief.position + (belief.standoff - front + 0.5 * kWallThickness) * wall.pose.linear().col(1);
  wall.pose.translation().z() = 1.5;
  return wall;
}

std::array<Box, 2> misread_walls(const HandleBelief& belief, double share) noexcept {
  const double angle = share * kLargestMisreading;
  return {believed_wall(turned_about_handle(belief, angle)), believed_wall(turned_about_handle(belief, -angle))};
}

Box leaf_behind_handle(const Matrix3d& R, const Vector3d& foot) noexcept {
  Box leaf;
  leaf.pose.linear() = R;
  leaf.half_extents = Vector3d(0.25, 0.01, 0.10);
  leaf.pose.translation() = foot + 0.01 * R.col(1);
  return leaf;
}

Box leaf_from_axis(const Matrix3d& R, const Vector3d& foot, const Vector3d& centre, bool upright) noexcept {
  const Vector3d along = upright ? R.col(0) : R.col(2);
  const double reach = std::clamp((centre - foot).dot(along), -kLargestReach, kLargestReach);
  // From near the axis to beyond the handle, on the handle's side of the axis.
  const double near_axis = reach - std::copysign(std::min(kHingeRoom, std::abs(reach)), reach);
  const double beyond = -std::copysign(kLatchEdge, reach);
  const double half = 0.5 * std::abs(near_axis - beyond);
  Box leaf;
  leaf.pose.linear() = R;
  leaf.half_extents = upright ? Vector3d(half, 0.02, 1.0) : Vector3d(0.3, 0.02, half);
  leaf.pose.translation() = foot + 0.5 * (near_axis + beyond) * along;
  if (upright) {
    leaf.pose.translation().z() += 1.0 - foot.z();
  } else {
    leaf.pose.translation() += leaf.half_extents.y() * R.col(1);  // a hand that may turn about the bar needs the face itself
  }
  return leaf;
}

Box leaf_pressed(const HandleBelief& belief, const FlapPress& press, double angle) noexcept {
  const Vector3d axis = press.way.curvature.normalized();
  const Vector3d outward = axis.cross(Vector3d::UnitZ());
  const Matrix3d turn = exp_so3(angle * axis);
  const Vector3d foot = press.centre + turn * (belief.position - belief.standoff * outward - press.centre);
  return leaf_from_axis(turn * leaf_axes(outward), foot, press.centre, false);
}

MayTouch holding_hand(const HandleBelief& belief) noexcept {
  const bool level = belief.bar.norm() > 0.5 && std::abs(belief.bar.z()) < kLevel;
  return level && !belief.passage && !belief.press ? MayTouch::Fingers : MayTouch::Hand;
}

}  // namespace ajar
