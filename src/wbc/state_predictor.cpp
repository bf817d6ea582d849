#include "ajar/wbc/state_predictor.hpp"

#include <algorithm>
#include <cmath>

#include "ajar/core/config_range.hpp"
#include "ajar/model/robot_model.hpp"

namespace ajar {
namespace {

// The base's way is put together from arcs of this length: at 1 rad/s each is off its true curve by v dt (ω dt)²/24, less
// than a micrometre.
constexpr double kArcTime = 0.01;  // [s]
// Odometry of 10 Hz is the slowest that counts; older readings are taken as that old.
constexpr double kOldestReading = 0.1;  // [s]
// Lags are divided by [s].
constexpr double kLeastLag = 1e-9;
// Round-off of a time in ticks.
constexpr double kTickRoundOff = 1e-6;

}  // namespace

void DriveConfig::validate() const {
  check_ranges("drives",
               {{"arm_lag", arm_lag, 0.0, 1.0}, {"base_lag", base_lag, 0.0, 2.0}, {"base_delay", base_delay, 0.0, 1.0}});
}

StatePredictor::StatePredictor(const DriveConfig& config, int joints, double period, double dead_time)
    : config_(config),
      period_(period),
      dead_time_(dead_time),
      keep_(std::exp(-period / std::max(config.base_lag, kLeastLag))) {
  config.validate();
  check_ranges("predictor", {{"period", period, 1e-4, 0.1}, {"dead_time", dead_time, 0.0, 1.0}});
  Command rest;
  rest.dq = JointVector::Zero(joints);
  const double longest = dead_time + config.base_delay + kOldestReading;
  commands_.assign(static_cast<std::size_t>(std::ceil(longest / period)) + 2, rest);
}

void StatePredictor::sent(const Command& command) noexcept {
  newest_ = newest_ == 0 ? commands_.size() - 1 : newest_ - 1;
  commands_[newest_] = command;
}

const Command& StatePredictor::sent_before(int ticks) const noexcept {
  const std::size_t back = std::min(static_cast<std::size_t>(std::max(ticks, 0)), commands_.size() - 1);
  const std::size_t place = newest_ + back;
  return commands_[place < commands_.size() ? place : place - commands_.size()];
}

// Piecewise constant commands through a first-order lag, exactly: v' = u + (v - u) e, way = u dt + (v - u) τ (1 - e).
// Times count from now; the newest command goes on. (docs/equations.md#late)
BaseTwist StatePredictor::roll(BaseState& base, double from, double to) const noexcept {
  const double transport = dead_time_ + config_.base_delay;
  BaseTwist whole;
  double way = 0.0;
  double turn = 0.0;
  double arc_time = 0.0;
  double time = from;
  // Commands before the one that acts, one fewer at the end of each.
  int ticks = static_cast<int>(std::ceil((transport - time) / period_ - kTickRoundOff)) - 1;
  for (; time < to; --ticks) {
    const Command& command = sent_before(ticks);
    const double end = ticks > 0 ? std::min(to, transport - ticks * period_) : to;
    const double dt = end - time;
    const double keep =
        std::abs(dt - period_) < kTickRoundOff * period_ ? keep_ : std::exp(-dt / std::max(config_.base_lag, kLeastLag));
    const double v = base.twist.v - command.base_v;
    const double w = base.twist.w - command.base_w;
    way += command.base_v * dt + v * config_.base_lag * (1.0 - keep);
    turn += command.base_w * dt + w * config_.base_lag * (1.0 - keep);
    base.twist = {command.base_v + v * keep, command.base_w + w * keep};
    arc_time += dt;
    time = end;
    if (arc_time >= kArcTime || time >= to) {
      base.pose = integrate_base(base.pose, way, turn, 1.0);
      whole = {whole.v + way, whole.w + turn};
      way = turn = arc_time = 0.0;
    }
  }
  return whole;
}

void StatePredictor::refresh(RobotState& state) const noexcept {
  const double age = std::clamp(state.base_age, 0.0, kOldestReading);
  if (!(age > 0.0)) return;
  BaseState base{state.base, {state.base_v, state.base_w}};
  (void)roll(base, -age, 0.0);
  state.base = base.pose;
  state.base_v = base.twist.v;
  state.base_w = base.twist.w;
  state.base_age = 0.0;
}

PredictedState StatePredictor::predict(const RobotState& state) const noexcept {
  PredictedState out;
  // A lag that is integrated is a delay: what it still owes is lag times rate.
  out.q = state.q + config_.arm_lag * state.dq;
  double left = dead_time_;
  for (int ticks = 0; left > kTickRoundOff * period_; ++ticks) {
    const double dt = std::min(left, period_);
    out.q += dt * sent_before(ticks).dq;
    left -= dt;
  }
  const double hand_time = dead_time_ + config_.arm_lag;
  const double base_time = dead_time_ + config_.base_delay;
  BaseState base{state.base, {state.base_v, state.base_w}};
  (void)roll(base, 0.0, hand_time);
  out.base = base.pose;
  BaseState next = base;
  const BaseTwist way = roll(next, hand_time, hand_time + period_);
  // What this tick's command adds from base_time on: the mean of 1 - exp(-t/τ).
  const double shown = std::clamp(hand_time + period_ - base_time, 0.0, period_);
  const double missing = config_.base_lag * (1.0 - std::exp(-shown / std::max(config_.base_lag, kLeastLag)));
  out.base_motion.twist = {way.v / period_, way.w / period_};
  out.base_motion.share = std::clamp((shown - missing) / period_, 0.0, 1.0);
  (void)roll(base, hand_time, base_time);
  out.base_end = integrate_base(base.pose, base.twist.v, base.twist.w, config_.base_lag);
  out.base_lead = std::max(0.0, config_.base_delay + config_.base_lag - config_.arm_lag);
  return out;
}

}  // namespace ajar
