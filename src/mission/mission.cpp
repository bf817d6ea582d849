#include "ajar/mission/mission.hpp"

#include <cmath>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "ajar/core/error.hpp"
#include "mission_impl.hpp"

namespace ajar {

const char* to_string(Phase phase) noexcept {
  switch (phase) {
    case Phase::Choose: return "choose";
    case Phase::Approach: return "approach";
    case Phase::Reach: return "reach";
    case Phase::Zero: return "zero";
    case Phase::Grasp: return "grasp";
    case Phase::Probe: return "probe";
    case Phase::Open: return "open";
    case Phase::Regrasp: return "regrasp";
    case Phase::Release: return "release";
    case Phase::Retreat: return "retreat";
    case Phase::Done: return "done";
    case Phase::Stopped: return "stopped";
  }
  return "stopped";
}

const char* to_string(EndReason reason) noexcept {
  switch (reason) {
    case EndReason::Running: return "running";
    case EndReason::GoalReached: return "goal_reached";
    case EndReason::StopFelt: return "stop_felt";
    case EndReason::HandleUnseen: return "handle_unseen";
    case EndReason::NothingToGrip: return "nothing_to_grip";
    case EndReason::Unreachable: return "unreachable";
    case EndReason::ApproachBlocked: return "approach_blocked";
    case EndReason::GraspMissed: return "grasp_missed";
    case EndReason::GraspLost: return "grasp_lost";
    case EndReason::Locked: return "locked";
    case EndReason::OpensAway: return "opens_away";
    case EndReason::NeedsMoreForce: return "needs_more_force";
    case EndReason::Stalled: return "stalled";
    case EndReason::ClearanceStop: return "clearance_stop";
    case EndReason::SensorInvalid: return "sensor_invalid";
    case EndReason::SensorSilent: return "sensor_silent";
    case EndReason::BaseBlocked: return "base_blocked";
    case EndReason::ForceLimit: return "force_limit";
    case EndReason::TimeLimit: return "time_limit";
    case EndReason::Interrupted: return "interrupted";
  }
  return "running";
}

void MissionConfig::validate() const {
  navigation.validate();
  planner.validate();
  wbc.validate();
  thesis.validate();
  base_law.validate();
  force.validate();
  estimator.validate();
  follow.validate();
  drives.validate();
  if (task != "open" && task != "follow") throw ConfigError(fmt::format("task: {}: must be open or follow", task));
  const auto positive = [](const char* key, double value) {
    if (!(std::isfinite(value) && value > 0.0)) {
      throw ConfigError(fmt::format("{}: {}: must be a finite number above 0", key, value));
    }
  };
  positive("limits.force_N", limits.force);
  positive("limits.abort_force_N", limits.abort_force);
  positive("limits.abort_torque_Nm", limits.abort_torque);
  positive("limits.time_s", limits.time);
  positive("limits.sensor_timeout_s", limits.sensor_timeout);
  positive("goal.opening_deg", goal.opening_angle);
  positive("goal.opening_m", goal.opening_length);
  if (!(period >= 1e-3 && period <= 0.05)) {
    throw ConfigError(fmt::format("control.rate_hz: {}: must be 20 to 1000", 1.0 / period));
  }
  if (!(dead_time >= 0.0 && dead_time <= 0.5)) {
    throw ConfigError(fmt::format("control.delay_ms: {}: must be 0 to 500", 1e3 * dead_time));
  }
  if (controller != "qp" && controller != "thesis") {
    throw ConfigError(fmt::format("control.controller: {}: must be qp or thesis", controller));
  }
  if (limits.force >= limits.abort_force) {
    throw ConfigError(
        fmt::format("limits.force_N: {}: must be below limits.abort_force_N = {}", limits.force, limits.abort_force));
  }
}

namespace {

// "upper_arm_link 0.02 m from cabinet"
std::string in_words(const ClearanceRow& row, const RobotModel& model, bool doorway) {
  const auto link = [&](int shape) {
    const bool known = shape >= 0 && shape < static_cast<int>(model.shapes().size());
    return known ? model.shapes()[static_cast<std::size_t>(shape)].link : std::string("the robot");
  };
  std::string other = link(row.other_shape);
  if (row.obstacle == kWallObstacle || row.obstacle == kHingeWallObstacle) other = doorway ? "the frame" : "the wall";
  if (row.obstacle == kLeafObstacle) other = "the leaf";
  return fmt::format("{} {:.2f} m from {}", link(row.shape), row.distance, other);
}

// "; no posture was found that follows this to its end: drawer; hinge on the left, 0.33 m"
std::string not_foreseen(const GraspCandidate& chosen) {
  if (chosen.falls_short.empty()) return "";
  return fmt::format("; no posture was found that follows this to its end: {}", fmt::join(chosen.falls_short, "; "));
}

}  // namespace

Mission::Mission(const RobotModel& model, const MissionConfig& config, std::optional<Vector3d> direction_guess,
                 std::uint64_t seed) {
  config.validate();
  impl_ = std::make_unique<Impl>(model, config, direction_guess, seed);
}

Mission::~Mission() = default;

Command Mission::step(const RobotState& state) noexcept { return impl_->step(state); }
void Mission::interrupt() noexcept { impl_->interrupted = true; }
bool Mission::finished() const noexcept { return impl_->phase == Phase::Done || impl_->phase == Phase::Stopped; }
bool Mission::reached_goal() const noexcept {
  return impl_->why == EndReason::GoalReached || impl_->why == EndReason::StopFelt;
}
Phase Mission::phase() const noexcept { return impl_->phase; }
Phase Mission::end_phase() const noexcept { return impl_->ended_in; }
EndReason Mission::reason() const noexcept { return impl_->why; }
const MissionRecord& Mission::record() const noexcept { return impl_->record; }
const GraspCandidate& Mission::chosen() const noexcept { return impl_->chosen; }

std::string Mission::explain() const {
  const Impl& m = *impl_;
  const MechanismEstimate& e = m.record.estimate;
  std::string seen = fmt::format("{:.2f} m of travel, {:.0f} deg turned", e.arc, e.angle * 180.0 / M_PI);
  if (m.went_back) seen += "; let go, it goes back as far as that";
  if (m.holding) seen += "; it closes by itself and is held";
  const std::string room = m.handle.passage ? fmt::format("; {}", passage_room(*m.handle.passage, m.model)) : "";
  switch (m.why) {
    case EndReason::GoalReached: return fmt::format("open as wanted: {}", seen);
    case EndReason::StopFelt:
      if (m.fell) return fmt::format("it came down by itself as far as it goes: {:.0f} deg turned", e.angle * 180.0 / M_PI);
      return fmt::format("an end stop was felt: {}", seen);
    case EndReason::HandleUnseen: return "the camera saw no handle";
    case EndReason::NothingToGrip: return m.detail;
    case EndReason::Unreachable: return m.detail.empty() ? "no posture reaches the handle" : m.detail;
    case EndReason::ApproachBlocked: return "the base did not arrive where it should stand";
    case EndReason::GraspMissed: return "the fingers closed on nothing, three times";
    case EndReason::GraspLost: return fmt::format("the handle was lost: {}", seen);
    case EndReason::Locked: return fmt::format("nothing gives at {:.0f} N in any direction", m.prober.strongest());
    case EndReason::OpensAway:
      return fmt::format("it opens away from the robot, and no doorway is seen to push it through: {}", seen);
    case EndReason::NeedsMoreForce:
      return fmt::format("needs more than {:.0f} N at the handle: {}", m.config.limits.force - 8.0, seen);
    case EndReason::Stalled: return fmt::format("stands still without force: {}{}{}", seen, room, not_foreseen(m.chosen));
    case EndReason::ClearanceStop:
      return fmt::format("a clearance limit stops it, {}: {}{}{}", in_words(m.fence, m.model, m.handle.passage.has_value()),
                         seen, room, not_foreseen(m.chosen));
    case EndReason::SensorInvalid: return "a measurement was not a number";
    case EndReason::SensorSilent: return fmt::format("no wrist reading for {:.0f} ms", 1e3 * m.config.limits.sensor_timeout);
    case EndReason::BaseBlocked: return "the base is told to move and does not";
    case EndReason::ForceLimit: return m.detail;
    case EndReason::TimeLimit: return fmt::format("the time limit of {:.0f} s is over", m.config.limits.time);
    case EndReason::Interrupted: return "stopped by the operator";
    case EndReason::Running: break;
  }
  return "under way";
}

}  // namespace ajar
