// Strategy: the force law is closed over a spring with transport delay, where stability (number below π/2) and the
// steady force v sin(error)/α are known in closed form; the speed law is driven by prescribed forces. Left out: arm
// dynamics (plant tests).
#include "ajar/interaction/force_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <limits>
#include <numbers>

#include "ajar/core/error.hpp"

namespace ajar {
namespace {

constexpr double kPeriod = 0.002;
const Vector3d kAlong = Vector3d::UnitX();
const Vector3d kNoAxis = Vector3d::Zero();

struct SpringRun {
  double early_swing = 0.0;  ///< Largest |force| in the second fifth of the run [N]
  double late_swing = 0.0;   ///< Largest |force| in the last fifth [N]
  double final_force = 0.0;  ///< Mean of the last fifth [N]
};

// Hand on a spring across the motion: ẏ = disturbance - v_f(delayed force), f = K y.
SpringRun close_over_spring(const ForceLawConfig& config, double stiffness, int delay_ticks, double disturbance,
                            double start) {
  ForceLaw law(config, kPeriod, delay_ticks * kPeriod);
  std::deque<double> line(static_cast<size_t>(delay_ticks), 0.0);
  double y = start;
  SpringRun run;
  constexpr int kTicks = 5000;
  for (int tick = 0; tick < kTicks; ++tick) {
    line.push_back(stiffness * y);
    const HandWrench wrench{Vector3d(0.0, line.front(), 0.0), Vector3d::Zero()};
    line.pop_front();
    y += kPeriod * (disturbance - law.step(wrench, kAlong, kNoAxis).velocity.y());
    const double force = std::abs(stiffness * y);
    if (tick >= kTicks / 5 && tick < 2 * kTicks / 5) {
      run.early_swing = std::max(run.early_swing, force);
    }
    if (tick >= 4 * kTicks / 5) {
      run.late_swing = std::max(run.late_swing, force);
      run.final_force += stiffness * y / (kTicks / 5);
    }
  }
  return run;
}

ForceLawConfig proportional() {
  ForceLawConfig config;
  config.integral_ratio = 0.0;
  config.deadband = 0.0;
  config.gain_max = 1.0;
  return config;
}

TEST(ForceLaw, GainFollowsStiffnessAndRate) {
  ForceLawConfig config;
  config.total_stiffness = 7e3;
  EXPECT_NEAR(ForceLaw(config, 0.008, 0.02).gain(), config.stability_number / (7e3 * 0.028), 1e-15);
  EXPECT_EQ(ForceLaw(config, 0.002, 0.0).gain(), config.gain_max);
  EXPECT_NEAR(loop_gain(1.0, 0.3, 3e4, 0.1), 1e-4, 1e-15);
}

TEST(ForceLaw, IsStableOnASpringBelowHalfPi) {
  for (const double number : {0.1, 0.3, 0.5, 1.0, 1.4}) {
    ForceLawConfig config = proportional();
    config.stability_number = number;
    const SpringRun run = close_over_spring(config, config.total_stiffness, 10, 0.0, 1e-3);
    EXPECT_LT(run.late_swing, 0.02) << number;  // from 7 N
  }
}

TEST(ForceLaw, OscillatesBeyondHalfPi) {
  ForceLawConfig config = proportional();
  config.stability_number = 1.0;
  // The spring is 1.8 times stiffer than believed: α K (T + d) = 1.8 > π/2.
  const SpringRun run = close_over_spring(config, 1.8 * config.total_stiffness, 10, 0.0, 1e-4);
  EXPECT_GT(run.late_swing, 10.0);  // from 1.3 N, held by |v_f| ≤ v_f,max only
  EXPECT_GT(run.late_swing, 1.26);
}

TEST(ForceLaw, SteadyForceIsSpeedTimesSineOverGain) {
  const ForceLawConfig config = proportional();
  const double disturbance = 0.02 * std::sin(30.0 * std::numbers::pi / 180.0);
  const double gain = ForceLaw(config, kPeriod, 10 * kPeriod).gain();
  const SpringRun run = close_over_spring(config, config.total_stiffness, 10, disturbance, 0.0);
  EXPECT_NEAR(run.final_force, disturbance / gain, 1e-3 * disturbance / gain);
}

TEST(ForceLaw, IntegralRemovesTheSteadyForce) {
  ForceLawConfig config = proportional();
  config.integral_ratio = 2.0;
  const SpringRun run = close_over_spring(config, config.total_stiffness, 10, 0.01, 0.0);
  EXPECT_LT(std::abs(run.final_force), 0.02);
}

TEST(ForceLaw, SubtractsTheDeadBand) {
  ForceLawConfig config = proportional();
  config.deadband = 0.5;
  ForceLaw law(config, kPeriod, 0.0);
  EXPECT_EQ(law.step({Vector3d(0.0, 0.4, 0.0), Vector3d::Zero()}, kAlong, kNoAxis).velocity.norm(), 0.0);
  const ForceCorrection out = law.step({Vector3d(3.0, 0.7, 0.0), Vector3d::Zero()}, kAlong, kNoAxis);
  EXPECT_NEAR(out.velocity.y(), law.gain() * 0.2, 1e-15);
  EXPECT_NEAR(out.normal_force, 0.7, 1e-15);
  EXPECT_NEAR(out.pull_force, 3.0, 1e-15);
  EXPECT_EQ(out.velocity.x(), 0.0);
}

TEST(ForceLaw, StopsIntegratingWhileSaturated) {
  ForceLawConfig config;
  config.integral_ratio = 1.0;
  ForceLaw law(config, kPeriod, 0.0);
  for (int tick = 0; tick < 5000; ++tick) {
    EXPECT_LE(law.step({Vector3d(0.0, 1000.0, 0.0), Vector3d::Zero()}, kAlong, kNoAxis).velocity.norm(),
              config.correction_max + 1e-15);
  }
  // Without windup the correction ends with the force.
  const double left = law.step({Vector3d::Zero(), Vector3d::Zero()}, kAlong, kNoAxis).velocity.norm();
  EXPECT_LT(left, config.gain_max * 1000.0 * kPeriod + 1e-12);
}

TEST(ForceLaw, IntegralTurnsWithTheEstimate) {
  ForceLawConfig config;
  ForceLaw law(config, kPeriod, 0.0);
  for (int tick = 0; tick < 500; ++tick) {
    (void)law.step({Vector3d(0.0, 5.0, 0.0), Vector3d::Zero()}, kAlong, kNoAxis);
  }
  // The direction is now along what was the normal: nothing of the integral may push along it.
  EXPECT_LT(law.step({Vector3d::Zero(), Vector3d::Zero()}, Vector3d::UnitY(), kNoAxis).velocity.norm(), 1e-15);
}

TEST(ForceLaw, LeavesTheFreeAxisOfTheGripAlone) {
  ForceLawConfig config;
  ForceLaw law(config, kPeriod, 0.0);
  const HandWrench wrench{Vector3d::Zero(), Vector3d(0.3, -0.2, 0.5)};
  const Vector3d turn = law.step(wrench, kAlong, Vector3d::UnitZ()).turn;
  EXPECT_NEAR(turn.z(), 0.0, 1e-15);
  EXPECT_NEAR(turn.x() / turn.y(), -1.5, 1e-12);
  EXPECT_LE(law.step({Vector3d::Zero(), Vector3d(100.0, 0.0, 0.0)}, kAlong, kNoAxis).turn.norm(), config.turn_max + 1e-15);
}

TEST(ForceLaw, AnswersNonsenseWithNothing) {
  ForceLaw law({}, kPeriod, 0.0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const HandWrench& wrench :
       {HandWrench{Vector3d(nan, 0.0, 0.0), Vector3d::Zero()}, HandWrench{Vector3d::Zero(), Vector3d(0.0, nan, 0.0)}}) {
    const ForceCorrection out = law.step(wrench, kAlong, kNoAxis);
    EXPECT_EQ(out.velocity.norm(), 0.0);
    EXPECT_EQ(out.turn.norm(), 0.0);
  }
  EXPECT_EQ(law.step({Vector3d(0.0, 9.0, 0.0), Vector3d::Zero()}, Vector3d(nan, 0.0, 0.0), kNoAxis).velocity.norm(), 0.0);
  EXPECT_EQ(law.step({Vector3d(0.0, 9.0, 0.0), Vector3d::Zero()}, Vector3d::Zero(), kNoAxis).velocity.norm(), 0.0);
  EXPECT_GT(law.step({Vector3d(0.0, 9.0, 0.0), Vector3d::Zero()}, kAlong, kNoAxis).velocity.norm(), 0.0);
}

TEST(ForceLawConfig, RefusesWhatIsOutOfRange) {
  ForceLawConfig config;
  config.stability_number = 2.0;
  EXPECT_THROW(ForceLaw(config, kPeriod, 0.0), ConfigError);
  config = {};
  config.total_stiffness = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ForceLaw(config, kPeriod, 0.0), ConfigError);
  EXPECT_THROW(ForceLaw({}, 0.0, 0.0), ConfigError);
  EXPECT_THROW(SpeedLaw({}, -1.0, 0.0), ConfigError);
}

TEST(WantedSpeed, RisesWithConfidenceAndWaitsForTheBase) {
  const ForceLawConfig config;
  SpeedInput input;
  EXPECT_NEAR(wanted_speed(input, config), config.speed_start, 1e-15);
  input.confidence = 1.0;
  EXPECT_NEAR(wanted_speed(input, config), config.speed, 1e-15);
  input.base_lag = 0.18;
  EXPECT_NEAR(wanted_speed(input, config), config.speed_start + 0.5 * (config.speed - config.speed_start), 1e-12);
  input.base_lag = 1.0;
  EXPECT_NEAR(wanted_speed(input, config), config.speed_start + 0.2 * (config.speed - config.speed_start), 1e-12);
  input.speed_cap = 0.01;
  EXPECT_NEAR(wanted_speed(input, config), 0.01, 1e-15);
}

TEST(WantedSpeed, FallsToZeroAtThePullLimit) {
  const ForceLawConfig config;
  SpeedInput input;
  input.confidence = 1.0;
  double last = wanted_speed(input, config);
  for (double force = 0.0; force <= config.force_limit + 5.0; force += 1.0) {
    input.pull_force = force;
    const double speed = wanted_speed(input, config);
    EXPECT_LE(speed, last);
    last = speed;
  }
  EXPECT_EQ(last, 0.0);
}

TEST(WantedSpeed, StandsAtTheForceCapWhileTheDirectionIsUnsure) {
  const ForceLawConfig config;
  SpeedInput input;
  input.force_cap = 16.0;
  EXPECT_NEAR(wanted_speed(input, config), config.speed_start, 1e-12);
  input.pull_force = 16.0;
  EXPECT_EQ(wanted_speed(input, config), 0.0);
}

TEST(SpeedLaw, RampsWithinItsAccelerations) {
  const ForceLawConfig config;
  SpeedLaw law(config, kPeriod, 0.0);
  SpeedInput input;
  input.confidence = 1.0;
  double last = 0.0;
  for (int tick = 0; tick < 1500; ++tick) {
    input.pull_force = tick > 1000 ? config.force_limit + 15.0 : 0.0;
    const double speed = law.step(input);
    if (tick < 1000) {
      EXPECT_LE(speed - last, config.acceleration * kPeriod + 1e-12);
      EXPECT_GE(speed, last - 1e-12);
    }
    last = speed;
    if (tick == 1000) {
      EXPECT_NEAR(speed, config.speed, 1e-9);
    }
  }
  // 15 N over the limit: 25 N above the reserve asks for 5 cm/s backward, bounded.
  EXPECT_NEAR(last, -config.give_speed, 1e-12);
}

// Ten seconds at cruise against a steady pull: the force has become the running force.
SpeedInput cruise_against(double pull, SpeedLaw& law) {
  SpeedInput input;
  input.confidence = 1.0;
  input.pull_force = pull;
  for (int tick = 0; tick < 5000; ++tick) {
    input.measured_speed = law.step(input);
  }
  return input;
}

TEST(SpeedLaw, GivesWayAboveTheRunningForce) {
  const ForceLawConfig config;
  SpeedLaw law(config, kPeriod, 0.0);
  SpeedInput input = cruise_against(5.0, law);
  EXPECT_NEAR(law.running_force(), 5.0, 1e-6);
  // Held for 0.1 s, twenty times the filter of the rate; the filter of 1 s follows by a tenth of the step.
  double speed = 0.0;
  input.pull_force = 5.0 + config.give_margin - 0.1;
  for (int tick = 0; tick < 50; ++tick) speed = law.step(input);
  EXPECT_NEAR(speed, config.speed, 1e-3);
  input.pull_force += 5.1;
  for (int tick = 0; tick < 50; ++tick) speed = law.step(input);
  const double above = input.pull_force - law.running_force() - config.give_margin;
  EXPECT_NEAR(speed, config.speed - config.give_gain * above, 1e-3);
}

// 2 N a millisecond: half way to where a steady force is given way to, the hand already slows down.
TEST(SpeedLaw, AFastRiseIsMetBeforeItIsHigh) {
  const ForceLawConfig config;
  SpeedLaw law(config, kPeriod, 0.0);
  SpeedInput input = cruise_against(5.0, law);
  double speed = 0.0;
  for (int tick = 0; tick < 2; ++tick) {
    input.pull_force += 4.0;
    speed = law.step(input);
  }
  ASSERT_LT(input.pull_force, 5.0 + config.give_margin);
  EXPECT_LT(speed, config.speed - 5e-3);
}

// A handle that does not move yet, held by a grasp 1.8 times stiffer than believed: f = K x, ẋ = v(f a dead time ago).
TEST(SpeedLaw, ALatePullOnAHandleThatHoldsComesToRest) {
  const ForceLawConfig config;
  for (const double period : {0.002, 0.008, 0.02}) {
    for (const double dead_time : {0.0, 0.03, 0.1}) {
      SpeedLaw law(config, period, dead_time);
      std::deque<double> line(1 + static_cast<size_t>(std::lround(dead_time / period)), 0.0);
      SpeedInput input{.force_cap = 16.0};
      double force = 0.0, least = 1e3, most = 0.0;
      for (double time = 0.0; time < 20.0; time += period) {
        line.push_back(force);
        input.pull_force = line.front();
        line.pop_front();
        force += 1.8 * config.total_stiffness * period * law.step(input);
        if (time < 16.0) continue;
        least = std::min(least, force);
        most = std::max(most, force);
      }
      EXPECT_LT(most - least, 1.0) << period << ' ' << dead_time;
      EXPECT_LT(most, input.force_cap + 1e-6) << period << ' ' << dead_time;
      EXPECT_GT(least, 0.75 * input.force_cap) << period << ' ' << dead_time;
    }
  }
}

TEST(SpeedLaw, ABlowHardlyRaisesTheRunningForce) {
  const ForceLawConfig config;
  SpeedLaw law(config, kPeriod, 0.0);
  SpeedInput input = cruise_against(45.0, law);
  const double before = law.running_force();
  input.pull_force = 150.0;
  for (int tick = 0; tick < 50; ++tick) (void)law.step(input);  // 0.1 s in which the measured speed has not fallen yet
  EXPECT_GT(law.running_force(), before);
  EXPECT_LT(law.running_force(), before + 0.1 * config.give_margin + 1e-9);
}

TEST(SpeedLaw, RunningForceWaitsForMotion) {
  SpeedLaw law({}, kPeriod, 0.0);
  SpeedInput input;
  input.pull_force = 25.0;
  for (int tick = 0; tick < 2000; ++tick) {
    (void)law.step(input);
  }
  EXPECT_EQ(law.running_force(), 0.0);
}

TEST(SpeedLaw, BrakesOnNonsense) {
  const ForceLawConfig config;
  SpeedLaw law(config, kPeriod, 0.0);
  SpeedInput input;
  input.confidence = 1.0;
  double speed = 0.0;
  for (int tick = 0; tick < 1000; ++tick) {
    speed = law.step(input);
  }
  input.pull_force = std::numeric_limits<double>::quiet_NaN();
  const double first = law.step(input);
  EXPECT_NEAR(speed - first, config.deceleration * kPeriod, 1e-12);
  for (int tick = 0; tick < 1000; ++tick) {
    speed = law.step(input);
  }
  EXPECT_EQ(speed, 0.0);
  EXPECT_EQ(law.running_force(), 0.0);
}

}  // namespace
}  // namespace ajar
