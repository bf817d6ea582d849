// Strategy: Heron's real kinematics and problems with known answers: the hand task is met, the base follows, the motion
// slows down before the hand is missed, rows forbid approach and never push away from the world. Random problems, paths
// and timing are in whole_body_properties_test.cpp. Left out: physics.
#include "ajar/wbc/whole_body_controller.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "ajar/core/error.hpp"
#include "heron_wbc.hpp"

namespace ajar {
namespace {

using test::HeronWbc;
using test::kPeriod;
using test::kSpeed;
using test::kTurn;
using test::wall_ahead;

TEST_F(HeronWbc, MeetsTheHandTaskWithTheArmAlone) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  p.tangential << -0.03, 0.02, 0.0, 0.0, 0.0, 0.05;
  p.correction << 0.0, 0.0, 0.01, 0.02, 0.0, 0.0;
  p.base_fixed = true;
  const WbcSolution out = settle(wbc, p);
  EXPECT_EQ(out.status, WbcStatus::Ok);
  EXPECT_GT(out.speed_factor, 0.97);
  EXPECT_LT((kinematics.J * out.u - out.speed_factor * p.tangential - p.correction).norm(), 2e-5);
  EXPECT_EQ(out.u[kSpeed], 0.0);
  EXPECT_EQ(out.u[kTurn], 0.0);
}

TEST_F(HeronWbc, MovesTheBaseAsAskedWhileTheHandStays) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  p.base = {0.05, 0.05};
  const WbcSolution out = settle(wbc, p);
  EXPECT_NEAR(out.u[kSpeed], 0.05, 1e-3);
  EXPECT_NEAR(out.u[kTurn], 0.05, 1e-3);
  EXPECT_LT((kinematics.J * out.u).norm(), 1e-4);
}

TEST_F(HeronWbc, MovesTheArmAgainstTheBaseAsItMoves) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  p.base_motion = BaseMotion{{0.1, 0.0}, 0.0};  // it still rolls although nothing is asked
  const WbcSolution out = settle(wbc, p, 500);
  InputVector motion = out.u;
  motion.tail<2>() << 0.0, 0.1;
  EXPECT_LT((kinematics.J * motion).norm(), 2e-4);
  EXPECT_LT(out.residual, 1e-4);
  EXPECT_EQ(out.u[kSpeed], 0.0);
}

TEST_F(HeronWbc, CountsTheShareOfTheBaseCommandThatShows) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  p.base = {0.05, 0.0};
  p.base_motion = BaseMotion{{0.0, 0.0}, 0.5};  // it stands; half of a change of its command shows at once
  WbcSolution out;
  (void)wbc.solve(p, out);
  InputVector motion = out.u;
  motion.tail<2>() *= 0.5;
  EXPECT_GT(out.u[kSpeed], 1e-4);
  EXPECT_LT((kinematics.J * motion).norm(), 2e-5);
}

// The base turns 0.15 s after it is told; an arm with a fifth of its rates must still be able to hold the hand then.
TEST_F(HeronWbc, TellsALateBaseOnlyWhatTheArmCanFollow) {
  config.rate_scale = 0.05;
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  p.base = {0.0, 0.6};
  constexpr int kLate = 75;
  std::vector<BaseTwist> told(kLate);
  double worst = 0.0;
  double fastest = 0.0;
  WbcSolution out;
  for (int tick = 0; tick < 600; ++tick) {
    p.base_motion = BaseMotion{told[static_cast<size_t>(tick % kLate)], 0.0};
    (void)wbc.solve(p, out);
    told[static_cast<size_t>(tick % kLate)] = {out.u[kSpeed], out.u[kTurn]};
    worst = std::max(worst, out.residual);
    fastest = std::max(fastest, out.u[kTurn]);
  }
  EXPECT_GT(fastest, 0.05);
  EXPECT_LT(fastest, 0.5);
  EXPECT_LT(worst, 2e-3);
}

TEST_F(HeronWbc, SlowsTheTangentialMotionBeforeTheHandTaskIsGivenUp) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  p.tangential << -2.0, 0.0, 0.0, 0.0, 0.0, 0.0;  // far beyond the joint rates
  p.correction << 0.0, 0.01, 0.0, 0.0, 0.0, 0.0;
  p.base_fixed = true;
  const WbcSolution out = settle(wbc, p);
  EXPECT_EQ(out.status, WbcStatus::Slowed);
  EXPECT_LT(out.speed_factor, 0.9);
  EXPECT_GT(out.speed_factor, 0.05);
  EXPECT_LT(out.residual, 1e-3);
  EXPECT_EQ(out.binding, BindingLimit::JointRate);
}

TEST_F(HeronWbc, LeavesTheFreeAxisToTheWeakTurn) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  p.tangential << -0.04, 0.0, 0.0, 0.0, 0.0, 0.3;
  p.free_axis = Vector3d::UnitZ();
  p.free_axis_rate = -0.1;
  p.base_fixed = true;
  const WbcSolution out = settle(wbc, p);
  const Vector6d twist = kinematics.J * out.u;
  EXPECT_LT((twist.head<3>() - out.speed_factor * p.tangential.head<3>()).norm(), 1e-4);
  EXPECT_LT(twist.segment<2>(3).norm(), 1e-3);
  EXPECT_LT(twist[5], 0.02);   // not the 0.3 rad/s of the mechanism …
  EXPECT_GT(twist[5], -0.12);  // … but towards the weak turn
}

TEST_F(HeronWbc, BaseThatMustStandBrakesAndStays) {
  WholeBodyController wbc(model, config, kPeriod);
  InputVector last = InputVector::Zero(8);
  last[kSpeed] = 0.1;
  last[kTurn] = 0.2;
  wbc.reset(last);
  WbcProblem p = problem();
  p.base_fixed = true;
  p.base = {0.2, 0.3};
  WbcSolution out;
  for (int tick = 0; tick < 400; ++tick) {
    (void)wbc.solve(p, out);
  }
  EXPECT_EQ(out.u[kSpeed], 0.0);
  EXPECT_EQ(out.u[kTurn], 0.0);
}

TEST_F(HeronWbc, ApproachesAWallOnlyAtTheAllowedRate) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  const ClearanceResult clearance = wall_ahead(0.10, ClearanceKind::BaseWorld, 3);
  p.clearance = &clearance;
  p.base = {0.2, 0.0};
  const WbcSolution out = settle(wbc, p);
  const ClearanceLimits limits = ClearanceConfig{}.base_world;
  EXPECT_NEAR(out.u[kSpeed], limits.rate * (0.10 - limits.stop), 1e-3);
  EXPECT_EQ(out.binding, BindingLimit::Clearance);
}

TEST_F(HeronWbc, NeverPushesAwayFromTheWorld) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  const ClearanceResult inside = wall_ahead(-0.05, ClearanceKind::BaseWorld, 3);
  p.clearance = &inside;
  WbcSolution out = settle(wbc, p);
  EXPECT_LT(out.u.norm(), 1e-6);
  // The own body may be left, gently.
  const ClearanceResult own = wall_ahead(-0.05, ClearanceKind::Self, -1);
  p.clearance = &own;
  out = settle(wbc, p);
  EXPECT_NEAR(out.u[kSpeed], -0.05, 5e-3);
}

TEST_F(HeronWbc, LeafThatComesTowardsTheRobotLowersTheSpeedFactor) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  ClearanceResult clearance = wall_ahead(0.04, ClearanceKind::BaseWorld, 2);
  clearance.rows[0].point_on_obstacle = kinematics.X_WE.translation();
  p.clearance = &clearance;
  p.leaf_obstacle = 2;
  p.base_fixed = true;
  p.tangential.head<3>() = Vector3d(-0.04, 0.0, 0.0);
  p.leaf_velocity_at_hand = Vector3d(-0.04, 0.0, 0.0);  // along the row's normal: the leaf swings at the robot
  const WbcSolution out = settle(wbc, p);
  EXPECT_LT(out.speed_factor, 0.02);
  EXPECT_LT(out.slack, 1e-3);
  EXPECT_EQ(out.binding, BindingLimit::Clearance);
  p.leaf_obstacle = 1;  // the same box standing still forbids nothing
  EXPECT_GT(settle(wbc, p).speed_factor, 0.95);
}

TEST_F(HeronWbc, OneSlackKeepsContradictingRowsSolvable) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  ClearanceResult clearance = wall_ahead(0.0, ClearanceKind::Self, -1);
  clearance.count = kMaxClearanceRows;
  for (size_t i = 1; i < kMaxClearanceRows; ++i) {
    clearance.rows[i] = clearance.rows[0];
    clearance.rows[i].row *= i % 2 == 0 ? 1.0 : -1.0;
  }
  p.clearance = &clearance;
  const WbcSolution out = settle(wbc, p, 50);
  EXPECT_NE(out.status, WbcStatus::Invalid);
  EXPECT_NEAR(out.slack, 0.05, 1e-3);
}

TEST_F(HeronWbc, BrakesOnBrokenInputWithinItsDecelerations) {
  WholeBodyController wbc(model, config, kPeriod);
  WbcProblem p = problem();
  p.tangential << -0.05, 0.05, 0.0, 0.0, 0.0, 0.1;
  p.base = {0.1, 0.1};
  InputVector last = settle(wbc, p).u;
  p.correction[0] = std::nan("");
  WbcSolution out;
  for (int tick = 0; tick < 1000; ++tick) {
    EXPECT_EQ(wbc.solve(p, out), WbcStatus::Invalid);
    EXPECT_TRUE((out.u.cwiseAbs().array() <= last.cwiseAbs().array()).all());
    EXPECT_LE(std::abs(out.u[kSpeed] - last[kSpeed]), config.base_braking * config.base_acceleration * kPeriod + 1e-12);
    last = out.u;
  }
  EXPECT_EQ(last.norm(), 0.0);
  p.kinematics = nullptr;
  EXPECT_EQ(wbc.solve(p, out), WbcStatus::Invalid);
}

TEST_F(HeronWbc, RefusesWrongSettings) {
  config.rate_scale = 1.5;
  EXPECT_THROW(WholeBodyController(model, config, kPeriod), ConfigError);
  EXPECT_THROW(WholeBodyController(model, {}, 0.0), ConfigError);
}

}  // namespace
}  // namespace ajar
