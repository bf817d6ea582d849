// The arm goes from its driving posture to the handle while the base stands.
#include <algorithm>
#include <array>

#include "ajar/planning/joint_path.hpp"
#include "mission_impl.hpp"

namespace ajar {
namespace {

constexpr double kSettleTime = 0.4;  // four lags of the base [s]
// The wall as it may stand: as far off as cameras misread it, half that, as it was seen.
constexpr std::array kMisreadShares = {1.0, 0.5, 0.0};

}  // namespace

double Mission::Impl::arm_room(const BasePose& base, const JointVector& q) noexcept {
  Kinematics kinematics;
  model.compute(base, q, kinematics);
  clearance.compute(model, base, clearances);
  return clearances.smallest[static_cast<std::size_t>(ClearanceKind::ArmWorld)];
}

// Round a wall that was misread by 10 degrees a wide swing of the arm meets it. The path keeps clear of the wall as it may
// stand, as far as start and goal do so themselves.
std::vector<JointVector> Mission::Impl::reach_path(const RobotState& state) {
  const JointPathConfig wanted;
  const double room = std::min({wanted.clearance, arm_room(state.base, state.q), arm_room(state.base, chosen.approach)});
  std::vector<JointVector> path;
  for (const double share : kMisreadShares) {
    opener.scene().place_misread(clearance, share);
    const double left = std::min(arm_room(state.base, state.q), arm_room(state.base, chosen.approach));
    if (share > 0.0 && left < room) continue;
    path = plan_joint_path(model, clearance, state.base, state.q, chosen.approach, seed, wanted);
    if (!path.empty()) break;
  }
  opener.scene().place_misread(clearance, 0.0);
  return path;
}

void Mission::Impl::start_reach(const RobotState& state) {
  chosen = candidates[candidate];
  if (!planner.choose_posture(handle, state.base, seed + candidate, chosen)) {
    next_candidate(state);
    return;
  }
  opener.scene().reset(handle);
  opener.scene().place(clearance, false);
  std::vector<JointVector> path = reach_path(state);
  if (path.empty()) {
    next_candidate(state);
    return;
  }
  joint_move.start(std::move(path));
  planned = true;
}

void Mission::Impl::reach(const RobotState& state) {
  command_zero();
  if (!planned) {
    sights.add(state.handle, state.base);
    if (time_in_phase < kSettleTime) return;
    if (sights.count() == 0) {
      process(Event::GaveUp, EndReason::HandleUnseen);
      return;
    }
    if (!located) {
      if (!flap_moved()) correct_odometry(seen());
      located = true;  // the next tick sees the base where it is
    } else {
      start_reach(state);
    }
    return;
  }
  command_joints(joint_move.step(ahead.robot.q, config.period));
  if (joint_move.done()) {
    process(Event::AtHandle);
  } else if (time_in_phase > kReachTime) {
    process(Event::GaveUp, EndReason::ApproachBlocked);
  }
}

}  // namespace ajar
