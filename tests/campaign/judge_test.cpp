// Strategy: a synthetic door or drawer whose hand, force and belief follow closed forms is shown to the judge tick by tick;
// every figure must come out as the algebra says. Left out: what the plants report (their own tests).
#include "ajar/campaign/judge.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ajar {
namespace {

constexpr double kPeriod = 0.002;

JudgeConfig hinge_config() {
  JudgeConfig config;
  config.period = kPeriod;
  config.goal.opening_angle = M_PI / 2;
  config.travel = 1.9;
  config.limits.position_lower = JointVector::Constant(2, -3.0);
  config.limits.position_upper = JointVector::Constant(2, 3.0);
  config.limits.velocity = JointVector::Constant(2, 2.0);
  config.limits.acceleration = JointVector::Constant(2, 5.0);
  return config;
}

/// One tick of a hinge about world z through the origin with radius r; fields may be changed before it is shown.
struct Scene {
  RobotState state;
  Truth truth;
  MissionRecord record;
  Command command;
  double tick_us = 10.0;
  double radius = 0.8;

  Scene() {
    state.q = state.dq = truth.q = truth.dq = command.dq = JointVector::Zero(2);
    record.phase = Phase::Open;
    set_hinge(0.0);
  }
  void set_hinge(double q) {
    truth.opening = q;
    truth.handle = radius * Vector3d(std::cos(q), std::sin(q), 0.0);
    truth.direction = Vector3d(-std::sin(q), std::cos(q), 0.0);
    truth.curvature = Vector3d(0.0, 0.0, 1.0 / radius);
    truth.hand.translation() = truth.handle;
    record.estimate.direction = truth.direction;
    record.estimate.curvature = truth.curvature;
  }
  void show(Judge& judge) {
    judge.observe({state, truth, record, command, tick_us});
    state.time += kPeriod;
  }
};

RunEnd end_of(bool claimed) {
  RunEnd end;
  end.claimed = claimed;
  end.phase = Phase::Done;
  end.reason = claimed ? EndReason::GoalReached : EndReason::Locked;
  end.duration = 10.0;
  end.wall_seconds = 0.5;
  return end;
}

RunResult open_to(double opening, bool claimed, const JudgeConfig& config = hinge_config()) {
  Judge judge(config);
  Scene scene;
  for (int i = 0; i <= 100; ++i) {
    scene.set_hinge(opening * i / 100.0);
    scene.show(judge);
  }
  return judge.finish(end_of(claimed));
}

constexpr double kDegree = M_PI / 180.0;

TEST(Judge, OpenedNeedsTheClaimAndTheTruth) {
  EXPECT_EQ(open_to(86 * kDegree, true).outcome, "opened");
  EXPECT_EQ(open_to(86 * kDegree, false).outcome, "stopped");
  const RunResult liar = open_to(84 * kDegree, true);
  EXPECT_EQ(liar.outcome, "stopped");
  EXPECT_EQ(liar.reason, "claimed_but_not_open");
  EXPECT_EQ(liar.exit_code(), 1);
  EXPECT_NEAR(liar.opening_fraction.value(), 84.0 / 90.0, 1e-12);
}

TEST(Judge, AnEarlierEndStopIsTheGoal) {
  JudgeConfig config = hinge_config();
  config.travel = 80 * kDegree;
  EXPECT_NEAR(opening_needed(config), 0.97 * 80 * kDegree, 1e-12);
  const RunResult result = open_to(79 * kDegree, true, config);
  EXPECT_EQ(result.outcome, "opened");
  EXPECT_NEAR(result.opening_fraction.value(), 79.0 / 80.0, 1e-12);
  config.goal.to_the_stop = true;
  config.travel = 120 * kDegree;
  EXPECT_EQ(open_to(100 * kDegree, true, config).outcome, "stopped");
  config.kind = JointKind::Slide;
  config.goal.to_the_stop = false;
  config.goal.opening_length = 0.6;
  config.travel = 0.4;
  EXPECT_NEAR(opening_needed(config), 0.97 * 0.4, 1e-12);
}

TEST(Judge, OpeningCountsAtTheEndOfOpeningNotAfterRelease) {
  Judge judge(hinge_config());
  Scene scene;
  scene.set_hinge(1.5);
  scene.show(judge);
  scene.record.phase = Phase::Retreat;
  scene.set_hinge(0.2);  // a closer has shut it again
  scene.show(judge);
  EXPECT_DOUBLE_EQ(judge.finish(end_of(true)).opening.value(), 1.5);
}

TEST(Judge, SplitsForceIntoPullAndNormalOverTwentyMilliseconds) {
  Judge judge(hinge_config());
  Scene scene;
  for (int i = 0; i < 100; ++i) {
    const bool spike = i == 50;
    const Vector3d normal = Vector3d::UnitZ() * (spike ? 103.0 : 3.0);
    scene.truth.force = 7.0 * scene.truth.direction + normal;
    scene.truth.torque = Vector3d(0.0, 4.0, 0.0);
    scene.show(judge);
  }
  const RunResult result = judge.finish(end_of(false));
  EXPECT_NEAR(result.peak_normal_force.value(), 13.0, 1e-9);  // (9 · 3 + 103) / 10
  EXPECT_NEAR(result.peak_normal_force_free.value(), 13.0, 1e-9);
  EXPECT_NEAR(result.mean_normal_force.value(), 4.0, 1e-9);  // 3 + 100 / 100
  EXPECT_NEAR(result.peak_pull_force.value(), 7.0, 1e-9);
  EXPECT_NEAR(result.peak_torque.value(), 4.0, 1e-9);
  EXPECT_FALSE(result.stop_force.has_value());
  EXPECT_FALSE(result.peak_probe_force.has_value());
  EXPECT_FALSE(result.late_normal_force.has_value());
}

TEST(Judge, ForceAtTheEndStopIsToldApart) {
  Judge judge(hinge_config());
  Scene scene;
  scene.truth.force = Vector3d(0.0, 0.0, 5.0);
  scene.set_hinge(1.0);
  for (int i = 0; i < 50; ++i) scene.show(judge);
  scene.set_hinge(1.899);  // 0.8 mm before the stop
  scene.truth.force = Vector3d(0.0, 0.0, 60.0);
  for (int i = 0; i < 50; ++i) scene.show(judge);
  const RunResult result = judge.finish(end_of(true));
  EXPECT_NEAR(result.stop_force.value(), 60.0, 1e-9);
  EXPECT_NEAR(result.peak_normal_force.value(), 60.0, 1e-9);
  EXPECT_NEAR(result.peak_normal_force_free.value(), 5.0, 1e-9);
  EXPECT_NEAR(result.late_normal_force.value(), 5.0, 1e-9);
  EXPECT_NEAR(result.late_normal_force_peak.value(), 5.0, 1e-9);
}

TEST(Judge, ProbeForceIsThatOfTheProbeOnly) {
  Judge judge(hinge_config());
  Scene scene;
  scene.record.phase = Phase::Probe;
  scene.truth.force = Vector3d(3.0, 4.0, 0.0);
  for (int i = 0; i < 20; ++i) scene.show(judge);
  scene.record.phase = Phase::Open;
  scene.truth.force = Vector3d(0.0, 0.0, 30.0);
  for (int i = 0; i < 20; ++i) scene.show(judge);
  const RunResult result = judge.finish(end_of(false));
  EXPECT_NEAR(result.peak_probe_force.value(), 5.0, 1e-9);
  EXPECT_NEAR(result.probe_duration.value(), 20 * kPeriod, 1e-12);
  EXPECT_NEAR(result.open_duration.value(), 20 * kPeriod, 1e-12);
}

TEST(Judge, ProbingIsComparedWithWhatTheMechanismNeedsWhereItIsProbed) {
  JudgeConfig config = hinge_config();
  // 3 N to break loose where it is closed, then 1 N and 10 N/rad.
  config.force_needed = [](double opening) { return opening > 0.0 ? 1.0 + 10.0 * opening : 3.0; };
  Judge judge(config);
  Scene scene;
  scene.record.phase = Phase::Probe;
  scene.set_hinge(1e-4);  // within the play of the closed end
  scene.truth.force = Vector3d(0.0, 8.0, 6.0);
  for (int i = 0; i < 20; ++i) scene.show(judge);
  scene.record.phase = Phase::Open;
  scene.set_hinge(0.05);
  scene.record.estimate.direction = Eigen::AngleAxisd(0.2, Vector3d::UnitZ()) * scene.truth.direction;
  scene.show(judge);
  const RunResult result = judge.finish(end_of(false));
  EXPECT_NEAR(result.probe_force_over_need.value(), 10.0 - 3.0, 1e-9);
  EXPECT_NEAR(result.probe_direction_error.value(), 0.2, 1e-9);

  Judge without(hinge_config());
  Scene open;
  open.show(without);
  EXPECT_FALSE(without.finish(end_of(false)).probe_force_over_need.has_value());
  EXPECT_FALSE(without.finish(end_of(false)).probe_direction_error.has_value());
}

TEST(Judge, ComparesBeliefInTheRobotsFrameAtTheStatedArcs) {
  Judge judge(hinge_config());
  Scene scene;
  scene.truth.base = {1.0, 2.0, 0.3};
  scene.state.base = {1.03, 2.04, 0.1};
  // The robot thinks that it is turned by 0.2 rad less than it is; it sees the same of its hand.
  const Eigen::AngleAxisd hand(0.4, Vector3d(1.0, 2.0, 3.0).normalized());
  scene.truth.hand.linear() = Matrix3d(Eigen::AngleAxisd(0.2, Vector3d::UnitZ()) * hand);
  scene.record.kinematics.X_WE.linear() = hand.toRotationMatrix();
  for (int i = 0; i <= 600; ++i) {
    scene.set_hinge(i * 0.001);
    const double off = 0.5 - i * 0.0005;  // shrinking error about the vertical, in the robot's frame: minus 0.2
    scene.record.estimate.direction = Eigen::AngleAxisd(off - 0.2, Vector3d::UnitZ()) * scene.truth.direction;
    scene.record.estimate.curvature = Vector3d(0.0, 0.0, 1.0 / scene.radius + off);
    scene.record.estimate.direction_sigma = 0.03;
    scene.record.estimate.curvature_sigma = 0.4;
    scene.record.estimate.angle = 0.9 * scene.truth.opening;
    scene.record.estimate.type = MechanismType::Hinge;
    scene.show(judge);
  }
  const RunResult result = judge.finish(end_of(false));
  EXPECT_NEAR(result.direction_error_start.value(), 0.5 - 0.0005, 1e-9);
  EXPECT_NEAR(result.direction_error_10cm.value(), 0.5 - 125 * 0.0005, 1e-9);  // 0.10 m / 0.8 m = 0.125 rad
  EXPECT_NEAR(result.direction_error_20cm.value(), 0.5 - 250 * 0.0005, 1e-9);
  EXPECT_NEAR(result.curvature_error_20cm.value(), 0.5 - 250 * 0.0005, 1e-9);
  EXPECT_NEAR(result.curvature_error_40cm.value(), 0.5 - 500 * 0.0005, 1e-9);
  EXPECT_NEAR(result.direction_error_final.value(), 0.2, 1e-9);
  EXPECT_NEAR(result.curvature_error_final.value(), 0.2, 1e-9);
  EXPECT_NEAR(result.curvature_sigma_final.value(), 0.4, 1e-12);
  EXPECT_NEAR(result.angle_error_final.value(), 0.06, 1e-9);
  EXPECT_EQ(result.mechanism_type_estimated, "hinge");
  EXPECT_NEAR(result.handle_travel.value(), 0.48, 1e-9);
  EXPECT_NEAR(result.odometry_error_final.value(), 0.05, 1e-9);
  EXPECT_NEAR(result.odometry_yaw_error_final.value(), 0.2, 1e-9);
}

TEST(Judge, PathErrorIsSlipInTheLeafNotItsTurning) {
  Judge judge(hinge_config());
  Scene scene;
  for (int i = 0; i <= 100; ++i) {
    const double q = 0.01 * i;
    scene.set_hinge(q);
    const double slip = i > 50 ? 0.004 : 0.0;
    const Vector3d offset(0.010 + slip, 0.0, 0.0);  // fixed in the turning leaf
    scene.truth.hand.translation() = scene.truth.handle + Eigen::AngleAxisd(q, Vector3d::UnitZ()) * offset;
    scene.show(judge);
  }
  EXPECT_NEAR(judge.finish(end_of(false)).path_error_max.value(), 0.004, 1e-12);
}

TEST(Judge, DistanceHeadingSingularityAndClearance) {
  Judge judge(hinge_config());
  Scene scene;
  scene.record.base.heading_error = 9.0;  // before the base moves: not counted
  scene.record.kinematics.distance = 0.7;
  scene.record.clearance_min = std::numeric_limits<double>::infinity();
  scene.show(judge);
  scene.state.base_v = 0.1;
  scene.record.solution.sigma_min = 0.11;
  scene.record.clearance_min = 0.06;
  for (const double error : {0.3, -0.4}) {
    scene.record.base.heading_error = error;
    scene.record.kinematics.distance = 0.8 + error;
    scene.show(judge);
  }
  const RunResult result = judge.finish(end_of(false));
  EXPECT_NEAR(result.distance_min.value(), 0.4, 1e-12);
  EXPECT_NEAR(result.distance_max.value(), 1.1, 1e-12);
  EXPECT_NEAR(result.heading_error_max.value(), 0.4, 1e-12);
  EXPECT_NEAR(result.heading_error_rms.value(), std::sqrt((0.09 + 0.16) / 2), 1e-12);
  EXPECT_NEAR(result.min_singular_value.value(), 0.11, 1e-12);
  EXPECT_NEAR(result.min_clearance.value(), 0.06, 1e-12);
}

TEST(Judge, CountsLimitsAndCommandsThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const auto count = [](auto change) {
    Judge judge(hinge_config());
    Scene scene;
    change(scene);
    scene.show(judge);
    return judge.finish(end_of(false));
  };
  EXPECT_EQ(count([](Scene&) {}).limit_violations, 0);
  EXPECT_EQ(count([](Scene& s) { s.command.dq[1] = 2.0; }).limit_violations, 0);
  EXPECT_EQ(count([](Scene& s) { s.command.dq[1] = -2.001; }).limit_violations, 1);
  EXPECT_EQ(count([](Scene& s) { s.command.base_v = 0.81; }).limit_violations, 1);
  EXPECT_EQ(count([](Scene& s) { s.command.base_v = -0.31; }).limit_violations, 1);
  EXPECT_EQ(count([](Scene& s) { s.command.base_w = 1.01; }).limit_violations, 1);
  EXPECT_EQ(count([](Scene& s) { s.truth.q[0] = 3.01; }).limit_violations, 1);
  EXPECT_EQ(count([](Scene& s) { s.truth.dq[0] = 2.09; }).limit_violations, 0);
  EXPECT_EQ(count([](Scene& s) { s.truth.dq[0] = 2.2; }).limit_violations, 1);
  const RunResult bad = count([&](Scene& s) { s.command.dq[0] = nan; });
  EXPECT_EQ(bad.nonfinite_commands, 1);
  const RunResult first = count([](Scene& s) { s.command.dq[1] = 4.0; });
  EXPECT_NE(first.limit_violation_first.find("joint 2"), std::string::npos) << first.limit_violation_first;
}

TEST(Judge, WheelSpeedLimitCouplesDrivingAndTurning) {
  JudgeConfig config = hinge_config();
  config.wheel_radius = 0.1;
  config.wheel_track = 0.5;
  config.limits.wheel_speed = 7.0;  // 0.7 m/s at the rim; v + ω track / 2 = 0.5 + 0.25
  Judge judge(config);
  Scene scene;
  scene.command.base_v = 0.5;
  scene.command.base_w = 0.75;
  scene.show(judge);
  scene.command.base_w = 1.0;
  scene.show(judge);
  EXPECT_EQ(judge.finish(end_of(false)).limit_violations, 1);
}

TEST(Judge, TimesTicksAndTheRun) {
  Judge judge(hinge_config());
  Scene scene;
  for (int i = 1; i <= 1000; ++i) {
    scene.tick_us = i == 1000 ? 5000.0 : 100.0;
    scene.show(judge);
  }
  const RunResult result = judge.finish(end_of(false));
  EXPECT_NEAR(result.tick_us.p50, 100.0, 1e-6);
  EXPECT_NEAR(result.tick_us.max, 5000.0, 1e-6);
  EXPECT_EQ(result.missed_ticks, 1);
  EXPECT_NEAR(result.real_time_factor.value(), 20.0, 1e-12);
}

TEST(Judge, SurvivesNotANumber) {
  Judge judge(hinge_config());
  Scene scene;
  for (int i = 0; i < 30; ++i) scene.show(judge);
  scene.truth.force.setConstant(std::numeric_limits<double>::quiet_NaN());
  scene.record.kinematics.distance = std::numeric_limits<double>::quiet_NaN();
  for (int i = 0; i < 30; ++i) scene.show(judge);
  const RunResult result = judge.finish(end_of(false));
  EXPECT_EQ(result.peak_normal_force.value(), 0.0);
  EXPECT_EQ(to_json(result).find("nan"), std::string::npos);
}

TEST(Judge, WhatDidNotHappenIsNotMadeUp) {
  Judge judge(hinge_config());
  Scene scene;
  scene.record.phase = Phase::Approach;
  scene.show(judge);
  const RunResult result = judge.finish(end_of(false));
  for (const ResultField& field : result_fields(result)) {
    for (const char* name :
         {"peak_normal_force_N", "open_duration_s", "distance_min_m", "direction_error_final_rad", "stop_force_N"}) {
      if (field.name == name) {
        EXPECT_EQ(csv_cell(field), "") << name;
      }
    }
  }
  EXPECT_NE(to_json(result).find("\"peak_normal_force_N\": null"), std::string::npos);
}

}  // namespace
}  // namespace ajar
