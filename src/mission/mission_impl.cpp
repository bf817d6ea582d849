#include "mission_impl.hpp"

#include <algorithm>
#include <cmath>
#include <exception>

#include <fmt/format.h>

#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

constexpr double kBlockedTime = 1.2;      // two base lags and delays of a slow base, with reserve [s]
constexpr double kBlockedCommand = 0.03;  // below this stiction may hold the base: docking minimum of the drive [m/s]
constexpr double kBlockedTurn = 0.06;     // [rad/s]
constexpr double kBlockedShare = 0.1;     // measured over commanded

// Lag of the joint servos [s].
constexpr double kServoTime = 0.01;

ProbeConfig steady_probing(const MissionConfig& config) {
  ProbeConfig probe;
  probe.loop_delay = config.period + config.dead_time + kServoTime;
  return probe;
}

// The pull may use what the mission allows; the force law's own key is its default.
MissionConfig with_one_force_limit(MissionConfig config) {
  config.force.force_limit = config.limits.force;
  return config;
}

bool finite(const RobotState& s) {
  return s.q.allFinite() && s.dq.allFinite() && s.sensor_force.allFinite() && s.sensor_torque.allFinite() &&
         std::isfinite(s.base_age) && std::isfinite(s.base.x) && std::isfinite(s.base.y) && std::isfinite(s.base.yaw) &&
         std::isfinite(s.base_v) && std::isfinite(s.base_w) && std::isfinite(s.time) && std::isfinite(s.gripper_opening);
}

}  // namespace

void SightAverage::reset() noexcept { *this = SightAverage(); }

void SightAverage::add(const HandleSight& sight, const BasePose& base) noexcept {
  if (!sight.visible || !sight.position.allFinite() || !sight.normal.allFinite() || !sight.bar.allFinite()) return;
  const Pose X_WB = to_pose(base);
  const double share = 1.0 / ++count_;
  position_ += share * (X_WB * sight.position - position_);
  normal_ += share * (X_WB.linear() * sight.normal - normal_);
  bar_ += share * (X_WB.linear() * sight.bar - bar_);
  if (sight.doorway) {
    left_edge_ += share * (X_WB * sight.doorway->left - left_edge_);
    right_edge_ += share * (X_WB * sight.doorway->right - right_edge_);
  }
  framed_ = sight.doorway.has_value();
  standoff_ = sight.standoff;
  thickness_ = sight.thickness;
}

HandleBelief SightAverage::belief() const noexcept {
  HandleBelief belief;
  belief.position = position_;
  belief.normal = normal_.norm() > 1e-6 ? Vector3d(normal_.normalized()) : Vector3d(-Vector3d::UnitY());
  belief.bar = bar_.norm() > 0.5 ? Vector3d(bar_.normalized()) : Vector3d(Vector3d::Zero());
  belief.standoff = standoff_;
  belief.thickness = thickness_;
  if (framed_) belief.doorway = Doorway{left_edge_, right_edge_};
  return belief;
}

Mission::Impl::Impl(const RobotModel& robot, const MissionConfig& settings, std::optional<Vector3d> direction_guess,
                    std::uint64_t run_seed)
    : model(robot),
      config(with_one_force_limit(settings)),
      guess(direction_guess),
      seed(run_seed),
      footprint(base_footprint(model)),
      navigator(settings.navigation, settings.period),
      planner(model, settings.planner, settings.wbc, settings.base_law, settings.clearance),
      controller(model, settings.wbc, settings.period),
      clearance(model, settings.clearance),
      predictor(settings.drives, model.joints(), settings.period, settings.dead_time),
      wrench(model),
      opener(model, config),
      prober(steady_probing(settings)),
      joint_move(0.8, 2.0) {
  command.dq = JointVector::Zero(model.joints());
  record.solution.u = InputVector::Zero(model.inputs());
  record.kinematics.J.setZero(6, model.inputs());
  record.kinematics.distance_jacobian.setZero(model.inputs());
}

BasePose Mission::Impl::localise(const BasePose& odometry) const noexcept {
  const double c = std::cos(odometry_origin.yaw);
  const double s = std::sin(odometry_origin.yaw);
  return {odometry_origin.x + c * odometry.x - s * odometry.y, odometry_origin.y + s * odometry.x + c * odometry.y,
          wrap_angle(odometry_origin.yaw + odometry.yaw)};
}

// The handle stands still: what moved between two sights is the odometry. (docs/equations.md#landmark)
void Mission::Impl::correct_odometry(const HandleBelief& seen_again) noexcept {
  // The face of a flap that hangs open looks down: its bar tells the heading.
  const auto heading = [&](const HandleBelief& belief) {
    const Vector3d& v = flap ? belief.bar : belief.normal;
    return std::atan2(v.y(), v.x());
  };
  const double turn = wrap_angle(heading(landmark) - heading(seen_again));
  const double c = std::cos(turn);
  const double s = std::sin(turn);
  const Vector3d& p = seen_again.position;
  const BasePose& o = odometry_origin;
  odometry_origin = {c * o.x - s * o.y + landmark.position.x() - (c * p.x() - s * p.y()),
                     s * o.x + c * o.y + landmark.position.y() - (s * p.x() + c * p.y()), wrap_angle(o.yaw + turn)};
}

Command Mission::Impl::step(const RobotState& measured) noexcept {
  RobotState state = measured;
  state.base = localise(measured.base);
  if (phase == Phase::Done || phase == Phase::Stopped) {
    command_zero();
    return command;
  }
  record.solution.status = WbcStatus::Ok;
  record.solution.speed_factor = 0.0;
  record.solution.binding = BindingLimit::None;
  record.reference.setZero();
  record.wanted_speed = 0.0;
  if (!unhealthy(state)) {
    predictor.refresh(state);
    model.compute(state.base, state.q, record.kinematics);
    record.wrench = wrench.hand_wrench(state, record.kinematics);
    if (phase != Phase::Open) {  // there the controller says it
      record.solution.sigma_min = arm_sigma_min(record.kinematics, config.wbc.length, sigma_track);
    }
    if (!too_much(state) && !base_blocked(state)) {
      time_in_phase += config.period;
      ahead.robot = predictor.predict(state);
      model.compute(ahead.robot.base, ahead.robot.q, ahead.kinematics);
      try {
        switch (phase) {
          case Phase::Choose: choose(state); break;
          case Phase::Approach: approach(state); break;
          case Phase::Reach: reach(state); break;
          case Phase::Zero: zero(state); break;
          case Phase::Grasp: grasp(state); break;
          case Phase::Probe: probe(); break;
          case Phase::Open: open(state); break;
          case Phase::Regrasp: regrasp(state); break;
          case Phase::Release: release(state); break;
          case Phase::Retreat: retreat(state); break;
          case Phase::Done:
          case Phase::Stopped: break;
        }
      } catch (const std::exception& error) {  // planning allocates; it runs while the robot stands
        detail = error.what();
        process(Event::Fault, EndReason::Unreachable);
      }
    }
  }
  if (!command.dq.allFinite() || !std::isfinite(command.base_v) || !std::isfinite(command.base_w)) command_zero();
  command.leans = handle.press && (phase == Phase::Grasp || phase == Phase::Open || phase == Phase::Release);
  predictor.sent(command);
  record.phase = phase;
  record.reason = why;
  return command;
}

bool Mission::Impl::unhealthy(const RobotState& state) noexcept {
  if (interrupted) {
    process(Event::Fault, EndReason::Interrupted);
    return true;
  }
  if (state.q.size() != model.joints() || state.dq.size() != model.joints() || !finite(state)) {
    process(Event::Fault, EndReason::SensorInvalid);
    return true;
  }
  if (state.time - state.wrench_time > config.limits.sensor_timeout + config.period) {
    process(Event::Fault, EndReason::SensorSilent);
    return true;
  }
  if (state.time > config.limits.time) {
    process(Event::Fault, EndReason::TimeLimit);
    return true;
  }
  return false;
}

bool Mission::Impl::too_much(const RobotState&) noexcept {
  if (wrench.zero_samples() == 0 || phase == Phase::Zero) return false;  // the bias is not yet known
  const double force = record.wrench.force.norm();
  const double torque = record.wrench.torque.norm();
  if (force <= config.limits.abort_force && torque <= config.limits.abort_torque) return false;
  try {
    detail = fmt::format("{:.0f} N and {:.1f} N m at the hand, limits {:.0f} N and {:.0f} N m", force, torque,
                         config.limits.abort_force, config.limits.abort_torque);
  } catch (const std::exception&) {
    detail.clear();  // the reason alone must do
  }
  process(Event::Fault, EndReason::ForceLimit);
  return true;
}

bool Mission::Impl::base_blocked(const RobotState& state) noexcept {
  const bool told = std::abs(command.base_v) > kBlockedCommand || std::abs(command.base_w) > kBlockedTurn;
  const bool moves = std::abs(state.base_v) > kBlockedShare * std::abs(command.base_v) ||
                     std::abs(state.base_w) > kBlockedShare * std::abs(command.base_w);
  blocked_time = told && !moves ? blocked_time + config.period : 0.0;
  if (blocked_time < kBlockedTime) return false;
  process(Event::Fault, EndReason::BaseBlocked);
  return true;
}

void Mission::Impl::process(Event event, EndReason reason) noexcept {
  if (reason != EndReason::Running && (why == EndReason::Running || event == Event::Fault)) {
    // After letting go a fault no longer changes what was reached.
    const bool opened = why == EndReason::GoalReached || why == EndReason::StopFelt;
    if (!(opened && event == Event::Fault)) why = reason;
    ended_in = phase;
  }
  const Phase next = next_phase(phase, event);
  if (next != phase) enter(next);
}

void Mission::Impl::enter(Phase next) noexcept {
  if (next != Phase::Release && next != Phase::Regrasp)
    command_zero();  // the hand on the handle brakes together with the base
  phase = next;
  time_in_phase = 0.0;
  planned = false;
  located = false;
  blocked_time = 0.0;
  given_until = 0.0;
  run_up = 0.0;
  still_force.setZero();
  still_ticks = 0;
  switch (next) {
    case Phase::Choose:
    case Phase::Reach: sights.reset(); break;
    case Phase::Zero: wrench.reset(); break;
    case Phase::Grasp:
      closing = false;
      controller.reset();
      break;
    case Phase::Probe:
      ++probes;
      prober.start(record.kinematics.X_WE, guess ? direction : Vector3d(Vector3d::Zero()));
      controller.reset();
      break;
    case Phase::Open:
      controller.reset();
      leaf_pull = fenced = 0.0;
      break;
    case Phase::Retreat: retreat_sense = 0.0; break;
    case Phase::Regrasp:
      led_back = is_shut = cleared = false;
      flap_looked = 0.0;
      break;
    case Phase::Approach:
    case Phase::Release:
    case Phase::Done:
    case Phase::Stopped: break;
  }
}

void Mission::Impl::command_zero() noexcept {
  command.dq.setZero(model.joints());
  command.base_v = 0.0;
  command.base_w = 0.0;
}

void Mission::Impl::command_solution() noexcept {
  const int n = model.joints();
  command.dq = record.solution.u.head(n);
  command.base_w = record.solution.u[n];
  command.base_v = record.solution.u[n + 1];
}

void Mission::Impl::command_joints(const JointVector& rates) noexcept {
  command_zero();
  command.dq = rates;
}

void Mission::Impl::command_base(const BaseTwist& twist) noexcept {
  command_zero();
  const RobotLimits& limits = model.limits();
  const double v_limit = twist.v < 0.0 ? limits.base_reverse : limits.base_forward;
  // One factor for both keeps the path.
  const double excess = std::max({1.0, std::abs(twist.v) / v_limit, std::abs(twist.w) / limits.base_yaw_rate});
  command.base_v = twist.v / excess;
  command.base_w = twist.w / excess;
}

}  // namespace ajar
