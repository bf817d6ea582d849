#include "ajar/mission/end_detector.hpp"

#include <algorithm>

namespace ajar {
namespace {

constexpr double kSpeedFilter = 0.1;   // low-pass of the measured speed [s]
constexpr double kDriftFilter = 1.0;   // the same of the slow parts: a hand that swings on a stop gets nowhere [s]
constexpr double kPullingShare = 0.6;  // of the allowed force; the speed law fades out over the rest
constexpr double kWantsOn = 0.5;       // speed factor above which the hand does as the speed law wants
constexpr double kLargestDoubt = 0.1;  // an angle less certain than this does not delay the goal further [rad]

}  // namespace

EndDetector::EndDetector(const EndConfig& config, const GoalConfig& goal, double force_limit)
    : config_(config), goal_(goal), force_limit_(force_limit) {}

void EndDetector::reset() noexcept { speed_ = drift_ = force_ = still_ = stuck_ = held_ = pressed_ = leaning_ = 0.0; }

void EndDetector::watch(const EndInput& in) noexcept {
  speed_ += std::min(1.0, in.dt / kSpeedFilter) * (in.speed - speed_);
  drift_ += std::min(1.0, in.dt / kDriftFilter) * (in.speed - drift_);
  force_ += std::min(1.0, in.dt / kDriftFilter) * (in.pull_force - force_);
  still_ = speed_ < config_.still_speed ? still_ + in.dt : 0.0;
  // Creeping by jerks is standing: what counts is what the slow mean gains.
  stuck_ = drift_ < config_.still_speed ? stuck_ + in.dt : 0.0;
  const bool fenced = in.speed_factor < kWantsOn && in.binding == BindingLimit::Clearance;
  held_ = stuck_ > 0.0 ? held_ + (fenced ? in.dt : 0.0) : 0.0;
  // A stop is met by a hand that wants on: a hand that the controller holds back must lean on it for longer, or the jerk
  // of being held back would count; so must one that swings on the spring of its grasp.
  const double risen_force = in.running_force + config_.stop_force;
  leaning_ = force_ > risen_force && drift_ < config_.still_speed ? leaning_ + in.dt : 0.0;
  // Where force and give balance, next to nothing is wanted and its share says nothing.
  const bool wants_on = in.speed_factor > kWantsOn || std::abs(in.wanted_speed) < config_.still_speed;
  pressed_ = in.pull_force > risen_force && still_ > 0.0 && wants_on ? pressed_ + in.dt : 0.0;
}

EndDetector::Verdict EndDetector::step(const EndInput& in, const MechanismEstimate& estimate) noexcept {
  watch(in);
  const double arc = estimate.arc;

  if (!goal_.to_the_stop) {
    // A grip that pivots knows the angle only from curvature times arc: be sure to two sigma.
    const double doubt = std::min(kLargestDoubt, 2.0 * estimate.angle_sigma);
    if (estimate.type == MechanismType::Hinge && estimate.angle > goal_.opening_angle + config_.goal_margin + doubt) {
      return Verdict::Goal;
    }
    if (estimate.type == MechanismType::Slide && arc > goal_.opening_length) return Verdict::Goal;
  }
  const bool at_limit = in.pull_force > force_limit_ - config_.reserve;
  const bool too_heavy = in.running_force + config_.stop_force > force_limit_ - config_.reserve;
  if (arc > config_.stop_arc && !too_heavy && leaning_ > config_.leaning_time) return Verdict::Stop;
  if (arc > config_.stop_arc && still_ > config_.stop_time) {
    if (!too_heavy && pressed_ > config_.stop_time) return Verdict::Stop;
    if (too_heavy && at_limit && still_ > config_.blocked_time) return Verdict::TooHeavy;
  }
  const bool pulls = in.pull_force > kPullingShare * std::min(in.force_cap, force_limit_);
  if (arc < config_.blocked_arc && still_ > (pulls ? config_.blocked_pull_time : config_.blocked_time))
    return Verdict::Blocked;
  if (stuck_ > config_.stalled_time) {
    if (held_ > 0.5 * config_.stalled_time) return Verdict::ClearanceStop;
    if (arc < config_.blocked_arc) return Verdict::Blocked;
    return at_limit ? Verdict::TooHeavy : Verdict::Stalled;
  }
  return Verdict::Going;
}

}  // namespace ajar
