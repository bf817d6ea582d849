// Robot, base and sensors in physics. Truth comes from statics (weights, equilibrium), kinematics (drive straight, turn in
// place) and identities (same seed, same bytes). Left out: contact friction laws, which are MuJoCo's own.
#include <chrono>
#include <cstring>

#include <gtest/gtest.h>

#include "bench_rig.hpp"

#include "ajar/core/error.hpp"
#include "ajar/interaction/wrench.hpp"
#include "ajar/plant/sensor_models.hpp"

namespace ajar::test {
namespace {

class MujocoPlantTest : public testing::Test {
 protected:
  RobotModel robot = load_robot("heron");
  Mechanism mechanism = door();
  BasePose far{0.0, -3.0, 1.2};
};

TEST_F(MujocoPlantTest, FreeArmStandsStill) {
  MujocoPlant plant(robot, mechanism, quiet(), far, robot.home());
  plant.reset(1);
  const Pose before = plant.truth().hand;
  hold(plant, still(robot), 2.0);
  EXPECT_LT((plant.truth().hand.translation() - before.translation()).norm(), 2e-4);
  EXPECT_LT((plant.truth().q - robot.home()).cwiseAbs().maxCoeff(), 1e-5);
  EXPECT_TRUE(plant.contacts().empty());
  EXPECT_LT(std::abs(plant.truth().opening), 1e-4);
}

TEST_F(MujocoPlantTest, HandIsWhereTheModelSays) {
  MujocoPlant plant(robot, mechanism, quiet(), far, robot.home());
  plant.reset(1);
  Kinematics kinematics;
  robot.compute(plant.truth().base, plant.truth().q, kinematics);
  // The wheels sink in by less than a millimetre.
  EXPECT_LT((plant.truth().hand.translation() - kinematics.X_WE.translation()).norm(), 2e-3);
  EXPECT_LT((plant.truth().hand.linear() - kinematics.X_WE.linear()).norm(), 3e-3);
}

TEST_F(MujocoPlantTest, WristFeelsTheToolWeight) {
  PlantConfig config = quiet();
  config.wrist_sensor.tool_mass_error = 0.5;
  MujocoPlant plant(robot, mechanism, config, far, robot.home());
  plant.reset(1);
  hold(plant, still(robot), 0.5);
  const RobotState state = plant.measure();
  Kinematics kinematics;
  robot.compute(state.base, state.q, kinematics);
  const SensorWrench weight =
      sensor_wrench(kinematics, Vector3d::Zero(), Vector3d::Zero(), robot.tool_mass() + 0.5, robot.tool_com());
  EXPECT_LT((state.sensor_force - weight.force).norm(), 0.02 * weight.force.norm());
  EXPECT_LT((state.sensor_torque - weight.torque).norm(), 0.02 * weight.force.norm() * robot.tool_com().norm());
}

TEST_F(MujocoPlantTest, StraightDriveIsMeasuredToMillimetres) {
  MujocoPlant plant(robot, mechanism, quiet(), {0.0, -4.0, 0.0}, robot.home());
  plant.reset(1);
  Command command = still(robot);
  command.base_v = 0.2;
  hold(plant, command, 8.5);
  hold(plant, still(robot), 1.0);
  const BasePose truth = plant.truth().base;
  const BasePose belief = plant.measure().base;
  EXPECT_NEAR(truth.x, 1.7, 0.01);
  EXPECT_NEAR(belief.x, truth.x, 0.004);
  EXPECT_NEAR(belief.y, truth.y, 0.004);
  EXPECT_NEAR(belief.yaw, truth.yaw, 0.003);
}

TEST_F(MujocoPlantTest, LargerTrueWheelsDriveFartherThanBelieved) {
  PlantConfig config = quiet();
  config.base.wheel_radius_error = 0.05;
  MujocoPlant plant(robot, mechanism, config, {0.0, -4.0, 0.0}, robot.home());
  plant.reset(3);
  Random random(3);
  const double ratio = draw_disturbances(config, random).wheel_ratio(0);
  ASSERT_GT(std::abs(ratio - 1.0), 0.002);
  Command command = still(robot);
  command.base_v = 0.2;
  hold(plant, command, 5.0);
  EXPECT_NEAR(plant.truth().base.x / plant.measure().base.x, ratio, 0.003);
}

TEST_F(MujocoPlantTest, TurningInPlaceTurns) {
  MujocoPlant plant(robot, mechanism, quiet(), {0.0, -4.0, 0.0}, robot.home());
  plant.reset(1);
  Command command = still(robot);
  command.base_w = 0.5;
  hold(plant, command, 2.0);
  hold(plant, still(robot), 1.0);
  EXPECT_NEAR(plant.truth().base.yaw, 1.0, 0.01);
  EXPECT_NEAR(plant.measure().base.yaw, plant.truth().base.yaw, 0.005);
}

TEST_F(MujocoPlantTest, JointFollowsItsRateBehindTheLag) {
  const PlantConfig config = quiet();
  MujocoPlant plant(robot, mechanism, config, far, robot.home());
  plant.reset(1);
  Command command = still(robot);
  command.dq(0) = 0.3;
  hold(plant, command, 1.0);
  // A first-order lag costs rate times lag of way.
  EXPECT_NEAR(plant.truth().q(0) - robot.home()(0), 0.3 * (1.0 - config.arm.lag), 2e-3);
  EXPECT_NEAR(plant.measure().dq(0), 0.3, 5e-3);
}

TEST_F(MujocoPlantTest, DelayedCommandsArriveLate) {
  PlantConfig config = quiet();
  config.delay = 0.1;
  MujocoPlant plant(robot, mechanism, config, far, robot.home());
  plant.reset(1);
  Command command = still(robot);
  command.dq(0) = 0.3;
  hold(plant, command, 0.1);
  EXPECT_LT(std::abs(plant.truth().q(0) - robot.home()(0)), 1e-4);
  hold(plant, command, 0.2);
  EXPECT_GT(plant.truth().q(0) - robot.home()(0), 0.05);
}

TEST_F(MujocoPlantTest, NonFiniteCommandStopsTheArm) {
  MujocoPlant plant(robot, mechanism, quiet(), far, robot.home());
  plant.reset(1);
  Command command = still(robot);
  command.dq(0) = 0.3;
  hold(plant, command, 0.5);
  command.dq(2) = std::nan("");
  hold(plant, command, 0.5);
  EXPECT_LT(plant.truth().dq.cwiseAbs().maxCoeff(), 1e-3);
  EXPECT_TRUE(plant.truth().hand.matrix().allFinite());
}

TEST_F(MujocoPlantTest, SameSeedGivesTheSameBytes) {
  const PlantConfig config;
  const auto run = [&](MujocoPlant& plant, std::uint64_t seed) {
    plant.reset(seed);
    Command command = still(robot);
    command.dq.setConstant(0.1);
    command.base_v = 0.1;
    hold(plant, command, 0.5);
    return plant.measure();
  };
  MujocoPlant first(robot, mechanism, config, far, robot.home());
  MujocoPlant second(robot, mechanism, config, far, robot.home());
  (void)run(second, 9);
  const RobotState a = run(first, 5);
  const RobotState b = run(second, 5);
  const RobotState c = run(second, 6);
  EXPECT_EQ(0, std::memcmp(a.q.data(), b.q.data(), sizeof(double) * 6));
  EXPECT_EQ(0, std::memcmp(a.sensor_force.data(), b.sensor_force.data(), sizeof(double) * 3));
  EXPECT_EQ(0, std::memcmp(&a.base, &b.base, sizeof a.base));
  EXPECT_EQ(0, std::memcmp(a.handle.position.data(), b.handle.position.data(), sizeof(double) * 3));
  EXPECT_NE(a.sensor_force, c.sensor_force);
}

TEST_F(MujocoPlantTest, SensorFaultsShow) {
  PlantConfig config = quiet();
  config.faults = {{Fault::Kind::SensorNan, 0.2}};
  MujocoPlant nan(robot, mechanism, config, far, robot.home());
  hold(nan, still(robot), 0.1);
  EXPECT_TRUE(nan.measure().sensor_force.allFinite());
  hold(nan, still(robot), 0.2);
  EXPECT_TRUE(nan.measure().sensor_force.array().isNaN().all());
  config.faults = {{Fault::Kind::SensorSilent, 0.2}};
  MujocoPlant silent(robot, mechanism, config, far, robot.home());
  hold(silent, still(robot), 0.5);
  const double stamp = silent.measure().wrench_time;
  hold(silent, still(robot), 0.1);
  EXPECT_EQ(silent.measure().wrench_time, stamp);
  EXPECT_LE(stamp, 0.2);
}

TEST_F(MujocoPlantTest, BlockedBaseStaysWhereItIs) {
  PlantConfig config = quiet();
  config.faults = {{Fault::Kind::BaseBlocked, 1.0}};
  MujocoPlant plant(robot, mechanism, config, {0.0, -4.0, 0.0}, robot.home());
  Command command = still(robot);
  command.base_v = 0.3;
  hold(plant, command, 1.2);
  const double x = plant.truth().base.x;
  EXPECT_GT(x, 0.15);
  hold(plant, command, 1.0);
  EXPECT_NEAR(plant.truth().base.x, x, 0.005);
  EXPECT_LT(std::abs(plant.measure().base_v), 0.01);
}

TEST_F(MujocoPlantTest, DrivingIntoTheWallIsRecorded) {
  MechanismConfig shape;
  shape.radius = 0.5;
  MujocoPlant plant(robot, door(shape), quiet(), {-1.0, -0.8, 1.5708}, robot.home());
  Command command = still(robot);
  command.base_v = 0.2;
  hold(plant, command, 3.0);
  ASSERT_FALSE(plant.contacts().empty());
  EXPECT_GT(plant.contacts().front().force, 10.0);
  EXPECT_GT(plant.contacts().front().time, 0.5);
  EXPECT_NE(plant.contacts().front().bodies.find("base_link"), std::string::npos) << plant.contacts().front().bodies;
}

TEST_F(MujocoPlantTest, WhatTheFingersTouchIsFeltAndWantedWhereTheyLean) {
  const Mechanism shut = door();
  Handle beside = shut.handle;  // fingertips 2 cm before the leaf, a hand's length below the handle
  beside.position += 0.035 * shut.handle.normal - shut.handle.standoff * shut.handle.normal - 0.2 * Vector3d::UnitZ();
  const Stance stance = stand_at(robot, beside);
  for (const bool leans : {false, true}) {
    MujocoPlant plant(robot, shut, quiet(), stance.base, stance.q);
    hold(plant, still(robot), 0.5);
    const double before = plant.measure().sensor_force.z();
    Command push = still(robot);
    push.leans = leans;
    push.dq = arm_rates(robot, plant.measure(), -0.02 * shut.handle.normal);
    hold(plant, push, 1.2);
    EXPECT_GT(std::abs(plant.measure().sensor_force.z() - before), 5.0);
    EXPECT_EQ(plant.contacts().empty(), leans);
  }
}

TEST_F(MujocoPlantTest, RefusesAnArmOfTheWrongLength) {
  EXPECT_THROW(MujocoPlant(robot, mechanism, quiet(), far, JointVector::Zero(3)), PlantError);
  PlantConfig config;
  config.time_step = -1.0;
  EXPECT_THROW(MujocoPlant(robot, mechanism, config, far, robot.home()), ConfigError);
}

TEST_F(MujocoPlantTest, TwoMillisecondStepsWorkToo) {
  PlantConfig config = quiet();
  config.time_step = 0.002;
  MujocoPlant plant(robot, mechanism, config, far, robot.home());
  hold(plant, still(robot), 1.0);
  EXPECT_LT((plant.truth().q - robot.home()).cwiseAbs().maxCoeff(), 1e-4);
  EXPECT_NEAR(plant.measure().time, 1.0, 1e-9);
}

TEST_F(MujocoPlantTest, TimePerControlPeriodIsSmall) {
  MujocoPlant plant(robot, mechanism, PlantConfig(), far, robot.home());
  Command command = still(robot);
  command.base_v = 0.05;
  plant.apply(command);
  for (int i = 0; i < 200; ++i) plant.advance(0.002);
  const auto begin = std::chrono::steady_clock::now();
  constexpr int kPeriods = 2000;
  for (int i = 0; i < kPeriods; ++i) {
    plant.advance(0.002);
    (void)plant.measure();
  }
  const double mean = std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - begin).count() / kPeriods;
  std::printf("[ measured ] %.1f us per 2 ms control period\n", mean);
  EXPECT_LT(mean, 2000.0);  // faster than the world it simulates
}

}  // namespace
}  // namespace ajar::test
