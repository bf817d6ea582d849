#include "ajar/mission/scene_belief.hpp"

#include <algorithm>
#include <cmath>

#include "ajar/core/so3.hpp"
#include "ajar/planning/believed_scene.hpp"
#include "ajar/planning/passage.hpp"

namespace ajar {
namespace {

constexpr double kRefineArc = 0.12;    // travel after which the fit beats the camera's normal [m]
constexpr double kRefineRate = 0.02;   // low-pass of the normal per tick
constexpr double kSurelyHinged = 0.7;  // curvature above which the hinge centre is well known [1/m]
// Or that tells the centre to this part of the radius: the plane is then off by no more, in radians, and the camera misreads
// it by 0.17. What the estimator states of a small radius is twice what it errs by.
constexpr double kKnownRadius = 0.2;

Vector3d horizontal_unit(const Vector3d& v, const Vector3d& fallback) {
  const Vector3d flat(v.x(), v.y(), 0.0);
  return flat.norm() > 1e-6 ? Vector3d(flat.normalized()) : fallback;
}

}  // namespace

void SceneBelief::reset(const HandleBelief& belief) {
  belief_ = belief;
  belief_.normal = horizontal_unit(belief.normal, -Vector3d::UnitY());
  if (belief.passage) {
    const std::array<Box, 2> walls = passage_walls(*belief.passage);
    wall_ = walls[0];
    hinge_wall_ = walls[1];
    axis_ = passage_axis(belief, *belief.passage);
  }
  reveal_ = reveal_walls(belief);
  if (belief.press) {
    wall_ = believed_wall(belief_);
    turn_flap(belief.press->opened);
    return;
  }
  update(MechanismEstimate{}, belief.position, Vector3d::Zero());
}

void SceneBelief::refine_normal(const MechanismEstimate& estimate) noexcept {
  const Vector3d& k = estimate.curvature;
  const double kappa = k.norm();
  Vector3d wanted = belief_.normal;
  // The seen edges of a doorway tell its plane; the pins of a leaf that opens away stand on its far face.
  if (!belief_.passage && estimate.fitted && estimate.arc > kRefineArc && estimate.direction_sigma < 0.06 &&
      estimate.curvature_sigma < std::max(0.3, kKnownRadius * kappa)) {
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
        wanted = a.dot(belief_.normal) > b.dot(belief_.normal) ? a : b;
      }
    } else if (estimate.type == MechanismType::Slide) {
      const Vector3d along = horizontal_unit(estimate.direction, belief_.normal);
      if (along.dot(belief_.normal) > 0.9) wanted = along;
      if (std::abs(along.dot(belief_.normal)) < 0.4)
        wanted = (belief_.normal - along * along.dot(belief_.normal)).normalized();
    }
    if (wanted.dot(belief_.normal) > 0.9)
      belief_.normal = (belief_.normal + kRefineRate * (wanted - belief_.normal)).normalized();
  }
}

void SceneBelief::place_leaf(const MechanismEstimate& estimate, const Vector3d& hand, const Matrix3d& R_leaf) noexcept {
  const Vector3d& k = estimate.curvature;
  const double kappa = k.norm();
  const Vector3d foot = hand + belief_.standoff * R_leaf.col(1);
  const bool felt = estimate.type == MechanismType::Hinge && estimate.arc > kRefineArc && kappa > 1e-3;
  if (!felt && !belief_.passage) {
    leaf_ = leaf_behind_handle(R_leaf, foot);
    return;
  }
  const Vector3d centre = felt ? Vector3d(estimate.point + k.cross(estimate.direction) / (kappa * kappa)) : axis_;
  leaf_ = leaf_from_axis(R_leaf, foot, centre, !felt || std::abs(k.z()) > 0.7 * kappa);
}

void SceneBelief::update(const MechanismEstimate& estimate, const Vector3d& hand, const Vector3d& turned) noexcept {
  refine_normal(estimate);
  if (!belief_.passage) wall_ = believed_wall(belief_);
  place_leaf(estimate, hand, exp_so3(turned) * leaf_axes(belief_.normal));
}

void SceneBelief::turn_flap(double angle) noexcept {
  if (belief_.press) leaf_ = leaf_pressed(belief_, *belief_.press, angle);
}

void SceneBelief::place(ClearanceChecker& checker, bool hand_near) const noexcept {
  // Beside a doorway the hand has room, and none to touch the frame.
  checker.set_obstacle(kWallObstacle, wall_, hand_near && !belief_.passage ? MayTouch::Hand : MayTouch::Nothing);
  for (int i = 0; i < 2; ++i) {
    if (reveal_) {
      checker.set_obstacle(kRevealObstacle + i, (*reveal_)[static_cast<std::size_t>(i)], MayTouch::Nothing);
    } else {
      checker.clear_obstacle(kRevealObstacle + i);
    }
  }
  if (belief_.passage) checker.set_obstacle(kHingeWallObstacle, hinge_wall_, MayTouch::Nothing);
  checker.set_obstacle(kLeafObstacle, leaf_, hand_near ? holding_hand(belief_) : MayTouch::Nothing);
}

void SceneBelief::place_leaf_moved(ClearanceChecker& checker, const Vector3d& shift) const noexcept {
  Box leaf = leaf_;
  leaf.pose.translation() += shift;
  checker.set_obstacle(kLeafObstacle, leaf, MayTouch::Nothing);
}

void SceneBelief::place_misread(ClearanceChecker& checker, double share) const noexcept {
  const std::array<Box, 2> walls = misread_walls(belief_, share);
  for (int i = 0; i < 2; ++i) {
    if (share > 0.0 && !belief_.passage) {
      checker.set_obstacle(kMisreadObstacle + i, walls[static_cast<std::size_t>(i)], MayTouch::Nothing);
    } else {
      checker.clear_obstacle(kMisreadObstacle + i);
    }
  }
}

}  // namespace ajar
