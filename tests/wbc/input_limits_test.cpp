// Strategy: bounds are judged by what they promise: never empty, order rate > position > acceleration, and a joint that
// always takes the largest allowed rate stops at its limit without ever asking for more deceleration than allowed.
#include "ajar/wbc/input_limits.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

namespace ajar {
namespace {

InputLimits toy_limits() {
  InputLimits limits;
  limits.joints = 2;
  limits.base_moves = true;
  limits.position_lower = JointVector::Constant(2, -1.0);
  limits.position_upper = JointVector::Constant(2, 1.0);
  limits.speed_upper = InputVector::Constant(4, 1.0);
  limits.speed_upper[2] = 0.6;
  limits.speed_upper[3] = 0.3;
  limits.speed_lower = -limits.speed_upper;
  limits.acceleration = InputVector::Constant(4, 8.0);
  limits.acceleration[2] = 0.5;
  limits.acceleration[3] = 0.2;
  limits.deceleration = limits.acceleration;
  limits.deceleration[2] = 2.0;
  limits.deceleration[3] = 1.0;
  limits.wheel_reach = 0.35;
  limits.half_track = 0.25;
  limits.period = 0.008;
  return limits;
}

TEST(StoppingRate, FastestJointStopsAtItsLimitWithinItsDeceleration) {
  for (const double period : {0.002, 0.008, 0.02}) {
    double distance = 0.7;
    double rate = stopping_rate(distance, 8.0, period);
    for (int tick = 0; tick < 2000; ++tick) {
      distance -= rate * period;
      const double next = stopping_rate(distance, 8.0, period);
      EXPECT_LE(rate - next, 8.0 * period + 1e-9);
      rate = next;
    }
    EXPECT_GE(distance, -1e-12);
    EXPECT_LT(distance, 1e-3);
  }
}

TEST(StoppingRate, IsZeroAtAndBeyondTheLimit) {
  EXPECT_EQ(stopping_rate(0.0, 8.0, 0.002), 0.0);
  EXPECT_EQ(stopping_rate(-0.1, 8.0, 0.002), 0.0);
  EXPECT_EQ(stopping_rate(std::nan(""), 8.0, 0.002), 0.0);
  EXPECT_GT(stopping_rate(1e-9, 8.0, 0.002), 0.0);
}

TEST(InputBounds, AreNeverEmptyAndKeepRateAndPosition) {
  std::mt19937 generator(5);
  std::uniform_real_distribution<double> wide(-1.3, 1.3);
  const InputLimits limits = toy_limits();
  for (int trial = 0; trial < 20000; ++trial) {
    const JointVector q = JointVector::NullaryExpr(2, [&] { return wide(generator); });
    const InputVector last = InputVector::NullaryExpr(4, [&] { return wide(generator); });
    const InputBounds bounds = input_bounds(limits, q, last, trial % 5 == 0);
    EXPECT_GE((bounds.upper - bounds.lower).minCoeff(), 0.0);
    EXPECT_LE((bounds.upper - limits.speed_upper).maxCoeff(), 0.0);
    EXPECT_GE((bounds.lower - limits.speed_lower).minCoeff(), 0.0);
    for (int i = 0; i < 2; ++i) {
      EXPECT_EQ(bounds.rate_upper[i], std::min(1.0, stopping_rate(1.0 - q[i], 8.0, limits.period)));
      EXPECT_EQ(bounds.rate_lower[i], -std::min(1.0, stopping_rate(q[i] + 1.0, 8.0, limits.period)));
    }
    // Some pair of the base is within the wheels' reach.
    const double w = std::clamp(0.0, bounds.lower[2], bounds.upper[2]);
    const double v = std::clamp(0.0, bounds.lower[3], bounds.upper[3]);
    EXPECT_LE(std::abs(v) + limits.half_track * std::abs(w), limits.wheel_reach + 1e-12);
  }
}

TEST(InputBounds, AllowOneStepOfAccelerationFromRest) {
  const InputLimits limits = toy_limits();
  const InputBounds bounds = input_bounds(limits, JointVector::Zero(2), InputVector::Zero(4), false);
  EXPECT_TRUE(bounds.upper.isApprox(limits.acceleration * limits.period, 1e-12));
  EXPECT_TRUE(bounds.lower.isApprox(-limits.acceleration * limits.period, 1e-12));
  EXPECT_EQ(bounds.upper_limit[0], BindingLimit::JointAcceleration);
  EXPECT_EQ(bounds.upper_limit[3], BindingLimit::BaseAcceleration);
}

TEST(InputBounds, FixedBaseBrakesWithinItsDeceleration) {
  const InputLimits limits = toy_limits();
  InputVector last = InputVector::Zero(4);
  last[3] = 0.1;
  for (int tick = 0; tick < 100; ++tick) {
    const InputBounds bounds = input_bounds(limits, JointVector::Zero(2), last, true);
    EXPECT_EQ(bounds.lower[3], bounds.upper[3]);
    EXPECT_NEAR(last[3] - bounds.upper[3], std::min(last[3], limits.deceleration[3] * limits.period), 1e-12);
    last[3] = bounds.upper[3];
  }
  EXPECT_EQ(last[3], 0.0);
}

TEST(InputBounds, BaseBrakesHarderOnlyInNeedAndNeverPastZero) {
  const InputLimits limits = toy_limits();
  InputVector last = InputVector::Zero(4);
  last[3] = 0.1;
  const double step = limits.acceleration[3] * limits.period;
  const InputBounds calm = input_bounds(limits, JointVector::Zero(2), last, false);
  EXPECT_NEAR(calm.lower[3], 0.1 - step, 1e-12);
  const InputBounds need = input_bounds(limits, JointVector::Zero(2), last, false, 1.0);
  EXPECT_NEAR(need.lower[3], 0.1 - limits.deceleration[3] * limits.period, 1e-12);
  EXPECT_NEAR(need.upper[3], 0.1 + step, 1e-12);
  last[3] = 0.5 * step;  // from here the hard brake would pass zero: speeding up backwards stays as slow as ever
  EXPECT_NEAR(input_bounds(limits, JointVector::Zero(2), last, false, 1.0).lower[3], -0.5 * step, 1e-12);
}

TEST(InputBounds, RobotOnTheFloorHasNoBase) {
  InputLimits limits = toy_limits();
  limits.base_moves = false;
  limits.speed_lower.tail<2>().setZero();
  limits.speed_upper.tail<2>().setZero();
  const InputBounds bounds = input_bounds(limits, JointVector::Zero(2), InputVector::Constant(4, 0.1), false);
  EXPECT_EQ(bounds.lower.tail<2>().norm(), 0.0);
  EXPECT_EQ(bounds.upper.tail<2>().norm(), 0.0);
}

TEST(BrakedInput, ReachesZeroAndStays) {
  const InputLimits limits = toy_limits();
  InputVector u = limits.speed_upper;
  for (int tick = 0; tick < 400; ++tick) {
    const InputVector next = braked_input(limits, u);
    EXPECT_TRUE((next.cwiseAbs().array() <= u.cwiseAbs().array()).all());
    u = next;
  }
  EXPECT_EQ(u.norm(), 0.0);
}

TEST(LimitWheels, KeepsThePathOfTheBase) {
  const InputLimits limits = toy_limits();
  InputVector u = InputVector::Zero(4);
  u[2] = 0.6;
  u[3] = 0.3;
  limit_wheels(limits, u);
  EXPECT_NEAR(u[3] + 0.25 * u[2], 0.35, 1e-12);
  EXPECT_NEAR(u[2] / u[3], 2.0, 1e-12);
}

}  // namespace
}  // namespace ajar
