// Strategy: the handle of a drawer or door is put into the hand of Heron at rest, then base or arm move with constant
// rates, so that every opening, force and pose has a closed form. Sensor models and grip have their own tests; here
// only how they are put together, each fault, determinism and bad commands.
#include "ajar/plant/kinematic_plant.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>

#include "ajar/core/error.hpp"

namespace {

using namespace ajar;
constexpr double kTick = 0.002;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

// No lag, no delay, no noise, no error.
PlantConfig ideal() {
  PlantConfig config;
  config.kind = "kinematic";
  config.base = {.lag = 0.0, .delay = 0.0, .wheel_radius_error = 0.0, .wheel_mismatch = 0.0};
  config.arm.lag = 0.0;
  config.wrist_sensor = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  config.perception.position_error = 0.0;
  return config;
}

const RobotModel& heron() {
  static const RobotModel model = load_robot("heron");
  return model;
}

const BasePose kStart{0.3, -0.2, 0.4};

Pose hand_at_start() {
  Kinematics kinematics;
  heron().compute(kStart, heron().home(), kinematics);
  return kinematics.X_WE;
}

Vector3d backwards() { return {-std::cos(kStart.yaw), -std::sin(kStart.yaw), 0.0}; }

// A drawer in the hand that opens as the base drives back.
Mechanism drawer_in_hand() {
  Mechanism m;
  m.kind = JointKind::Slide;
  m.axis = backwards();
  m.travel = 0.5;
  m.mass = m.inertia = 10.0;
  m.armature = m.coulomb = m.viscous = 0.0;
  m.handle.position = hand_at_start().translation();
  m.handle.normal = backwards();
  return m;
}

Command still(bool closed = true) {
  Command command;
  command.dq = JointVector::Zero(heron().joints());
  command.gripper_closed = closed;
  return command;
}

Command driving(double v, bool closed = true) {
  Command command = still(closed);
  command.base_v = v;
  return command;
}

void run(KinematicPlant& plant, const Command& command, double time) {
  const int ticks = static_cast<int>(std::lround(time / kTick));
  for (int i = 0; i < ticks; ++i) {
    plant.apply(command);
    plant.advance(kTick);
    (void)plant.measure();
  }
}

KinematicPlant plant_of(const Mechanism& mechanism, const PlantConfig& config) {
  return {heron(), mechanism, config, kStart, heron().home()};
}

TEST(KinematicPlant, JointsAndBaseGoExactlyWhereTheyAreSent) {
  KinematicPlant plant = plant_of(drawer_in_hand(), ideal());
  Command command = still(false);
  command.dq(2) = -0.2;
  command.base_v = 0.1;
  command.base_w = 0.25;
  run(plant, command, 2.0);
  EXPECT_NEAR(plant.truth().q(2), heron().home()(2) - 0.4, 1e-12);
  const double turn = 0.5;  // arc of radius v / w = 0.4 m over 0.5 rad
  EXPECT_NEAR(plant.truth().base.x, kStart.x + 0.4 * (std::sin(kStart.yaw + turn) - std::sin(kStart.yaw)), 1e-9);
  EXPECT_NEAR(plant.truth().base.y, kStart.y - 0.4 * (std::cos(kStart.yaw + turn) - std::cos(kStart.yaw)), 1e-9);
  EXPECT_NEAR(plant.truth().base.yaw, kStart.yaw + turn, 1e-12);
  const RobotState state = plant.measure();
  EXPECT_NEAR(state.time, 2.0, 1e-9);
  EXPECT_NEAR(state.base.x, plant.truth().base.x, 1e-9);
  EXPECT_NEAR(state.base_v, 0.1, 1e-12);
  EXPECT_NEAR(state.base_w, 0.25, 1e-12);
  EXPECT_EQ(plant.truth().opening, 0.0);
}

TEST(KinematicPlant, OdometryErrsAsTheWheelsDo) {
  PlantConfig config = ideal();
  config.base.wheel_radius_error = 0.05;
  KinematicPlant plant = plant_of(drawer_in_hand(), config);
  plant.reset(5);
  Random random(5);
  const double ratio = draw_disturbances(config, random).wheel_ratio(0);
  ASSERT_GT(std::abs(ratio - 1.0), 1e-3);
  run(plant, driving(0.2, false), 2.0);
  const auto gone = [](const BasePose& base) { return std::hypot(base.x - kStart.x, base.y - kStart.y); };
  EXPECT_NEAR(gone(plant.measure().base), 0.4, 1e-9);
  EXPECT_NEAR(gone(plant.truth().base), 0.4 * ratio, 1e-9);
}

TEST(KinematicPlant, BaseAnswersAfterItsDelayWithItsLag) {
  PlantConfig config = ideal();
  config.base.delay = 0.1;
  config.base.lag = 0.2;
  KinematicPlant plant = plant_of(drawer_in_hand(), config);
  run(plant, driving(0.1, false), 0.1);
  EXPECT_EQ(plant.measure().base_v, 0.0);
  run(plant, driving(0.1, false), 0.2);
  EXPECT_NEAR(plant.measure().base_v, 0.1 * (1.0 - std::exp(-1.0)), 1e-6);
}

TEST(KinematicPlant, ClosedHandPullsADrawerOpenAndFeelsItsFriction) {
  Mechanism m = drawer_in_hand();
  m.coulomb = 8.0;
  m.viscous = 20.0;
  KinematicPlant plant = plant_of(m, ideal());
  run(plant, still(), 1.0);
  ASSERT_TRUE(plant.truth().grasped);
  EXPECT_NEAR(plant.truth().force.norm(), 0.0, 1e-9);
  run(plant, driving(-0.05), 4.0);
  // Steady pull: friction + viscous rate, held back by the grip's stretch F / K.
  const double force = 8.0 + 20.0 * 0.05;
  EXPECT_NEAR(plant.truth().force.dot(backwards()), force, 1e-3 * force);
  EXPECT_NEAR(plant.truth().opening, 0.2 - force / 1e4, 1e-5);
  EXPECT_NEAR(plant.truth().opening_rate, 0.05, 1e-5);
  EXPECT_TRUE(plant.contacts().empty());
}

TEST(KinematicPlant, WristReadsTheForceOnTheHandlePlusTheTool) {
  Mechanism m = drawer_in_hand();
  m.coulomb = 12.0;
  KinematicPlant plant = plant_of(m, ideal());
  run(plant, still(), 1.0);
  run(plant, driving(-0.05), 2.0);
  plant.advance(kTick);
  const RobotState state = plant.measure();
  Kinematics kinematics;
  heron().compute(plant.truth().base, plant.truth().q, kinematics);
  const Vector3d felt = kinematics.R_WF * state.sensor_force - Vector3d(0.0, 0.0, heron().tool_mass() * kGravity);
  EXPECT_NEAR((felt - 12.0 * backwards()).norm(), 0.0, 0.05);
  EXPECT_NEAR(state.gripper_opening, m.handle.thickness, 1e-6);
}

TEST(KinematicPlant, StuckDrawerStaysWhereItIs) {
  Mechanism m = drawer_in_hand();
  m.coulomb = 100.0;
  KinematicPlant plant = plant_of(m, ideal());
  run(plant, still(), 1.0);
  run(plant, driving(-0.005), 1.0);  // 5 mm of stretch: 50 N, and 100 N s/m of damping at 5 mm/s
  EXPECT_EQ(plant.truth().opening, 0.0);
  EXPECT_NEAR(plant.truth().force.norm(), 50.5, 0.1);
}

TEST(KinematicPlant, TurningBaseCarriesTheHandleRoundItsHinge) {
  Mechanism m = drawer_in_hand();
  m.kind = JointKind::Hinge;
  m.axis = Vector3d::UnitZ();
  m.point = Vector3d(kStart.x, kStart.y, 0.0);  // the hinge under the base: turning on the spot opens
  m.inertia = 3.0;
  m.travel = 2.0;
  KinematicPlant plant = plant_of(m, ideal());
  run(plant, still(), 1.0);
  Command command = still();
  command.base_w = 0.3;
  run(plant, command, 3.0);
  EXPECT_NEAR(plant.truth().opening, 0.9, 2e-3);
  const double radius = handle_motion(m, 0.0).radius;
  EXPECT_NEAR((plant.truth().handle - m.point).head<2>().norm(), radius, 1e-12);
  EXPECT_NEAR(plant.truth().curvature.z(), 1.0 / radius, 1e-9);
  EXPECT_LT(plant.truth().force.norm(), 1.0);
}

TEST(KinematicPlant, FingersHoldOnlyWhatCanBeHeldAndIsNear) {
  Mechanism recess = drawer_in_hand();
  recess.handle.kind = HandleKind::Recess;
  recess.handle.thickness = 0.0;
  KinematicPlant nothing = plant_of(recess, ideal());
  run(nothing, still(), 1.0);
  EXPECT_FALSE(nothing.truth().grasped);
  EXPECT_NEAR(nothing.measure().gripper_opening, 0.0, 1e-9);

  Mechanism far = drawer_in_hand();
  far.handle.position += Vector3d(0.0, 0.0, 0.03);  // tolerance is 2.5 cm
  KinematicPlant missed = plant_of(far, ideal());
  run(missed, still(), 1.0);
  EXPECT_FALSE(missed.truth().grasped);
}

TEST(KinematicPlant, OpenedFingersLetGoAndMayCloseAgain) {
  KinematicPlant plant = plant_of(drawer_in_hand(), ideal());
  run(plant, still(true), 1.0);
  ASSERT_TRUE(plant.truth().grasped);
  run(plant, still(false), 0.5);
  EXPECT_FALSE(plant.truth().grasped);
  run(plant, still(true), 1.0);
  EXPECT_TRUE(plant.truth().grasped);
}

TEST(KinematicPlant, OverloadedGripIsLostAndStaysLostWhileClosed) {
  Mechanism m = drawer_in_hand();
  m.coulomb = 1000.0;
  KinematicPlant plant = plant_of(m, ideal());
  run(plant, still(), 1.0);
  run(plant, driving(-0.2), 0.5);
  EXPECT_FALSE(plant.truth().grasped);
  EXPECT_EQ(plant.truth().force.norm(), 0.0);
  run(plant, driving(0.2), 0.5);
  EXPECT_FALSE(plant.truth().grasped);
}

TEST(KinematicPlant, CameraSeesTheHandleUntilTheHandCoversIt) {
  const Mechanism m = drawer_in_hand();
  KinematicPlant plant = plant_of(m, ideal());
  const HandleSight sight = plant.measure().handle;
  ASSERT_TRUE(sight.visible);
  EXPECT_LT((to_pose(kStart) * sight.position - m.handle.position).norm(), 1e-12);
  EXPECT_LT((to_pose(kStart).linear() * sight.normal - m.handle.normal).norm(), 1e-12);
  run(plant, still(true), 0.1);
  EXPECT_FALSE(plant.measure().handle.visible);
}

TEST(KinematicPlant, FaultsDoWhatTheirNamesSay) {
  const auto with = [](Fault::Kind kind) {
    PlantConfig config = ideal();
    config.faults = {{kind, 1.5}};
    KinematicPlant plant = plant_of(drawer_in_hand(), config);
    run(plant, still(), 1.0);
    run(plant, driving(-0.01), 1.0);
    return std::pair<Truth, RobotState>{plant.truth(), plant.measure()};
  };
  EXPECT_NEAR(with(Fault::Kind::DoorLocked).first.opening, 0.005, 1e-4);
  EXPECT_NEAR(with(Fault::Kind::DoorLocked).first.force.norm(), 51.0, 0.5);  // 5 mm of spring, 1 cm/s of damper
  EXPECT_FALSE(with(Fault::Kind::GraspLost).first.grasped);
  EXPECT_NEAR(with(Fault::Kind::BaseBlocked).first.opening, 0.005, 1e-4);
  EXPECT_EQ(with(Fault::Kind::BaseBlocked).second.base_v, 0.0);
  EXPECT_FALSE(with(Fault::Kind::JointNan).second.q.allFinite());
  EXPECT_FALSE(with(Fault::Kind::SensorNan).second.sensor_force.allFinite());
  EXPECT_NEAR(with(Fault::Kind::SensorSilent).second.wrench_time, 1.5, 0.003);
  EXPECT_NEAR(with(Fault::Kind::SensorNan).second.time, 2.0, 1e-9);
}

TEST(KinematicPlant, SameSeedGivesSameMeasurements) {
  PlantConfig config;
  config.kind = "kinematic";
  KinematicPlant a = plant_of(drawer_in_hand(), config);
  KinematicPlant b = plant_of(drawer_in_hand(), config);
  const auto force = [](KinematicPlant& plant, std::uint64_t seed) {
    plant.reset(seed);
    run(plant, still(), 0.5);
    run(plant, driving(-0.05), 0.5);
    return plant.measure().sensor_force;
  };
  const Vector3d first = force(a, 7);
  EXPECT_EQ(first, force(b, 7));
  EXPECT_EQ(first, force(a, 7));
  EXPECT_NE(first, force(a, 8));
}

TEST(KinematicPlant, CommandsThatAreNoNumbersStopTheRobot) {
  KinematicPlant plant = plant_of(drawer_in_hand(), ideal());
  run(plant, driving(0.1, false), 0.5);
  const BasePose before = plant.truth().base;
  Command bad = driving(0.1, false);
  bad.dq(1) = kNan;
  run(plant, bad, 0.5);
  bad = driving(kNan, false);
  run(plant, bad, 0.5);
  bad = driving(0.1, false);
  bad.dq.resize(2);
  run(plant, bad, 0.5);
  EXPECT_EQ(plant.truth().base.x, before.x);
  EXPECT_EQ(plant.truth().q, heron().home());
  plant.advance(kNan);
  plant.advance(-1.0);
  EXPECT_NEAR(plant.measure().time, 2.0, 1e-9);
}

TEST(KinematicPlant, TimeDoesNotDriftWithStepsThatDoNotDivide) {
  KinematicPlant plant = plant_of(drawer_in_hand(), ideal());
  for (int i = 0; i < 1000; ++i) plant.advance(0.0033);
  EXPECT_NEAR(plant.measure().time, 3.3, 0.001);
}

TEST(KinematicPlant, BadStartIsRefused) {
  EXPECT_THROW(KinematicPlant(heron(), drawer_in_hand(), ideal(), kStart, JointVector::Zero(2)), PlantError);
  EXPECT_THROW(KinematicPlant(heron(), drawer_in_hand(), ideal(), BasePose{kNan, 0.0, 0.0}, heron().home()), PlantError);
  Mechanism bad = drawer_in_hand();
  bad.mass = -1.0;
  EXPECT_THROW(plant_of(bad, ideal()), ConfigError);
}

TEST(KinematicPlant, RunsMuchFasterThanRealTime) {
#ifndef NDEBUG
  GTEST_SKIP() << "meaningful with optimisation only";
#endif
  PlantConfig config;
  config.kind = "kinematic";
  KinematicPlant plant = plant_of(drawer_in_hand(), config);
  run(plant, still(), 1.0);
  // Processor time, not wall time: other work on the machine does not count. Best of five against interruptions.
  double best = 1e9;
  for (int i = 0; i < 5; ++i) {
    const std::clock_t begin = std::clock();
    for (int k = 0; k < 1000; ++k) {
      plant.apply(driving(k % 2 == 0 ? -0.01 : 0.01));
      plant.advance(kTick);
      (void)plant.measure();
    }
    best = std::min(best, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
  }
  RecordProperty("times_real_time", static_cast<int>(2.0 / best));
  std::printf("kinematic plant at 500 Hz: %.0f x real time\n", 2.0 / best);
  EXPECT_GT(2.0 / best, 200.0);
}

}  // namespace
