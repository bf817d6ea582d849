// Strategy: the drives are integrated in steps of 0.1 ms by code that shares nothing with the predictor (a list of commands
// with their times, Euler's rule); what was foreseen must come true. Then odometry that is late, exact drives, and nonsense.
#include "ajar/wbc/state_predictor.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "ajar/core/error.hpp"
#include "ajar/model/robot_model.hpp"

namespace ajar {
namespace {

constexpr int kJoints = 6;
constexpr double kStep = 1e-4;

/// Arm and base that answer as the predictor believes, told random commands.
class Drives {
 public:
  Drives(const DriveConfig& config, double period, double dead_time)
      : predictor(config, kJoints, period, dead_time), config_(config), period_(period), dead_time_(dead_time) {
    state.q = JointVector::Zero(kJoints);
    state.dq = JointVector::Zero(kJoints);
  }

  /// Sends one command and lets its tick pass.
  void tick(const Command& command) {
    commands_.push_back(command);
    predictor.sent(command);
    pass(period_);
  }
  void random_tick() {
    Command command;
    command.dq = JointVector::NullaryExpr(kJoints, [&] { return uniform_(generator_); });
    command.base_v = 0.3 * uniform_(generator_);
    command.base_w = uniform_(generator_);
    tick(command);
  }
  /// Time passes without a new command: the last one goes on.
  void pass(double seconds) {
    const long steps = std::lround(seconds / kStep);
    for (long i = 0; i < steps; ++i) {
      const double time = static_cast<double>(step_++) * kStep;
      const Command arm = acting(time - dead_time_);
      const Command base = acting(time - dead_time_ - config_.base_delay);
      state.dq += std::min(1.0, kStep / config_.arm_lag) * (arm.dq - state.dq);
      state.q += kStep * state.dq;
      state.base_v += std::min(1.0, kStep / config_.base_lag) * (base.base_v - state.base_v);
      state.base_w += std::min(1.0, kStep / config_.base_lag) * (base.base_w - state.base_w);
      state.base = integrate_base(state.base, state.base_v, state.base_w, kStep);
    }
  }
  void rest() {
    Command stop;
    stop.dq = JointVector::Zero(kJoints);
    commands_.push_back(stop);
    pass(3.0);
  }

  StatePredictor predictor;
  RobotState state;

 private:
  [[nodiscard]] Command acting(double sent) const {
    const auto index = static_cast<long>(std::floor(sent / period_ + 1e-6));
    if (index >= 0 && !commands_.empty()) {
      return commands_[static_cast<std::size_t>(std::min(index, static_cast<long>(commands_.size()) - 1))];
    }
    Command none;
    none.dq = JointVector::Zero(kJoints);
    return none;
  }

  DriveConfig config_;
  double period_;
  double dead_time_;
  std::vector<Command> commands_;
  long step_ = 0;
  std::mt19937 generator_{7};
  std::uniform_real_distribution<double> uniform_{-1.0, 1.0};
};

double distance(const BasePose& a, const BasePose& b) { return std::hypot(a.x - b.x, a.y - b.y); }

struct Loop {
  double period;
  double dead_time;
};

class LateLoops : public ::testing::TestWithParam<Loop> {};

// Euler's rule is off by half a step of the rates: 0.05 ms times 1 rad/s.
constexpr double kEuler = 2e-4;

TEST_P(LateLoops, ForeseeWhereArmAndBaseStandWhenAllCommandsAreCarriedOut) {
  Drives drives({}, GetParam().period, GetParam().dead_time);
  for (int i = 0; i < 40; ++i) drives.random_tick();
  const PredictedState seen = drives.predictor.predict(drives.state);
  drives.rest();
  EXPECT_LT((seen.q - drives.state.q).cwiseAbs().maxCoeff(), kEuler);
  EXPECT_LT(distance(seen.base_end, drives.state.base), kEuler);
  EXPECT_NEAR(seen.base_end.yaw, drives.state.base.yaw, kEuler);
}

TEST_P(LateLoops, ForeseeTheBaseWhileTheArmFollowsThisTick) {
  const DriveConfig config;
  Drives drives(config, GetParam().period, GetParam().dead_time);
  for (int i = 0; i < 40; ++i) drives.random_tick();
  const PredictedState seen = drives.predictor.predict(drives.state);
  EXPECT_EQ(seen.base_motion.share, 0.0);  // the arm is done before the base begins
  EXPECT_NEAR(seen.base_lead, 0.135, 1e-12);
  drives.pass(GetParam().dead_time + config.arm_lag);
  EXPECT_LT(distance(seen.base, drives.state.base), kEuler);
  EXPECT_NEAR(seen.base.yaw, drives.state.base.yaw, kEuler);
  const BasePose before = drives.state.base;
  drives.pass(GetParam().period);
  EXPECT_NEAR(seen.base_motion.twist.w, (drives.state.base.yaw - before.yaw) / GetParam().period, 2e-3);
  EXPECT_NEAR(std::abs(seen.base_motion.twist.v), distance(before, drives.state.base) / GetParam().period, 2e-3);
}

TEST_P(LateLoops, BringOldOdometryUpToDate) {
  Drives drives({}, GetParam().period, GetParam().dead_time);
  for (int i = 0; i < 40; ++i) drives.random_tick();
  const RobotState old = drives.state;
  const double age = GetParam().period * std::ceil(0.024 / GetParam().period);
  for (double time = 0.0; time < age - 1e-9; time += GetParam().period) drives.random_tick();
  RobotState state = drives.state;
  state.base = old.base;
  state.base_v = old.base_v;
  state.base_w = old.base_w;
  state.base_age = age;
  drives.predictor.refresh(state);
  EXPECT_EQ(state.base_age, 0.0);
  EXPECT_LT(distance(state.base, drives.state.base), kEuler);
  EXPECT_NEAR(state.base.yaw, drives.state.base.yaw, kEuler);
  EXPECT_NEAR(state.base_v, drives.state.base_v, 1e-3);
  EXPECT_NEAR(state.base_w, drives.state.base_w, 2e-3);
}

INSTANTIATE_TEST_SUITE_P(Rates, LateLoops,
                         ::testing::Values(Loop{0.002, 0.0}, Loop{0.002, 0.02}, Loop{0.002, 0.1}, Loop{0.02, 0.0},
                                           Loop{0.02, 0.05}, Loop{0.02, 0.1}, Loop{0.02, 0.15}));

TEST(StatePredictor, LeavesARobotAloneThatAnswersAtOnce) {
  const DriveConfig exact{0.0, 0.0, 0.0};
  Drives drives({1e-9, 1e-9, 0.0}, 0.002, 0.0);
  for (int i = 0; i < 20; ++i) drives.random_tick();
  const StatePredictor predictor(exact, kJoints, 0.002, 0.0);
  const PredictedState seen = predictor.predict(drives.state);
  EXPECT_EQ(seen.q, drives.state.q);
  EXPECT_EQ(seen.base.x, drives.state.base.x);
  EXPECT_EQ(seen.base_end.yaw, drives.state.base.yaw);
  EXPECT_EQ(seen.base_lead, 0.0);
  EXPECT_EQ(seen.base_motion.share, 1.0);  // all of this tick's command shows in it
}

TEST(StatePredictor, SharesATickBetweenOldAndNewCommand) {
  // Half of the tick passes before the base answers, without lag: half of the new command shows.
  StatePredictor predictor({0.0, 0.0, 0.01}, kJoints, 0.02, 0.0);
  Command command;
  command.dq = JointVector::Zero(kJoints);
  command.base_v = 0.2;
  predictor.sent(command);
  RobotState state;
  state.q = state.dq = JointVector::Zero(kJoints);
  state.base_v = 0.2;
  const PredictedState seen = predictor.predict(state);
  EXPECT_NEAR(seen.base_motion.share, 0.5, 1e-9);
  EXPECT_NEAR(seen.base_motion.twist.v, 0.2, 1e-9);
}

TEST(StatePredictor, BoundsTheAgeOfOdometry) {
  Drives drives({}, 0.002, 0.0);
  for (int i = 0; i < 200; ++i) drives.random_tick();
  RobotState state = drives.state;
  state.base_age = 1e9;
  RobotState oldest = drives.state;
  oldest.base_age = 0.1;
  drives.predictor.refresh(state);
  drives.predictor.refresh(oldest);
  EXPECT_EQ(state.base.x, oldest.base.x);
}

TEST(StatePredictor, RefusesDelaysThatCannotBe) {
  EXPECT_THROW(StatePredictor({-0.1, 0.1, 0.0}, kJoints, 0.002, 0.0), ConfigError);
  EXPECT_THROW(StatePredictor({}, kJoints, 0.0, 0.0), ConfigError);
  EXPECT_THROW(StatePredictor({}, kJoints, 0.002, std::nan("")), ConfigError);
}

}  // namespace
}  // namespace ajar
