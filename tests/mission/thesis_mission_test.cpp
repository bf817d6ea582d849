// Strategy: the same door opened by both laws on the kinematic plant. What tells them apart is what each promises: the
// thesis's law turns the base along the motion of the hand, the QP turns a base pose with the leaf. The commands of every
// tick, from the first pull until the hand stands again, are held against the limits of rates, wheels and accelerations.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"
#include "ajar/mechanism/builders.hpp"
#include "ajar/mission/mission.hpp"
#include "ajar/plant/kinematic_plant.hpp"
#include "ajar/wbc/input_limits.hpp"

namespace ajar {
namespace {

struct Opening {
  bool reached_goal = false;
  double angle = 0.0;          // true [rad]
  double heading_error = 0.0;  // between the base's driving line and the motion when the goal is reached, [0, π/2] [rad]
  double excess_rate = -1.0;   // largest command beyond a speed limit, over that limit [-]
  double excess_step = -1.0;   // largest change of a command beyond an acceleration limit, over that step [-]
};

double angle_to_motion(const MissionRecord& record) {
  const Vector3d& x = record.estimate.direction;
  const Kinematics& k = record.kinematics;
  const Eigen::Index drive = k.J.cols() - 1;
  return std::abs(wrap_angle(2.0 * (std::atan2(k.J(1, drive), k.J(0, drive)) - std::atan2(x.y(), x.x())))) / 2.0;
}

void watch_limits(const InputLimits& limits, const InputVector& last, const InputVector& u, Opening& run) {
  for (int i = 0; i < u.size(); ++i) {
    run.excess_rate = std::max(run.excess_rate, std::abs(u[i]) / limits.speed_upper[i] - 1.0);
    const double largest = std::abs(u[i]) < std::abs(last[i]) ? limits.deceleration[i] : limits.acceleration[i];
    run.excess_step = std::max(run.excess_step, std::abs(u[i] - last[i]) / (largest * limits.period) - 1.0);
  }
  const double rim = std::abs(u[limits.joints + 1]) + limits.half_track * std::abs(u[limits.joints]);
  run.excess_rate = std::max(run.excess_rate, rim / limits.wheel_reach - 1.0);
}

Opening open_door(const MissionConfig& config) {
  const RobotModel robot = load_robot("heron");
  MechanismConfig door;
  door.radius = 0.8;
  PlantConfig plant_config;
  plant_config.kind = "kinematic";
  KinematicPlant plant(robot, make_mechanism(door), plant_config, BasePose{0.2, -1.6, 1.4}, robot.home());
  plant.reset(1);
  Mission mission(robot, config, Vector3d(0.3, -0.95, 0.0).normalized(), 1);
  const InputLimits limits = make_input_limits(robot, config.wbc, config.period);
  Opening run;
  InputVector last = InputVector::Zero(robot.inputs());
  InputVector u = last;
  RobotState state = plant.measure();
  double released = 0.0;
  while (!mission.finished()) {
    const Phase before = mission.phase();
    const Command command = mission.step(state);
    u << command.dq, command.base_w, command.base_v;
    released += before == Phase::Release ? config.period : 0.0;
    // Between phases the mission leaves a zero command on purpose.
    const bool stays = before == mission.phase() || mission.phase() == Phase::Release;
    const bool opens = before == Phase::Open || (before == Phase::Release && released < 0.3);
    if (stays && opens) watch_limits(limits, last, u, run);
    if (before == Phase::Open) {
      run.heading_error = angle_to_motion(mission.record());
    }
    last = u;
    plant.apply(command);
    plant.advance(config.period);
    state = plant.measure();
  }
  run.reached_goal = mission.reached_goal();
  run.angle = plant.truth().opening;
  return run;
}

MissionConfig with_controller(const char* controller) {
  MissionConfig config;
  config.controller = controller;
  config.force.speed = 0.1;  // the null space brings the base along at half the speed of the QP
  config.thesis.w_base = 10.0;
  return config;
}

TEST(ThesisMission, OpensWithTheBaseAlongTheMotionAsTheQpDoesNot) {
  const Opening thesis = open_door(with_controller("thesis"));
  const Opening qp = open_door(with_controller("qp"));
  EXPECT_TRUE(thesis.reached_goal);
  EXPECT_TRUE(qp.reached_goal);
  EXPECT_GT(thesis.angle, 0.98 * std::numbers::pi / 2.0);
  // The tasks of distance and heading share two degrees of freedom: a few degrees remain.
  EXPECT_LT(thesis.heading_error, 0.15);
  EXPECT_GT(qp.heading_error, 2.0 * thesis.heading_error + 0.1);
}

TEST(ThesisMission, StaysInsideItsLimitsUntilTheHandStandsAgain) {
  const Opening run = open_door(with_controller("thesis"));
  EXPECT_LE(run.excess_rate, 1e-9);
  EXPECT_LE(run.excess_step, 1e-6);
}

TEST(ThesisMission, RefusesWrongGainsWhicheverLawIsChosen) {
  MissionConfig config;
  config.thesis.w_base = 0.0;
  EXPECT_THROW(config.validate(), ConfigError);
}

}  // namespace
}  // namespace ajar
