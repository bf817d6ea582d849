#include "ajar/campaign/judge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ajar/core/so3.hpp"
#include "limit_watch.hpp"
#include "statistics.hpp"

namespace ajar {
namespace {

/// Forces are judged as a hand feels them: contact noise of single ticks is not a load.
constexpr double kForceWindow = 0.020;
/// Handle travel before the end stop in which forces belong to the stop and not to the guiding along the path.
constexpr double kStopZone = 0.004;
/// Arc after which the estimate has had what it needs; forces from here on are called late.
constexpr double kLateArc = 0.15;
/// Base speed above which the base counts as moving [m/s or rad/s].
constexpr double kBaseMoves = 0.01;
/// 85° of a wanted 90° count as opened, and 97 % of what an end stop allows.
constexpr double kHingeShare = 85.0 / 90.0;
constexpr double kStopShare = 0.97;

double angle_between(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

double goal_of(const JudgeConfig& config) {
  if (config.goal.to_the_stop) return config.travel;
  const double goal = config.kind == JointKind::Hinge ? config.goal.opening_angle : config.goal.opening_length;
  return std::min(goal, config.travel);
}

const char* type_name(MechanismType type) {
  switch (type) {
    case MechanismType::Hinge: return "hinge";
    case MechanismType::Slide: return "slide";
    case MechanismType::Unknown: break;
  }
  return "unknown";
}

}  // namespace

double opening_needed(const JudgeConfig& config) noexcept {
  if (config.kind == JointKind::Slide || config.goal.to_the_stop) return kStopShare * goal_of(config);
  return std::min(kHingeShare * config.goal.opening_angle, kStopShare * config.travel);
}

Matrix3d belief_alignment(const MissionRecord& record, const Truth& truth) noexcept {
  return truth.hand.linear() * record.kinematics.X_WE.linear().transpose();
}

struct Judge::Impl {
  JudgeConfig config;
  RunResult result;
  LimitWatch limits;
  Phase last_phase = Phase::Choose;
  std::vector<float> tick_us;

  // Phase Open.
  long open_ticks = 0;
  long probe_ticks = 0;
  std::optional<double> force_needed;  // while probing [N]
  MovingMean normal_force, pull_force, whole_force, torque;
  double normal_sum = 0.0, late_sum = 0.0, heading_squares = 0.0;
  long late_ticks = 0, heading_ticks = 0;
  bool base_moved = false;
  bool taken = false;  // the hand holds the handle as it was met
  double opening_at_start = 0.0;
  Vector3d offset_at_start = Vector3d::Zero();
  MechanismType type = MechanismType::Unknown;
  double last_opening = 0.0, last_radius = 1.0;

  explicit Impl(const JudgeConfig& c)
      : config(c), limits(c), normal_force(window(c)), pull_force(window(c)), whole_force(window(c)), torque(window(c)) {
    const double ticks = std::clamp(c.time_limit / c.period, 1.0, 1e7);
    tick_us.reserve(static_cast<std::size_t>(1.1 * ticks) + 1000);
  }

  static double direction_error(const TickView& tick) {
    return angle_between(belief_alignment(tick.record, tick.truth) * tick.record.estimate.direction, tick.truth.direction);
  }

  static int window(const JudgeConfig& c) { return std::max(1, static_cast<int>(std::lround(kForceWindow / c.period))); }

  void begin_phase(const TickView& tick) {
    if (last_phase == Phase::Probe && tick.record.phase == Phase::Open) {
      raise(result.probe_direction_error, direction_error(tick));
    }
    last_phase = tick.record.phase;
    for (MovingMean* mean : {&normal_force, &pull_force, &whole_force, &torque}) mean->clear();
    if (tick.record.phase == Phase::Grasp) taken = false;
    if (tick.record.phase != Phase::Open || taken) return;
    taken = true;
    opening_at_start = tick.truth.opening;
    offset_at_start = tick.truth.hand.translation() - tick.truth.handle;
  }

  void observe_estimate(const TickView& tick, double arc) {
    const MechanismEstimate& estimate = tick.record.estimate;
    const Vector3d curvature = belief_alignment(tick.record, tick.truth) * estimate.curvature;
    const double direction_error = Impl::direction_error(tick);
    const double curvature_error = (curvature - tick.truth.curvature).norm();
    // In the first tick of the phase the estimate is still that of the phase before.
    if (open_ticks > 1 && !result.direction_error_start) result.direction_error_start = direction_error;
    if (arc >= 0.10 && !result.direction_error_10cm) result.direction_error_10cm = direction_error;
    if (arc >= 0.20 && !result.direction_error_20cm) result.direction_error_20cm = direction_error;
    if (arc >= 0.20 && !result.curvature_error_20cm) result.curvature_error_20cm = curvature_error;
    if (arc >= 0.40 && !result.curvature_error_40cm) result.curvature_error_40cm = curvature_error;
    result.direction_error_final = direction_error;
    result.curvature_error_final = curvature_error;
    result.direction_sigma_final = estimate.direction_sigma;
    result.curvature_sigma_final = estimate.curvature_sigma;
    type = estimate.type;
  }

  void observe_forces(const Truth& truth, double arc, bool at_stop) {
    const double pull = truth.direction.dot(truth.force);
    const double normal = (truth.force - pull * truth.direction).norm();
    normal_sum += normal;
    if (arc > kLateArc && !at_stop) {
      late_sum += normal;
      ++late_ticks;
    }
    const bool full = normal_force.push(normal);
    pull_force.push(pull);
    whole_force.push(truth.force.norm());
    torque.push(truth.torque.norm());
    if (!full) return;
    raise(result.peak_normal_force, normal_force.mean());
    raise(result.peak_torque, torque.mean());
    if (at_stop) {
      raise(result.stop_force, whole_force.mean());
      return;
    }
    raise(result.peak_normal_force_free, normal_force.mean());
    raise(result.peak_pull_force, pull_force.mean());
    if (arc > kLateArc) raise(result.late_normal_force_peak, normal_force.mean());
  }

  void observe_path(const Truth& truth) {
    const double k = truth.curvature.norm();
    const Vector3d turn = k > 1e-9 ? Vector3d(truth.curvature / k * (truth.opening - opening_at_start)) : Vector3d::Zero();
    const Vector3d offset = exp_so3(turn).transpose() * (truth.hand.translation() - truth.handle);
    raise(result.path_error_max, (offset - offset_at_start).norm());
  }

  void observe_base(const TickView& tick) {
    const double distance = tick.record.kinematics.distance;
    raise(result.distance_max, distance);
    lower(result.distance_min, distance);
    base_moved = base_moved || std::abs(tick.state.base_v) > kBaseMoves || std::abs(tick.state.base_w) > kBaseMoves;
    if (!base_moved) return;
    const double error = tick.record.base.heading_error;
    raise(result.heading_error_max, std::abs(error));
    heading_squares += error * error;
    ++heading_ticks;
  }

  void observe_open(const TickView& tick) {
    const double k = tick.truth.curvature.norm();
    last_radius = config.kind == JointKind::Hinge && k > 1e-9 ? 1.0 / k : 1.0;
    last_opening = tick.truth.opening;
    const double arc = last_opening * last_radius;
    const bool at_stop = arc > config.travel * last_radius - kStopZone;
    ++open_ticks;
    observe_estimate(tick, arc);
    observe_forces(tick.truth, arc, at_stop);
    observe_path(tick.truth);
    observe_base(tick);
    if (tick.record.solution.sigma_min > 0.0) lower(result.min_singular_value, tick.record.solution.sigma_min);
    // A record that has not been filled yet holds zero; a true zero has a close neighbour in the next tick.
    if (std::isfinite(tick.record.clearance_min) && tick.record.clearance_min != 0.0) {
      lower(result.min_clearance, tick.record.clearance_min);
    }
  }

  void observe_probe(const Truth& truth) {
    ++probe_ticks;
    if (whole_force.push(truth.force.norm())) raise(result.peak_probe_force, whole_force.mean());
    // Within the play of the closed end it rests there: its friction must first be broken.
    const double k = truth.curvature.norm();
    const bool closed = truth.opening < kStopZone * (config.kind == JointKind::Hinge ? k : 1.0);
    if (config.force_needed) raise(force_needed, config.force_needed(closed ? 0.0 : truth.opening));
  }

  void observe(const TickView& tick) {
    if (tick.record.phase != last_phase) begin_phase(tick);
    if (tick.record.phase == Phase::Open) observe_open(tick);
    if (tick.record.phase == Phase::Probe) observe_probe(tick.truth);
    // A robot that looks again before it goes on may find open what it had let go half open.
    const bool looks = tick.record.phase == Phase::Choose || tick.record.phase == Phase::Reach;
    if (open_ticks == 0 || looks) last_opening = tick.truth.opening;
    if (open_ticks > 0 && config.kind == JointKind::Hinge && tick.record.estimate.type == MechanismType::Hinge)
      result.angle_error_final = std::abs(tick.record.estimate.angle - tick.truth.opening);
    limits.observe(tick);
    const BasePose& odometry = tick.state.base;
    const BasePose& base = tick.truth.base;
    result.odometry_error_final = std::hypot(odometry.x - base.x, odometry.y - base.y);
    result.odometry_yaw_error_final = std::abs(wrap_angle(odometry.yaw - base.yaw));
    if (tick_us.size() < tick_us.capacity()) tick_us.push_back(static_cast<float>(tick.tick_us));
  }
};

Judge::Judge(const JudgeConfig& config) : impl_(std::make_unique<Impl>(config)) {}
Judge::~Judge() = default;

void Judge::observe(const TickView& tick) noexcept { impl_->observe(tick); }

RunResult Judge::finish(const RunEnd& end) const {
  const JudgeConfig& config = impl_->config;
  RunResult result = impl_->result;
  result.mechanism_type_true = config.kind == JointKind::Hinge ? "hinge" : "slide";
  result.mechanism_type_estimated = type_name(impl_->type);
  result.opening = impl_->last_opening;
  const double goal = goal_of(config);
  if (goal > 0.0) result.opening_fraction = impl_->last_opening / goal;
  result.duration = end.duration;
  if (impl_->open_ticks > 0) {
    const auto ticks = static_cast<double>(impl_->open_ticks);
    result.open_duration = ticks * config.period;
    result.handle_travel = impl_->last_opening * impl_->last_radius;
    result.mean_normal_force = impl_->normal_sum / ticks;
  }
  const std::optional<double>& needed = impl_->force_needed;
  if (result.peak_probe_force && needed) result.probe_force_over_need = *result.peak_probe_force - *needed;
  if (impl_->probe_ticks > 0) result.probe_duration = static_cast<double>(impl_->probe_ticks) * config.period;
  if (impl_->late_ticks > 0) result.late_normal_force = impl_->late_sum / static_cast<double>(impl_->late_ticks);
  if (impl_->heading_ticks > 0) {
    result.heading_error_rms = std::sqrt(impl_->heading_squares / static_cast<double>(impl_->heading_ticks));
  }
  result.unwanted_contacts = end.contacts;
  result.limit_violations = impl_->limits.violations();
  result.limit_violation_first = impl_->limits.first();
  result.nonfinite_commands = impl_->limits.nonfinite_commands();
  result.phase = to_string(end.phase);
  result.reason = to_string(end.reason);
  result.explanation = end.explanation;
  if (end.claimed && impl_->last_opening >= opening_needed(config)) {
    result.outcome = "opened";
  } else if (end.claimed) {
    result.reason = "claimed_but_not_open";
  }
  result.tick_us = tick_times(impl_->tick_us);
  const double period_us = config.period * 1e6;
  result.missed_ticks = std::count_if(impl_->tick_us.begin(), impl_->tick_us.end(),
                                      [&](float t) { return static_cast<double>(t) > period_us; });
  if (end.wall_seconds > 0.0) result.real_time_factor = end.duration / end.wall_seconds;
  return result;
}

}  // namespace ajar
