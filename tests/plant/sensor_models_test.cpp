// The parts that all simulated plants share. Truth comes from closed forms (lag, delay, arc, weight) and from statistics of
// many samples with bounds of five standard deviations.
#include <cmath>
#include <limits>
#include <numbers>

#include <gtest/gtest.h>

#include "ajar/core/error.hpp"
#include "ajar/plant/sensor_models.hpp"

namespace ajar {
namespace {

TEST(DelayLine, GivesBackWhatWentInSoManyStepsAgo) {
  DelayLine<int> line(3, -1);
  for (int i = 0; i < 10; ++i) EXPECT_EQ(line.push(i), i < 3 ? -1 : i - 3);
  DelayLine<int> none(0);
  EXPECT_EQ(none.push(7), 7);
}

TEST(Encoder, RoundsToWholeSteps) {
  EXPECT_DOUBLE_EQ(quantise(0.1234, 0.01), 0.12);
  EXPECT_DOUBLE_EQ(quantise(-0.126, 0.01), -0.13);
  EXPECT_DOUBLE_EQ(quantise(0.1234, 0.0), 0.1234);
}

TEST(Disturbances, StayInsideTheirBoundsAndBelongToTheirSeed) {
  PlantConfig config;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Random first(seed);
    Random second(seed);
    const Disturbances a = draw_disturbances(config, first);
    const Disturbances b = draw_disturbances(config, second);
    EXPECT_EQ(a.force_bias, b.force_bias);
    EXPECT_LE(a.force_bias.cwiseAbs().maxCoeff(), config.wrist_sensor.force_bias);
    EXPECT_LE(std::abs(a.wheel_ratio.mean() - 1.0), config.base.wheel_radius_error + 1e-12);
    EXPECT_LE(std::abs(a.wheel_ratio(0) - a.wheel_ratio(1)), config.base.wheel_mismatch * 1.011);
    EXPECT_LE(a.sight_error.cwiseAbs().maxCoeff(), config.perception.position_error);
  }
}

TEST(WristSensor, AveragesNoiseAndKeepsBiasAndDrift) {
  WristSensorConfig config;
  WristSensor sensor(config, {});
  Disturbances drawn;
  drawn.force_bias = Vector3d(1.0, -2.0, 3.0);
  drawn.force_drift = Vector3d(0.1, 0.0, 0.0);
  sensor.reset(drawn);
  Random random(4);
  const SensorWrench truth{Vector3d(5.0, 0.0, 0.0), Vector3d(0.0, 1.0, 0.0)};
  constexpr int kSteps = 20000;
  for (int i = 0; i < kSteps; ++i) sensor.sample(0.001 * i, truth, random);
  RobotState state;
  sensor.read(20.0, state);
  const double spread = 5.0 * config.force_noise / std::sqrt(kSteps / 2.0);
  EXPECT_NEAR(state.sensor_force.x(), 5.0 + 1.0 + 0.1 * 10.0, spread + 1e-3);
  EXPECT_NEAR(state.sensor_force.y(), -2.0, spread);
  EXPECT_NEAR(state.sensor_torque.y(), 1.0, 5.0 * config.torque_noise / std::sqrt(kSteps / 2.0));
  EXPECT_NEAR(state.wrench_time, 0.001 * (kSteps - 2), 1e-9);
}

TEST(WristSensor, SampleNoiseHasItsStandardDeviation) {
  const WristSensorConfig config;
  WristSensor sensor(config, {});
  sensor.reset(Disturbances());
  Random random(8);
  double squares = 0.0;
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i) {
    sensor.sample(0.002 * i, SensorWrench(), random);
    RobotState state;
    sensor.read(0.002 * i, state);
    squares += state.sensor_force.squaredNorm();
  }
  EXPECT_NEAR(std::sqrt(squares / (3.0 * kSamples)), config.force_noise, 0.02 * config.force_noise);
}

TEST(WristSensor, FaultsFreezeOrSpoilTheReading) {
  WristSensor silent(WristSensorConfig(), {{Fault::Kind::SensorSilent, 0.01}});
  WristSensor nan(WristSensorConfig(), {{Fault::Kind::SensorNan, 0.01}});
  silent.reset(Disturbances());
  nan.reset(Disturbances());
  Random random(1);
  RobotState before;
  RobotState after;
  for (int i = 0; i <= 10; ++i) {
    const double time = 0.002 * i;
    silent.sample(time, SensorWrench(), random);
    nan.sample(time, SensorWrench(), random);
    silent.read(time, i < 5 ? before : after);
    RobotState state;
    nan.read(time, state);
    EXPECT_EQ(state.sensor_force.allFinite(), i < 5);
  }
  EXPECT_EQ(before.wrench_time, after.wrench_time);
  EXPECT_EQ(before.sensor_force, after.sensor_force);
}

TEST(SensorWrench, IsForceAndWeightAboutTheSensor) {
  Kinematics kinematics;
  kinematics.R_WF = Eigen::AngleAxisd(std::numbers::pi, Vector3d::UnitX()).toRotationMatrix();  // sensor looks down
  kinematics.p_WF = Vector3d(1.0, 2.0, 3.0);
  kinematics.X_WE.translation() = Vector3d(1.0, 2.0, 2.8);
  const SensorWrench wrench =
      sensor_wrench(kinematics, Vector3d(10.0, 0.0, 0.0), Vector3d::Zero(), 2.0, Vector3d(0.0, 0.1, 0.0));
  EXPECT_LT((wrench.force - Vector3d(10.0, 0.0, -2.0 * kGravity)).norm(), 1e-9);
  // Arm of the force: (0, 0, -0.2) x (10, 0, 0) = (0, -2, 0) in the world, (0, 2, 0) in the sensor.
  EXPECT_LT((wrench.torque - Vector3d(-0.2 * kGravity, 2.0, 0.0)).norm(), 1e-9);
}

TEST(WheelOdometry, FollowsACircle) {
  WheelOdometry odometry(0.1, 0.5);
  odometry.reset({0.0, 0.0, 0.0}, Vector2d(3.0, -2.0));
  // Quarter circle of radius 1: wheels run on radii 0.75 and 1.25.
  constexpr int kSteps = 90;
  const double turn = 0.5 * std::numbers::pi / kSteps;
  Vector2d angles(3.0, -2.0);
  for (int i = 0; i < kSteps; ++i) {
    angles += Vector2d(0.75, 1.25) * turn / 0.1;
    odometry.update(angles, Vector2d(7.5, 12.5));
  }
  EXPECT_NEAR(odometry.pose().x, 1.0, 1e-9);
  EXPECT_NEAR(odometry.pose().y, 1.0, 1e-9);
  EXPECT_NEAR(odometry.pose().yaw, 0.5 * std::numbers::pi, 1e-9);
  EXPECT_NEAR(odometry.v(), 1.0, 1e-12);
  EXPECT_NEAR(odometry.w(), 1.0, 1e-12);
  odometry.update(Vector2d(std::nan(""), 0.0), Vector2d::Zero());
  EXPECT_TRUE(std::isfinite(odometry.pose().x));
}

TEST(WheelOdometry, KeepsAReadingUntilTheNextIsDue) {
  WheelOdometry odometry(0.1, 0.5, 40.0);
  odometry.reset({}, Vector2d::Zero());
  RobotState state;
  double oldest = 0.0;
  int readings = 0;
  for (int tick = 0; tick <= 500; ++tick) {  // 1 s at 1 m/s in a loop of 500 Hz
    const double time = 0.002 * tick;
    odometry.update(Vector2d::Constant(10.0 * time), Vector2d::Constant(10.0));
    odometry.read(time, state);
    oldest = std::max(oldest, state.base_age);
    readings += state.base_age == 0.0 ? 1 : 0;
    ASSERT_NEAR(state.base.x, time - state.base_age, 1e-9);
  }
  EXPECT_EQ(readings, 41);
  EXPECT_NEAR(oldest, 0.024, 1e-9);  // the last tick before the next reading
}

TEST(HandleSight, TurnsWithTheErrorAboutTheVertical) {
  Handle handle;
  handle.position = Vector3d(0.0, -0.06, 1.0);
  PerceptionConfig config;
  config.normal_error = 0.2;
  const Pose X_WB = to_pose({0.0, -1.0, 0.5 * std::numbers::pi});
  const HandleSight sight = see_handle(handle, Pose::Identity(), X_WB, config, Disturbances(), false);
  EXPECT_TRUE(sight.visible);
  EXPECT_LT((sight.position - Vector3d(0.94, 0.0, 1.0)).norm(), 1e-9);
  EXPECT_LT((sight.normal - Vector3d(-std::cos(0.2), -std::sin(0.2), 0.0)).norm(), 1e-9);
  EXPECT_LT((sight.bar - Vector3d::UnitZ()).norm(), 1e-9);
  EXPECT_FALSE(see_handle(handle, Pose::Identity(), X_WB, config, Disturbances(), true).visible);
  handle.kind = HandleKind::Recess;
  EXPECT_EQ(see_handle(handle, Pose::Identity(), X_WB, config, Disturbances(), false).thickness, 0.0);
}

TEST(HandleSight, TheFrameIsMisreadAsOneWithTheHandle) {
  const Vector3d handle(0.3, -0.06, 1.0);
  const Doorway doorway{{-0.4, -0.1, 0.0}, {0.5, -0.1, 0.0}};
  PerceptionConfig config;
  config.normal_error = 0.1;
  Disturbances wrong;
  wrong.sight_error = Vector3d(0.01, -0.02, 0.0);
  const Pose X_WB = to_pose({0.2, -1.0, 0.7});
  const std::optional<Doorway> seen = see_doorway(doorway, handle, X_WB, config, wrong);
  ASSERT_TRUE(seen.has_value());
  EXPECT_NEAR((seen->right - seen->left).norm(), 0.9, 1e-12);
  // Distances to the seen handle are the true ones; the direction along the wall is turned by the error.
  const Vector3d seen_handle = X_WB.inverse() * (handle + wrong.sight_error);
  EXPECT_NEAR((seen->left - seen_handle).norm(), (doorway.left - handle).norm(), 1e-12);
  const Vector3d along = X_WB.linear() * (seen->right - seen->left);
  EXPECT_NEAR(std::atan2(along.y(), along.x()), 0.1, 1e-12);
  EXPECT_FALSE(see_doorway(std::nullopt, handle, X_WB, config, wrong).has_value());
}

TEST(Gripper, StopsOnWhatIsBetweenTheFingers) {
  Gripper gripper(0.08);
  for (int i = 0; i < 500; ++i) gripper.step(true, 0.02, 0.001);
  EXPECT_NEAR(gripper.opening(), 0.03, 1e-9);
  EXPECT_FALSE(gripper.holds(0.02));
  for (int i = 0; i < 200; ++i) gripper.step(true, 0.02, 0.001);
  EXPECT_TRUE(gripper.holds(0.02));
  for (int i = 0; i < 300; ++i) gripper.step(true, 0.0, 0.001);
  EXPECT_NEAR(gripper.opening(), 0.0, 1e-9);
  // Closed fingers that come to a handle do not have it.
  gripper.step(true, 0.02, 0.001);
  EXPECT_FALSE(gripper.holds(0.02));
  for (int i = 0; i < 900; ++i) gripper.step(false, 0.0, 0.001);
  EXPECT_NEAR(gripper.opening(), 0.08, 1e-9);
}

TEST(GripCreep, IsNothingBelowTheSlipForceAndFullSpeedAtTheBreakForce) {
  GraspConfig grasp;
  EXPECT_EQ(grip_creep(grasp, grasp.slip_force, 0.001), 0.0);
  EXPECT_NEAR(grip_creep(grasp, grasp.break_force, 0.001), 5e-5, 1e-12);
  EXPECT_EQ(grip_creep(grasp, std::nan(""), 0.001), 0.0);
}

TEST(CommandPath, LagsDelaysAndRefusesWhatIsNotFinite) {
  PlantConfig config;
  config.delay = 0.02;
  CommandPath path(config, 3);
  Command command;
  command.dq = JointVector::Constant(3, 1.0);
  command.base_v = 0.5;
  path.apply(command);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(path.step().dq(0), 0.0);
  for (int i = 0; i < 15; ++i) (void)path.step();
  // One time constant after the delay.
  EXPECT_NEAR(path.step().dq(0), 1.0 - std::exp(-16.0 / 15.0), 1e-9);
  for (int i = 0; i < 34; ++i) (void)path.step();
  EXPECT_NEAR(path.step().v, 0.5 * (1.0 - std::exp(-0.01)), 1e-9);  // delay and transport delay: 70 ms
  command.base_v = std::numeric_limits<double>::infinity();
  path.apply(command);
  for (int i = 0; i < 2000; ++i) (void)path.step();
  EXPECT_NEAR(path.step().dq.norm(), 0.0, 1e-9);
  EXPECT_NEAR(path.step().v, 0.0, 1e-6);
  command.base_v = 0.0;
  command.dq = JointVector::Zero(2);  // wrong shape
  path.apply(command);
  EXPECT_TRUE(path.step().dq.allFinite());
}

TEST(FaultSchedule, BeginsAtItsTime) {
  const std::vector<Fault> faults = {{Fault::Kind::BaseBlocked, 1.0}};
  EXPECT_FALSE(fault_active(faults, Fault::Kind::BaseBlocked, 0.999));
  EXPECT_TRUE(fault_active(faults, Fault::Kind::BaseBlocked, 1.0));
  EXPECT_FALSE(fault_active(faults, Fault::Kind::GraspLost, 2.0));
}

TEST(PlantConfig, NamesTheKeyThatIsWrong) {
  EXPECT_NO_THROW(PlantConfig().validate());
  const auto message_of = [](const PlantConfig& config) -> std::string {
    try {
      config.validate();
    } catch (const ConfigError& error) {
      return error.what();
    }
    return "";
  };
  PlantConfig config;
  config.time_step = std::nan("");
  EXPECT_NE(message_of(config).find("plant.time_step"), std::string::npos);
  config = PlantConfig();
  config.kind = "bullet";
  EXPECT_NE(message_of(config).find("bullet"), std::string::npos);
  config = PlantConfig();
  config.grasp.break_force = 10.0;
  EXPECT_NE(message_of(config).find("plant.grasp.break_force"), std::string::npos);
}

}  // namespace
}  // namespace ajar
