// Hand on handle in physics. Truth comes from statics: the spring's displacement is force over stiffness, what the wrist
// feels is what the handle gets, a torque step turns the leaf by its inertia. The stance comes from the robot's own
// inverse kinematics; whole openings are left to the mission's tests.
#include <cmath>
#include <cstdio>
#include <memory>

#include <gtest/gtest.h>

#include "bench_rig.hpp"

#include "ajar/core/so3.hpp"
#include "ajar/interaction/wrench.hpp"

namespace ajar::test {
namespace {

class MujocoGraspTest : public testing::Test {
 protected:
  RobotModel robot = load_robot("heron");

  /// A door without friction and springs.
  static Mechanism easy_door() {
    MechanismConfig config;
    config.coulomb = 0.0;
    config.viscous = 2.0;
    return door(config);
  }
  std::unique_ptr<MujocoPlant> holding(const Mechanism& mechanism, const PlantConfig& config) {
    const Stance stance = stand_at(robot, mechanism.handle);
    auto plant = std::make_unique<MujocoPlant>(robot, mechanism, config, stance.base, stance.q);
    hold(*plant, still(robot, true), 1.2);
    return plant;
  }
};

TEST_F(MujocoGraspTest, LeafHasTheMechanismsInertia) {
  for (const bool pivots : {false, true}) {
    for (const double radius : {0.4, 0.8}) {
      MechanismConfig shape;
      shape.radius = radius;
      const Mechanism mechanism = door(shape);
      PlantConfig config = quiet();
      config.grasp.pivots = pivots;
      const MujocoPlant plant(robot, mechanism, config, {0.0, -3.0, 0.0}, robot.home());
      const double expected = mechanism.inertia + mechanism.armature;
      EXPECT_NEAR(plant.mechanism_inertia(), expected, 0.01 * expected);
    }
  }
  MechanismConfig drawer;
  drawer.type = "slide";
  drawer.travel = 0.4;
  drawer.mass = 7.0;
  const Mechanism mechanism = door(drawer);
  const MujocoPlant plant(robot, mechanism, quiet(), {0.0, -3.0, 0.0}, robot.home());
  EXPECT_NEAR(plant.mechanism_inertia(), 7.0 + mechanism.armature, 0.01);
}

TEST_F(MujocoGraspTest, TorqueStepAcceleratesTheLeaf) {
  Mechanism mechanism = easy_door();
  mechanism.viscous = 0.0;
  MujocoPlant plant(robot, mechanism, quiet(), {0.0, -3.0, 0.0}, robot.home());
  const HandleMotion motion = handle_motion(mechanism, 0.0);
  const double inertia = mechanism.inertia + mechanism.armature;
  plant.push_handle(10.0 * motion.direction);
  hold(plant, still(robot), 0.2);
  // The push keeps its direction in the world; over these few degrees its moment stays the same within 0.1 %.
  EXPECT_NEAR(plant.truth().opening_rate, 10.0 * motion.radius / inertia * 0.2, 0.01 * 10.0 * motion.radius / inertia * 0.2);
  EXPECT_NEAR(plant.truth().opening, 0.5 * 10.0 * motion.radius / inertia * 0.04,
              0.02 * 0.5 * 10.0 * motion.radius / inertia * 0.04);
}

TEST_F(MujocoGraspTest, CloserNeedsItsForceToOpen) {
  MechanismConfig shape;
  shape.coulomb = 2.0;
  shape.breakaway = 1.5;
  shape.closer.moment = 10.0;
  const Mechanism mechanism = door(shape);
  const double needed = handle_force_needed(mechanism, 0.0);
  const Vector3d direction = handle_motion(mechanism, 0.0).direction;
  MujocoPlant plant(robot, mechanism, quiet(), {0.0, -3.0, 0.0}, robot.home());
  plant.push_handle(0.95 * needed * direction);
  hold(plant, still(robot), 1.0);
  EXPECT_LT(plant.truth().opening, 0.005);
  plant.push_handle(1.10 * needed * direction);
  hold(plant, still(robot), 1.0);
  EXPECT_GT(plant.truth().opening, 0.02);
}

TEST_F(MujocoGraspTest, FingersCloseOnTheHandleAndTakeItWithoutPull) {
  const Mechanism mechanism = easy_door();
  const auto holder = holding(mechanism, quiet());
  MujocoPlant& plant = *holder;
  EXPECT_TRUE(plant.truth().grasped);
  EXPECT_NEAR(plant.measure().gripper_opening, mechanism.handle.thickness, 1e-6);
  EXPECT_LT(plant.truth().force.norm(), 0.5);
  EXPECT_FALSE(plant.measure().handle.visible);
  EXPECT_TRUE(plant.contacts().empty());
  hold(plant, still(robot, false), 0.05);
  EXPECT_FALSE(plant.truth().grasped);
}

TEST_F(MujocoGraspTest, FingersCloseOnNothingFarFromTheHandle) {
  const Mechanism mechanism = easy_door();
  MujocoPlant plant(robot, mechanism, quiet(), {0.0, -3.0, 0.0}, robot.home());
  hold(plant, still(robot, true), 1.5);
  EXPECT_FALSE(plant.truth().grasped);
  EXPECT_NEAR(plant.measure().gripper_opening, 0.0, 1e-6);
}

TEST_F(MujocoGraspTest, GraspIsASpringOfTheConfiguredStiffness) {
  const Mechanism mechanism = easy_door();
  for (const double stiffness : {5e3, 1e4, 3e4}) {
    for (const bool pivots : {false, true}) {
      PlantConfig config = quiet();
      config.grasp.stiffness = stiffness;
      config.grasp.pivots = pivots;
      config.faults = {{Fault::Kind::DoorLocked, 0.0}};
      const auto holder = holding(mechanism, config);
      MujocoPlant& plant = *holder;
      ASSERT_TRUE(plant.truth().grasped);
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3d rest = plant.truth().hand.translation() - plant.truth().handle;
        const Vector3d rest_force = plant.truth().force;
        Command pull = still(robot, true);
        pull.dq = arm_rates(robot, plant.measure(), 0.01 * Vector3d::Unit(axis));
        hold(plant, pull, 0.5);
        hold(plant, still(robot, true), 0.5);
        const Vector3d stretch = plant.truth().hand.translation() - plant.truth().handle - rest;
        const Vector3d force = plant.truth().force - rest_force;
        EXPECT_GT(force(axis), 5.0);
        // Locks give way by about 10 µm at 20 N: a tenth of a percent here.
        EXPECT_NEAR(force(axis) / stretch(axis), stiffness, 0.01 * stiffness) << "axis " << axis << " pivots " << pivots;
      }
    }
  }
}

TEST_F(MujocoGraspTest, GraspResistsTwistWithTheConfiguredStiffness) {
  const Mechanism mechanism = easy_door();
  PlantConfig config = quiet();
  config.faults = {{Fault::Kind::DoorLocked, 0.0}};
  const auto holder = holding(mechanism, config);
  MujocoPlant& plant = *holder;
  const Pose rest = plant.truth().hand;
  const Vector3d rest_torque = plant.truth().torque;
  const RobotState state = plant.measure();
  Kinematics kinematics;
  robot.compute(state.base, state.q, kinematics);
  Vector6d twist = Vector6d::Zero();
  twist.tail<3>() = Vector3d(0.03, 0.02, 0.05);
  const Eigen::MatrixXd J = kinematics.J.leftCols(robot.joints());
  Command turn = still(robot, true);
  turn.dq = J.completeOrthogonalDecomposition().solve(twist);
  hold(plant, turn, 1.0);
  hold(plant, still(robot, true), 0.5);
  const Vector3d angle = log_so3(plant.truth().hand.linear() * rest.linear().transpose());
  const Vector3d torque = plant.truth().torque - rest_torque;
  EXPECT_GT(torque.norm(), 1.0);
  EXPECT_NEAR(torque.norm() / angle.norm(), config.grasp.rotational_stiffness, 0.02 * config.grasp.rotational_stiffness);
  EXPECT_GT(torque.dot(angle) / torque.norm() / angle.norm(), 0.999);
}

TEST_F(MujocoGraspTest, PivotingGripTurnsAboutTheBar) {
  const Mechanism mechanism = easy_door();
  PlantConfig config = quiet();
  config.grasp.pivots = true;
  config.faults = {{Fault::Kind::DoorLocked, 0.0}};
  const auto holder = holding(mechanism, config);
  MujocoPlant& plant = *holder;
  const RobotState state = plant.measure();
  Kinematics kinematics;
  robot.compute(state.base, state.q, kinematics);
  Vector6d twist = Vector6d::Zero();
  twist.tail<3>() = 0.2 * mechanism.handle.bar;
  const Eigen::MatrixXd J = kinematics.J.leftCols(robot.joints());
  Command turn = still(robot, true);
  turn.dq = J.completeOrthogonalDecomposition().solve(twist);
  hold(plant, turn, 1.0);
  hold(plant, still(robot, true), 0.5);
  // Only the friction of the pads is left of the 20 N m that a firm grip would need.
  EXPECT_LT(std::abs(plant.truth().torque.dot(mechanism.handle.bar)), 0.3);
}

TEST_F(MujocoGraspTest, PullingALockedDoorIsFeltAsPullOnTheHandle) {
  const Mechanism mechanism = easy_door();
  PlantConfig config = quiet();
  config.faults = {{Fault::Kind::DoorLocked, 0.0}};
  const auto holder = holding(mechanism, config);
  MujocoPlant& plant = *holder;
  const Vector3d outward = mechanism.handle.normal;
  Command pull = still(robot, true);
  pull.dq = arm_rates(robot, plant.measure(), 0.02 * outward);
  hold(plant, pull, 0.3);
  hold(plant, still(robot, true), 0.7);
  (void)plant.measure();
  hold(plant, still(robot, true), 0.1);
  const RobotState state = plant.measure();
  Kinematics kinematics;
  robot.compute(plant.truth().base, state.q, kinematics);
  const HandWrench felt = WrenchEstimator(robot).hand_wrench(state, kinematics);
  EXPECT_GT(felt.force.dot(outward), 10.0);
  EXPECT_GT(plant.truth().force.dot(outward), 10.0);
  EXPECT_LT((felt.force - plant.truth().force).norm(), 0.01 * felt.force.norm() + 0.05);
  EXPECT_LT((felt.torque - plant.truth().torque).norm(), 0.05);
  EXPECT_LT(plant.truth().opening, 1e-3);
}

TEST_F(MujocoGraspTest, ArmGivesWayLikeAStiffRobot) {
  PlantConfig config = quiet();
  config.faults = {{Fault::Kind::DoorLocked, 0.0}};
  config.grasp.stiffness = 1e5;
  const auto holder = holding(easy_door(), config);
  MujocoPlant& plant = *holder;
  Command pull = still(robot, true);
  const Vector3d outward = plant.mechanism().handle.normal;
  pull.dq = arm_rates(robot, plant.measure(), 0.01 * outward);
  hold(plant, pull, 0.5);
  hold(plant, still(robot, true), 1.0);
  // The command went 5 mm; what the force leaves of it per newton is the compliance of arm, base and grasp together.
  const double stiffness = plant.truth().force.dot(outward) / 0.005;
  std::printf("[ measured ] %.0f N/m at the hand, grasp of 1e5 N/m included\n", stiffness);
  EXPECT_GT(stiffness, 2e3);
  EXPECT_LT(stiffness, 5e4);
}

TEST_F(MujocoGraspTest, PullingAFreeDoorOpensIt) {
  const auto holder = holding(easy_door(), quiet());
  MujocoPlant& plant = *holder;
  Command pull = still(robot, true);
  pull.dq = arm_rates(robot, plant.measure(), -0.05 * Vector3d::UnitY());
  hold(plant, pull, 1.0);
  EXPECT_TRUE(plant.truth().grasped);
  EXPECT_GT(plant.truth().opening, 0.03);
  EXPECT_LT((plant.truth().hand.translation() - plant.truth().handle).norm(), 0.01);
}

TEST_F(MujocoGraspTest, GripCreepsAboveItsSlipForce) {
  PlantConfig config = quiet();
  config.grasp.slip_force = 30.0;
  config.grasp.break_force = 60.0;
  config.faults = {{Fault::Kind::DoorLocked, 0.0}};
  const auto holder = holding(easy_door(), config);
  MujocoPlant& plant = *holder;
  const Vector3d outward = plant.mechanism().handle.normal;
  Command pull = still(robot, true);
  pull.dq = arm_rates(robot, plant.measure(), 0.02 * outward);
  hold(plant, pull, 1.0);
  EXPECT_TRUE(plant.truth().grasped);
  // Two fifths of the way from slip to break force at 2 cm/s.
  EXPECT_NEAR(plant.truth().force.norm(), 42.0, 3.0);
  EXPECT_GT((plant.truth().hand.translation() - plant.truth().handle).dot(outward), 0.008);
}

TEST_F(MujocoGraspTest, GripBreaksAboveItsBreakForce) {
  PlantConfig config = quiet();
  config.grasp.slip_force = config.grasp.break_force = 40.0;
  config.faults = {{Fault::Kind::DoorLocked, 0.0}};
  const auto holder = holding(easy_door(), config);
  MujocoPlant& plant = *holder;
  Command pull = still(robot, true);
  pull.dq = arm_rates(robot, plant.measure(), 0.05 * plant.mechanism().handle.normal);
  hold(plant, pull, 1.0);
  EXPECT_FALSE(plant.truth().grasped);
  EXPECT_EQ(plant.truth().force.norm(), 0.0);
  EXPECT_NEAR(plant.measure().gripper_opening, 0.0, 1e-6);
}

TEST_F(MujocoGraspTest, GraspLostIsLost) {
  PlantConfig config = quiet();
  config.faults = {{Fault::Kind::GraspLost, 1.5}};
  const auto holder = holding(easy_door(), config);
  MujocoPlant& plant = *holder;
  EXPECT_TRUE(plant.truth().grasped);
  hold(plant, still(robot, true), 1.0);
  EXPECT_FALSE(plant.truth().grasped);
}

TEST_F(MujocoGraspTest, LeafStopsAtItsHardStop) {
  MechanismConfig shape;
  shape.travel = 0.6;
  shape.coulomb = 0.5;
  const Mechanism mechanism = door(shape);
  MujocoPlant plant(robot, mechanism, quiet(), {0.0, -4.0, 0.0}, robot.home());
  double largest = 0.0;
  for (int i = 0; i < 100; ++i) {
    plant.push_handle(5.0 * plant.truth().direction);
    hold(plant, still(robot), 0.05);
    largest = std::max(largest, plant.truth().opening);
  }
  EXPECT_NEAR(plant.truth().opening, 0.6, 0.01);
  EXPECT_LT(largest, 0.63);
}

TEST_F(MujocoGraspTest, SightIsTheHandleInTheBaseFrame) {
  const Mechanism mechanism = easy_door();
  const Stance stance = stand_at(robot, mechanism.handle);
  PlantConfig config = quiet();
  config.perception.normal_error = 0.1;
  MujocoPlant plant(robot, mechanism, config, stance.base, stance.q);
  const HandleSight sight = plant.measure().handle;
  ASSERT_TRUE(sight.visible);
  EXPECT_LT((to_pose(plant.truth().base) * sight.position - mechanism.handle.position).norm(), 1e-9);
  EXPECT_NEAR(std::acos(std::min(1.0, sight.normal.dot(-Vector3d::UnitX()))), 0.1, 0.01);
  EXPECT_NEAR(sight.bar.cross(Vector3d::UnitZ()).norm(), 0.0, 1e-9);
}

}  // namespace
}  // namespace ajar::test
