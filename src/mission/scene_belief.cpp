#include "ajar/mission/scene_belief.hpp"

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
constexpr double kRefineArc = 0.12;     // travel after which the fit beats the camera's normal [m]
constexpr double kRefineRate = 0.02;    // low-pass of the normal per tick
constexpr double kSurelyHinged = 0.7;   // curvature above which the hinge centre is well known [1/m]

// Axes (t to the right as the robot sees it, -n into the wall, up): right-handed for every horizontal n.
Matrix3d leaf_axes(const Vector3d& normal) {
  const Vector3d right(-normal.y(), normal.x(), 0.0);
  Matrix3d R;
  R.col(0) = right.normalized();
  R.col(1) = -normal;
  R.col(2) = R.col(0).cross(R.col(1));
  return R;
}

Vector3d horizontal_unit(const Vector3d& v, const Vector3d& fallback) {
  const Vector3d flat(v.x(), v.y(), 0.0);
  return flat.norm() > 1e-6 ? Vector3d(flat.normalized()) : fallback;
}

}  // namespace

void SceneBelief::reset(const HandleBelief& belief) {
  belief_ = belief;
  normal_ = horizontal_unit(belief.normal, -Vector3d::UnitY());
  if (belief.passage) {
    const std::array<Box, 2> walls = passage_walls(*belief.passage);
    wall_ = walls[0];
    hinge_wall_ = walls[1];
    axis_ = passage_axis(belief, *belief.passage);
  }
  update(MechanismEstimate{}, belief.position, Vector3d::Zero());
}

void SceneBelief::refine_normal(const MechanismEstimate& estimate) noexcept {
  const Vector3d& k = estimate.curvature;
  const double kappa = k.norm();
  Vector3d wanted = normal_;
  // The seen edges of a doorway tell its plane; the pins of a leaf that opens away stand on its far face.
  if (!belief_.passage && estimate.fitted && estimate.arc > kRefineArc && estimate.direction_sigma < 0.06 &&
      estimate.curvature_sigma < 0.3) {
    if (kappa > kSurelyHinged && std::abs(k.z()) > 0.8 * kappa) {
      // The handle stands `standoff` before the plane that holds the axis: that fixes the plane. (law 5)
      const Vector3d centre = estimate.point + k.cross(estimate.direction) / (kappa * kappa);
      Vector3d arm = belief_.position - centre;
      arm.z() = 0.0;
      const double radius = arm.norm();
      if (radius > 1e-3) {
        arm /= radius;
        const double sine = std::min(0.9, belief_.standoff / radius);
        const double cosine = std::sqrt(1.0 - sine * sine);
        const Vector3d across(-arm.y(), arm.x(), 0.0);
        const Vector3d a = arm * sine + across * cosine;
        const Vector3d b = arm * sine - across * cosine;
        wanted = a.dot(normal_) > b.dot(normal_) ? a : b;
      }
    } else if (estimate.type == MechanismType::Slide) {
      const Vector3d along = horizontal_unit(estimate.direction, normal_);
      if (along.dot(normal_) > 0.9) wanted = along;
      if (std::abs(along.dot(normal_)) < 0.4) wanted = (normal_ - along * along.dot(normal_)).normalized();
    }
    if (wanted.dot(normal_) > 0.9) normal_ = (normal_ + kRefineRate * (wanted - normal_)).normalized();
  }
}

void SceneBelief::place_leaf(const MechanismEstimate& estimate, const Vector3d& hand, const Matrix3d& R_leaf) noexcept {
  const Vector3d& k = estimate.curvature;
  const double kappa = k.norm();
  const Vector3d n_leaf = -R_leaf.col(1);
  const Vector3d foot = hand - belief_.standoff * n_leaf;
  leaf_.pose.linear() = R_leaf;
  leaf_.half_extents = Vector3d(0.25, 0.01, 0.10);
  leaf_.pose.translation() = foot - 0.01 * n_leaf;
  const bool felt = estimate.type == MechanismType::Hinge && estimate.arc > kRefineArc && kappa > 1e-3;
  if (!felt && !belief_.passage) return;
  const Vector3d centre = felt ? Vector3d(estimate.point + k.cross(estimate.direction) / (kappa * kappa)) : axis_;
  const bool vertical = !felt || std::abs(k.z()) > 0.7 * kappa;
  const Vector3d along = vertical ? R_leaf.col(0) : R_leaf.col(2);
  const double reach = std::clamp((centre - foot).dot(along), -1.1, 1.1);
  // From near the axis to beyond the handle, on the handle's side of the axis.
  const double near_axis = reach - std::copysign(std::min(kHingeRoom, std::abs(reach)), reach);
  const double beyond = -std::copysign(kLatchEdge, reach);
  const double middle = 0.5 * (near_axis + beyond);
  const double half = 0.5 * std::abs(near_axis - beyond);
  leaf_.pose.translation() = foot + along * middle;
  if (vertical) {
    leaf_.pose.translation().z() += 1.0 - foot.z();
    leaf_.half_extents = Vector3d(half, 0.02, 1.0);
  } else {
    leaf_.half_extents = Vector3d(0.3, 0.02, half);
  }
}

void SceneBelief::update(const MechanismEstimate& estimate, const Vector3d& hand, const Vector3d& turned) noexcept {
  refine_normal(estimate);
  const Matrix3d R_closed = leaf_axes(normal_);
  if (!belief_.passage) {
    wall_.half_extents = Vector3d(2.5, 0.5 * kWallThickness, 1.5);
    wall_.pose.linear() = R_closed;
    wall_.pose.translation() = belief_.position - (belief_.standoff - kFront + 0.5 * kWallThickness) * normal_;
    wall_.pose.translation().z() = 1.5;
  }
  place_leaf(estimate, hand, exp_so3(turned) * R_closed);
}

void SceneBelief::place(ClearanceChecker& checker, bool hand_near) const noexcept {
  // Beside a doorway the hand has room, and none to touch the frame.
  checker.set_obstacle(kWallObstacle, wall_, hand_near && !belief_.passage);
  if (belief_.passage) {
    checker.set_obstacle(kHingeWallObstacle, hinge_wall_, false);
  } else {
    checker.clear_obstacle(kHingeWallObstacle);
  }
  checker.set_obstacle(kLeafObstacle, leaf_, hand_near);
}

}  // namespace ajar
