#include <algorithm>
#include <cmath>
#include <string>

#include "ajar/core/error.hpp"
#include "ajar/interaction/force_law.hpp"

namespace ajar {
namespace {

// The hand waits for the base: full speed up to 12 cm of lag, a fifth from 22 cm (the reach left beside the posture).
constexpr double kLagStop = 0.24;
constexpr double kLagRange = 0.12;
constexpr double kLagLeast = 0.2;
// Speed falls over the last 10 N of pull before the limit, and over the last 15 N of normal force down to a tenth:
// the force law needs some motion to learn from.
constexpr double kPullRange = 10.0;
// A small force cap keeps at least this share of itself for full speed and for the give.
constexpr double kCapShare = 0.4;
constexpr double kNormalRange = 15.0;
constexpr double kNormalLeast = 0.1;
// The running force counts once the hand has really moved: 2 cm, at half the wanted speed, 0.1 s mean.
constexpr double kMovedTravel = 0.02;
constexpr double kMovingShare = 0.5;
constexpr double kSpeedFilter = 0.1;
constexpr double kForceFilter = 1.0;
// A stop raises the force by 2 N a millisecond; the hand answers to what it will be when the joints have begun to brake.
// The filter leaves half a newton of the sensor's noise.
constexpr double kForesight = 0.010;   // [s]
constexpr double kRateFilter = 0.005;  // [s]
// Slopes of speed over force on a spring 1.8 times stiffer than believed swing from 1.9 times the gain of the loop on.
constexpr double kSlopes = 1.5;
// Measured speed below which nothing moves (encoder noise) [m/s].
constexpr double kStandingSpeed = 0.004;

double pull_range(double limit) { return std::min(kPullRange, kCapShare * limit); }

bool is_finite(const SpeedInput& input) {
  return std::isfinite(input.confidence) && std::isfinite(input.base_lag) && std::isfinite(input.pull_force) &&
         std::isfinite(input.normal_force) && std::isfinite(input.measured_speed) && std::isfinite(input.speed_cap) &&
         std::isfinite(input.force_cap);
}

}  // namespace

double waiting_share(double lag) noexcept { return std::clamp((kLagStop - lag) / kLagRange, kLagLeast, 1.0); }

double wanted_speed(const SpeedInput& input, const ForceLawConfig& config, double least_range) noexcept {
  const double confidence = std::clamp(input.confidence, 0.0, 1.0);
  double speed = config.speed_start + (config.speed - config.speed_start) * confidence * waiting_share(input.base_lag);
  speed = std::min(speed, std::max(input.speed_cap, 0.0));
  const double limit = std::min(config.force_limit, std::max(input.force_cap, 1.0));
  const double range = std::max(pull_range(limit), least_range);
  speed *= std::clamp((limit - std::abs(input.pull_force)) / range, 0.0, 1.0);
  speed *= std::clamp((config.force_limit - input.normal_force) / kNormalRange, kNormalLeast, 1.0);
  return speed;
}

SpeedLaw::SpeedLaw(const ForceLawConfig& config, double period, double dead_time) : config_(config), period_(period) {
  config.validate();
  if (!(period >= 1e-6 && period <= 0.1)) {
    throw ConfigError("interaction.period = " + std::to_string(period) + " s: must be in [1e-6, 0.1]");
  }
  const double delay = period + dead_time;
  config_.give_gain = loop_gain(config.give_gain, config.stability_number, config.total_stiffness, delay);
  // By how much the start speed falls with the force is a gain of the loop as well.
  least_range_ = config.speed_start * config.total_stiffness * delay / config.stability_number;
}

void SpeedLaw::reset() noexcept {
  speed_ = 0.0;
  running_force_ = 0.0;
  filtered_speed_ = 0.0;
  travel_ = 0.0;
  last_force_ = 0.0;
  force_rate_ = 0.0;
  moved_ = false;
}

double SpeedLaw::step(const SpeedInput& input) noexcept {
  if (!is_finite(input)) {
    speed_ = std::max(0.0, speed_ - config_.deceleration * period_);
    return speed_;
  }
  filtered_speed_ += std::min(1.0, period_ / kSpeedFilter) * (input.measured_speed - filtered_speed_);
  if (std::abs(input.measured_speed) > kStandingSpeed) {
    travel_ += std::abs(input.measured_speed) * period_;
  }
  if (travel_ > kMovedTravel && filtered_speed_ > kMovingShare * std::max(speed_, config_.speed_start)) {
    // The blow of a stop, met before the hand has come to rest, is not what the motion needs: it counts as the give's
    // margin.
    const double force = moved_ ? std::min(input.pull_force, running_force_ + config_.give_margin) : input.pull_force;
    running_force_ += (moved_ ? std::min(1.0, period_ / kForceFilter) : 1.0) * (force - running_force_);
    moved_ = true;
  }
  speed_ += std::clamp(wanted_speed(input, config_, least_range_) - speed_, -config_.deceleration * period_,
                       config_.acceleration * period_);
  // Tangential give: an end stop or a seal is met with a backing hand before the slower speed law answers.
  const double limit = std::min(config_.force_limit, std::max(input.force_cap, 1.0));
  double reserve = std::min(config_.give_reserve, 0.5 * kCapShare * limit);
  // Before it moves the hand stands on a spring, and the slope of the give adds to that of the speed.
  const double slopes = config_.speed_start / std::max(pull_range(limit), least_range_) + config_.give_gain;
  if (!moved_ && slopes > kSlopes * config_.speed_start / least_range_) reserve = 0.0;
  double give_from = limit - reserve;
  if (moved_) {
    give_from = std::min(give_from, running_force_ + config_.give_margin);
  }
  force_rate_ += std::min(1.0, period_ / kRateFilter) * ((input.pull_force - last_force_) / period_ - force_rate_);
  last_force_ = input.pull_force;
  const double soon = input.pull_force + kForesight * std::max(0.0, force_rate_);
  if (soon <= give_from) {
    return speed_;
  }
  return std::max(speed_ - config_.give_gain * (soon - give_from), -config_.give_speed);
}

}  // namespace ajar
