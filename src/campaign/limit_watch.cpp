#include "limit_watch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace ajar {
namespace {

/// Round-off of a command that sits exactly on its limit.
constexpr double kRoundOff = 1e-6;
/// A servo that follows a command at the limit overshoots a little; more than this is a fault of the controller.
constexpr double kRateShare = 0.05;
constexpr double kRateMargin = 0.02;
/// Position beyond a joint limit that a servo's error explains [rad or m].
constexpr double kPositionMargin = 1e-3;

}  // namespace

bool LimitWatch::outside(const char* what, int index, double value, double limit) noexcept {
  if (!(std::abs(value) > limit)) return false;
  if (first_ == nullptr) {
    first_ = what;
    first_index_ = index;
    first_value_ = value;
    first_limit_ = limit;
    first_time_ = time_;
  }
  return true;
}

bool LimitWatch::command_outside(const Command& command) noexcept {
  const RobotLimits& limits = config_.limits;
  bool bad = false;
  const auto joints = std::min(command.dq.size(), limits.velocity.size());
  for (Eigen::Index i = 0; i < joints; ++i) {
    bad |= outside("commanded rate of joint", static_cast<int>(i) + 1, command.dq[i], limits.velocity[i] + kRoundOff);
  }
  const double forward = command.base_v >= 0.0 ? limits.base_forward : limits.base_reverse;
  bad |= outside("commanded base speed", 0, command.base_v, forward + kRoundOff);
  bad |= outside("commanded base turning rate", 0, command.base_w, limits.base_yaw_rate + kRoundOff);
  const double turn = 0.5 * config_.wheel_track * command.base_w;
  for (const double speed : {command.base_v - turn, command.base_v + turn}) {
    bad |= outside("commanded wheel speed", 0, speed / config_.wheel_radius,
                   limits.wheel_speed + kRoundOff / config_.wheel_radius);
  }
  return bad;
}

bool LimitWatch::truth_outside(const Truth& truth) noexcept {
  const RobotLimits& limits = config_.limits;
  bool bad = false;
  for (Eigen::Index i = 0; i < std::min(truth.q.size(), limits.position_upper.size()); ++i) {
    const double middle = 0.5 * (limits.position_upper[i] + limits.position_lower[i]);
    const double half = 0.5 * (limits.position_upper[i] - limits.position_lower[i]);
    bad |= outside("true position from the middle of the range of joint", static_cast<int>(i) + 1, truth.q[i] - middle,
                   half + kPositionMargin);
  }
  for (Eigen::Index i = 0; i < std::min(truth.dq.size(), limits.velocity.size()); ++i) {
    bad |= outside("true rate of joint", static_cast<int>(i) + 1, truth.dq[i],
                   (1.0 + kRateShare) * limits.velocity[i] + kRateMargin);
  }
  return bad;
}

void LimitWatch::observe(const TickView& tick) noexcept {
  time_ = tick.state.time;
  const Command& command = tick.command;
  if (!command.dq.allFinite() || !std::isfinite(command.base_v) || !std::isfinite(command.base_w)) ++nonfinite_;
  const bool command_bad = command_outside(command);
  const bool truth_bad = truth_outside(tick.truth);
  if (command_bad || truth_bad) ++violations_;
}

std::string LimitWatch::first() const {
  if (first_ == nullptr) return "";
  const std::string index = first_index_ > 0 ? fmt::format(" {}", first_index_) : "";
  return fmt::format("{}{} {:.4g} beyond {:.4g} at {:.3f} s", first_, index, first_value_, first_limit_, first_time_);
}

}  // namespace ajar
