#include "ajar/mission/follower.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>

#include "ajar/core/config_range.hpp"
#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

// Longest drive to the parking pose, as in a mission [s].
constexpr double kApproachTime = 90.0;
// Pose feedback is bounded, so that a hand that was left behind does not rush: half the speed of a mission's hand.
constexpr double kCorrectionSpeed = 0.05;  // [m/s]
constexpr double kCorrectionTurn = 0.2;    // [rad/s]
// Weak turn of a hand that is free about the axis, back to how it took hold; as in a mission [1/s].
constexpr double kFreeTurn = 0.3;

bool is_finite(const RobotState& s) {
  return s.q.allFinite() && s.dq.allFinite() && std::isfinite(s.base.x) && std::isfinite(s.base.y) &&
         std::isfinite(s.base.yaw) && std::isfinite(s.base_v) && std::isfinite(s.base_w) && std::isfinite(s.base_age) &&
         std::isfinite(s.time);
}

Vector3d bounded(const Vector3d& v, double limit) {
  const double norm = v.norm();
  return norm > limit ? Vector3d(v * (limit / norm)) : v;
}

}  // namespace

void FollowConfig::validate() const {
  const double x = std::max(start.cwiseAbs().maxCoeff(), parking.cwiseAbs().maxCoeff());
  check_ranges("follow", {{"start_m, parking_m (largest coordinate)", x, 0.0, 100.0},
                          {"start_yaw", start_yaw, -10.0, 10.0},
                          {"parking_yaw", parking_yaw, -10.0, 10.0},
                          {"speed", speed, 1e-3, 1.0},
                          {"feedback", feedback, 0.0, 20.0}});
}

// p(s) = p0 + R0 (s x sinc + ...), R(s) = R0 Exp(s k). (docs/equations.md#follow)
Pose pose_on_path(const HandPath& path, const Pose& start, double arc) noexcept {
  const double kappa = path.curvature.norm();
  const double angle = kappa * arc;
  Vector3d way = arc * path.direction;
  if (std::abs(angle) > 1e-6) {  // below that the arc and its chord differ by less than angle²/6 of it
    way = std::sin(angle) / kappa * path.direction +
          (1.0 - std::cos(angle)) / (kappa * kappa) * path.curvature.cross(path.direction);
  }
  Pose out = start;
  out.translation() += start.linear() * way;
  out.linear() = start.linear() * exp_so3(arc * path.curvature);
  return out;
}

struct Follower::Impl {
  Impl(const RobotModel& robot, const MissionConfig& settings, const HandPath& told)
      : model(robot),
        config(settings),
        path(told),
        navigator(settings.navigation, settings.period),
        qp(model, settings.wbc, settings.period),
        base_law(settings.base_law),
        predictor(settings.drives, model.joints(), settings.period, settings.dead_time),
        clearance(model, settings.clearance) {
    if (config.controller == "thesis") thesis.emplace(model, config.thesis, config.wbc, config.period);
    command.dq = JointVector::Zero(model.joints());
    record.phase = Phase::Approach;
    record.solution.u = InputVector::Zero(model.inputs());
    record.kinematics.J.setZero(6, model.inputs());
    record.kinematics.distance_jacobian.setZero(model.inputs());
  }

  void stop(EndReason reason) noexcept {
    why = reason;
    ended_in = phase;
    phase = reason == EndReason::GoalReached ? Phase::Done : Phase::Stopped;
    command.dq.setZero(model.joints());
    command.base_v = command.base_w = 0.0;
  }
  void approach(const RobotState& state) noexcept;
  void begin(const RobotState& state) noexcept;
  void follow(const RobotState& state) noexcept;
  [[nodiscard]] WbcProblem problem() noexcept;
  [[nodiscard]] BaseLawOutput drive(const WbcProblem& task) noexcept;

  RobotModel model;
  MissionConfig config;
  HandPath path;
  Navigator navigator;
  WholeBodyController qp;
  std::optional<ThesisController> thesis;
  BaseLaw base_law;
  StatePredictor predictor;
  PredictedState ahead;
  Kinematics kinematics;
  ClearanceChecker clearance;

  Phase phase = Phase::Approach;
  Phase ended_in = Phase::Approach;
  EndReason why = EndReason::Running;
  bool interrupted = false;
  bool targeted = false;
  Pose start = Pose::Identity();  // hand at the beginning of the path
  double arc = 0.0;
  double heading = 0.0;  // of the path on the floor, held where it has none
  ClearanceResult clearances;
  Command command;
  MissionRecord record;
};

void Follower::Impl::approach(const RobotState& state) noexcept {
  const FollowConfig& follow = config.follow;
  if (!targeted) navigator.set_target(state.base, {follow.parking.x(), follow.parking.y(), follow.parking_yaw});
  targeted = true;
  const BaseTwist twist = navigator.step(state.base);
  command.dq.setZero(model.joints());
  command.base_v = twist.v;
  command.base_w = twist.w;
  if (navigator.arrived()) {
    begin(state);
  } else if (state.time > kApproachTime) {
    stop(EndReason::ApproachBlocked);
  }
}

void Follower::Impl::begin(const RobotState& state) noexcept {
  phase = Phase::Open;
  start = record.kinematics.X_WE;
  arc = 0.0;
  qp.reset();
  if (thesis) thesis->reset();
  base_law.reset(state.base, start.translation());
  follow(state);
}

// V = s (x, k) on the path with feedback of the pose, or the same twist in the axes of the hand as it is.
WbcProblem Follower::Impl::problem() noexcept {
  const Pose& hand = kinematics.X_WE;
  const bool closed = config.follow.feedback > 0.0;
  const Pose wanted = closed ? pose_on_path(path, start, arc) : hand;
  const double speed = config.follow.speed;
  WbcProblem out;
  out.kinematics = &kinematics;
  out.q = &ahead.q;
  out.base_motion = ahead.base_motion;
  out.tangential << speed * (wanted.linear() * path.direction), speed * (wanted.linear() * path.curvature);
  if (closed) {
    const double gain = config.follow.feedback;
    out.correction << bounded(gain * (wanted.translation() - hand.translation()), kCorrectionSpeed),
        bounded(gain * log_so3(wanted.linear() * hand.linear().transpose()), kCorrectionTurn);
  }
  if (config.follow.free_about_axis && path.curvature.norm() > 0.0) {
    out.free_axis = start.linear() * path.curvature.normalized();
    out.free_axis_rate = -kFreeTurn * log_so3(hand.linear() * start.linear().transpose()).dot(out.free_axis);
  }
  return out;
}

// The base answers later than the arm: its law sees the hand where it will be by then.
BaseLawOutput Follower::Impl::drive(const WbcProblem& task) noexcept {
  const double speed = config.follow.speed;
  Pose hand = Pose::Identity();
  hand.translation() = kinematics.X_WE.translation();
  const HandPath tangent{task.tangential.head<3>() / speed, task.tangential.tail<3>() / speed, 0.0};
  const Pose then = pose_on_path(tangent, hand, speed * record.solution.speed_factor * ahead.base_lead);
  return base_law.step({.dt = config.period,
                        .base = ahead.base_end,
                        .hand = then.translation(),
                        .direction = then.linear() * tangent.direction,
                        .curvature = tangent.curvature,
                        .wanted_speed = speed,
                        .measured_speed = speed * record.solution.speed_factor,
                        .confidence = 1.0});
}

void Follower::Impl::follow(const RobotState& state) noexcept {
  ahead = predictor.predict(state);
  if (thesis) {  // it acts on what is measured
    ahead.base = state.base;
    ahead.q = state.q;
  }
  model.compute(ahead.base, ahead.q, kinematics);
  WbcProblem task = problem();
  const double speed = config.follow.speed;
  const HeadingReference planar = heading_reference(task.tangential);
  if (planar.valid) heading = planar.heading;
  if (thesis) {
    (void)thesis->solve(task, record.solution);  // the status travels in the solution
    record.base.lag = std::abs(record.kinematics.distance - config.thesis.distance);
  } else {
    record.base = drive(task);
    task.base = record.base.twist;
    clearance.compute(model, ahead.base, clearances);
    task.clearance = &clearances;
    task.clearance_config = config.clearance;
    (void)qp.solve(task, record.solution);
    record.clearance_min = *std::min_element(clearances.smallest.begin(), clearances.smallest.end());
  }
  record.base.heading_error = wrap_half_turn(state.base.yaw - heading);
  record.reference = task.tangential + task.correction;
  record.wanted_speed = speed;
  const int n = model.joints();
  command.dq = record.solution.u.head(n);
  command.base_w = record.solution.u[n];
  command.base_v = record.solution.u[n + 1];
  // Without feedback nobody knows where the hand is on the path: time alone ends the motion.
  arc += config.period * speed * (config.follow.feedback > 0.0 ? record.solution.speed_factor : 1.0);
  if (arc >= path.length) stop(EndReason::GoalReached);
}

Follower::Follower(const RobotModel& model, const MissionConfig& config, const HandPath& path) {
  config.validate();
  impl_ = std::make_unique<Impl>(model, config, path);
}

Follower::~Follower() = default;

Command Follower::step(const RobotState& measured) noexcept {
  Impl& m = *impl_;
  RobotState state = measured;
  if (finished()) return m.command;
  m.record.solution.status = WbcStatus::Ok;
  m.record.solution.binding = BindingLimit::None;
  m.record.reference.setZero();
  if (m.interrupted) {
    m.stop(EndReason::Interrupted);
  } else if (state.q.size() != m.model.joints() || state.dq.size() != m.model.joints() || !is_finite(state)) {
    m.stop(EndReason::SensorInvalid);
  } else if (state.time > m.config.limits.time) {
    m.stop(EndReason::TimeLimit);
  } else {
    m.predictor.refresh(state);
    m.model.compute(state.base, state.q, m.record.kinematics);
    m.record.solution.sigma_min = arm_sigma_min(m.record.kinematics);
    if (m.phase == Phase::Approach) {
      m.approach(state);
    } else {
      m.follow(state);
    }
  }
  m.predictor.sent(m.command);
  m.record.phase = m.phase;
  m.record.reason = m.why;
  return m.command;
}

void Follower::interrupt() noexcept { impl_->interrupted = true; }
bool Follower::finished() const noexcept { return impl_->phase == Phase::Done || impl_->phase == Phase::Stopped; }
bool Follower::reached_goal() const noexcept { return impl_->why == EndReason::GoalReached; }
Phase Follower::phase() const noexcept { return impl_->phase; }
Phase Follower::end_phase() const noexcept { return impl_->ended_in; }
EndReason Follower::reason() const noexcept { return impl_->why; }
const MissionRecord& Follower::record() const noexcept { return impl_->record; }

std::string Follower::explain() const {
  switch (impl_->why) {
    case EndReason::GoalReached: return fmt::format("the path of {:.2f} m was commanded to its end", impl_->path.length);
    case EndReason::ApproachBlocked: return "the base did not arrive at its parking pose";
    case EndReason::SensorInvalid: return "a measurement was not a number";
    case EndReason::TimeLimit: return fmt::format("the time limit of {:.0f} s is over", impl_->config.limits.time);
    case EndReason::Interrupted: return "stopped by the operator";
    default: return "under way";
  }
}

}  // namespace ajar
