// Strategy: the believed wall and leaf are compared with the geometry of a known hinge in closed form: where the axis is,
// the latch edge beyond the handle, a right-handed frame for every heading.
#include "ajar/mission/scene_belief.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "ajar/core/so3.hpp"
#include "ajar/planning/believed_scene.hpp"
#include "ajar/planning/passage.hpp"

namespace ajar {
namespace {

TEST(SceneBelief, KeepsTheCameraNormalUntilTheFitIsSure) {
  HandleBelief belief;
  belief.position = Vector3d(1.0, 2.0, 1.0);
  belief.normal = Vector3d(std::cos(0.3), std::sin(0.3), 0.0);
  SceneBelief scene;
  scene.reset(belief);
  EXPECT_LT((scene.normal() - belief.normal).norm(), 1e-12);
  MechanismEstimate unsure;
  unsure.fitted = true;
  unsure.arc = 0.05;
  for (int i = 0; i < 100; ++i) scene.update(unsure, belief.position, Vector3d::Zero());
  EXPECT_LT((scene.normal() - belief.normal).norm(), 1e-12);
}

// The box behind the handle, moved away from a hand before it: the distance grows by as much.
TEST(SceneBelief, TheLeafCanBeLookedAtFromFartherAway) {
  const RobotModel robot = load_robot("heron");
  Kinematics kin;
  robot.compute({}, robot.home(), kin);
  HandleBelief belief;
  belief.position = kin.X_WE.translation() + Vector3d(0.03, 0.0, 0.0);
  belief.normal = -Vector3d::UnitX();
  SceneBelief scene;
  scene.reset(belief);
  ClearanceChecker checker(robot, ClearanceConfig{});
  ClearanceResult result;
  const auto distance = [&](double away) {
    scene.place_leaf_moved(checker, Vector3d(away, 0.0, 0.0));
    checker.compute(robot, {}, result);
    return result.smallest[static_cast<std::size_t>(ClearanceKind::ArmWorld)];
  };
  const double near = distance(0.0);
  EXPECT_GT(near, 0.0);
  EXPECT_NEAR(distance(0.02) - near, 0.02, 1e-6);
}

// Hinge at +x seen from -y, handle 6 cm before the plane of the axis: the true normal is -y. What the estimator says of the
// curvature is never surer than a tenth.
class SceneBeliefOfHinge : public ::testing::TestWithParam<double> {};
TEST_P(SceneBeliefOfHinge, TheFitCorrectsAWrongNormal) {
  const double radius = GetParam();
  const double standoff = 0.06;
  HandleBelief belief;
  belief.position = Vector3d(0.0, -standoff, 1.0);
  belief.normal = exp_so3(Vector3d(0.0, 0.0, 0.17)) * Vector3d(0.0, -1.0, 0.0);
  belief.standoff = standoff;
  const Vector3d centre(radius, 0.0, 1.0);
  const Vector3d k_axis = Vector3d::UnitZ();
  const Vector3d arm0 = belief.position - centre;
  SceneBelief scene;
  scene.reset(belief);
  MechanismEstimate estimate;
  estimate.fitted = true;
  estimate.arc = 0.3;
  estimate.direction_sigma = 0.01;
  estimate.curvature_sigma = 0.1 / radius;
  estimate.type = MechanismType::Hinge;
  const double turned = estimate.arc / arm0.norm();
  const Vector3d arm = exp_so3(turned * k_axis) * arm0;
  estimate.point = centre + arm;
  estimate.curvature = k_axis / arm0.norm();
  estimate.direction = k_axis.cross(arm).normalized();
  for (int i = 0; i < 600; ++i) scene.update(estimate, estimate.point, turned * k_axis);
  EXPECT_LT(std::acos(scene.normal().dot(Vector3d(0.0, -1.0, 0.0))), 0.005);
}
INSTANTIATE_TEST_SUITE_P(Radii, SceneBeliefOfHinge, ::testing::Values(0.3, 0.5, 0.8));

// A metre beside the handle a wall whose normal was misread by 0.21 rad stands 21 cm nearer or farther.
TEST(SceneBelief, TheWallAsItMayStandIsNearerBesideTheHandle) {
  HandleBelief belief;
  belief.position = Vector3d(0.0, 0.0, 1.0);
  belief.normal = -Vector3d::UnitY();
  const auto before_face = [](const Box& wall, const Vector3d& p) {
    return -(wall.pose.inverse() * p).y() - wall.half_extents.y();
  };
  const Vector3d beside(1.0, -0.3, 1.0);
  const double seen = before_face(believed_wall(belief), beside);
  const std::array<Box, 2> walls = misread_walls(belief, 1.0);
  const double a = before_face(walls[0], beside) - seen;
  const double b = before_face(walls[1], beside) - seen;
  EXPECT_NEAR(std::min(a, b), -std::sin(kLargestMisreading) - 0.3 * (1.0 - std::cos(kLargestMisreading)), 1e-9);
  EXPECT_NEAR(std::max(a, b), std::sin(kLargestMisreading) - 0.3 * (1.0 - std::cos(kLargestMisreading)), 1e-9);
  EXPECT_NEAR(before_face(misread_walls(belief, 0.0)[0], beside), seen, 1e-12);
}

// A leaf hinged on the right, pushed along +y: the doorway is free for the hand, its walls and the leaf are not.
TEST(SceneBelief, ADoorwayHasTwoWallsAndALeafThatTurnsAboutItsFarFace) {
  HandleBelief belief;
  belief.position = Vector3d(0.0, -0.06, 1.0);
  belief.doorway = Doorway{{-0.09, 0.0, 0.0}, {0.83, 0.0, 0.0}};
  belief.passage = make_passage(belief, HingeSide::Right);
  ASSERT_TRUE(belief.passage.has_value());
  const RobotModel model = load_robot("heron");
  ClearanceChecker checker(model, {});
  SceneBelief scene;
  scene.reset(belief);
  scene.place(checker);
  Kinematics kinematics;
  ClearanceResult result;
  // Half a metre before the wall, rear (0.411 m behind the axle) first: 0.089 m, less 2 cm of the closed leaf's believed
  // error.
  RobotModel robot = model;
  const BasePose before{0.37, -0.5, -0.5 * std::numbers::pi};
  robot.compute(before, model.home(), kinematics);
  checker.compute(robot, before, result);
  EXPECT_NEAR(result.smallest[static_cast<std::size_t>(ClearanceKind::BaseWorld)], 0.069, 0.002);
  // In the doorway with the leaf at a right angle: half of 0.92 m less 0.584 m beside the strike wall.
  MechanismEstimate open;
  open.type = MechanismType::Hinge;
  open.arc = 1.2;
  open.curvature = -Vector3d::UnitZ() / 0.8;
  open.direction = Vector3d::UnitX();
  open.point = Vector3d(0.7, 0.85, 1.0);
  scene.update(open, open.point, Vector3d(0.0, 0.0, -0.5 * std::numbers::pi));
  scene.place(checker);
  const BasePose inside{0.30, 0.1, -0.5 * std::numbers::pi};
  robot.compute(inside, model.home(), kinematics);
  checker.compute(robot, inside, result);
  EXPECT_NEAR(result.smallest[static_cast<std::size_t>(ClearanceKind::BaseWorld)], 0.30 + 0.09 - 0.292, 0.002);
}

}  // namespace
}  // namespace ajar
