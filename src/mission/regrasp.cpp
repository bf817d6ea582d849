// What the way that was felt says about the grasp, and the way back to take the handle anew.
#include "mission_impl.hpp"

#include <algorithm>
#include <array>

#include "ajar/planning/joint_path.hpp"

namespace ajar {
namespace {

// Judged so often while the estimate still grows; once good is good.
constexpr int kJudgements = 3;
constexpr double kFirstJudgement = 0.15;  // of arc [m]
constexpr double kJudgementStep = 0.025;  // [m]
constexpr double kBackTime = 40.0;        // a metre at 10 cm/s, waiting for the base as long again and more [s]

// The hand leaves in the first direction that keeps this from the leaf, from where the fingers are off the bar on.
constexpr double kFreeWay = 0.03;                      // the stop distance of the arm's rows [m]
constexpr std::array kWayPoints = {0.05, 0.08, 0.12};  // [m]
constexpr double kFoldStep = 0.05;                     // 5 cm of a stretched arm [rad]

}  // namespace

// A direction in which the open hand comes away from the leaf as it stands: along its own axis if it can, else turned away
// from the leaf or from the wall. Judged with the leaf moving the other way, which is the same. (docs/equations.md#way-out)
Vector3d Mission::Impl::way_out() noexcept {
  const Vector3d back = -record.kinematics.X_WE.linear().col(2);
  const Vector3d off = opener.scene().leaf_normal();
  const Vector3d& out = opener.scene().normal();
  const std::array<Vector3d, 5> ways{back, (back + off).normalized(), (out + off).normalized(), off, out};
  Vector3d best = back;
  double most = -1.0;
  for (const Vector3d& way : ways) {
    double room = kFreeWay;
    for (const double s : kWayPoints) {
      opener.scene().place_leaf_moved(clearance, -s * way);
      clearance.compute(model, ahead.robot.base, clearances);
      room = std::min(room, clearances.smallest[static_cast<std::size_t>(ClearanceKind::ArmWorld)]);
    }
    if (room > most + 1e-3) {
      most = room;
      best = way;
    }
  }
  return best;
}

Opener::Tick Mission::Impl::tick(const RobotState& state) noexcept {
  return {state, record.kinematics, ahead, record.wrench, controller, clearance, record};
}

// The grasp was chosen for all that might have been behind the handle. Once the way is known it is judged by that alone,
// when it is first known and again when it stands still short of its end; and taken anew once if it falls short.
// (docs/equations.md#regrasp)
bool Mission::Impl::better_held_otherwise(EndDetector::Verdict verdict) noexcept {
  const bool stands = verdict == EndDetector::Verdict::ClearanceStop || verdict == EndDetector::Verdict::Stalled;
  const double due = kFirstJudgement + judgements * kJudgementStep;
  const bool judge = verdict == EndDetector::Verdict::Going && judgements < kJudgements && record.estimate.arc > due;
  if (felt || handle.passage || handle.press || !(stands || judge)) return false;
  const std::optional<FeltMechanism> mechanism = opener.felt();
  if (!mechanism) return false;
  if (judge) {
    const bool good = good_to_the_end(*mechanism) || good_half_way(*mechanism);
    judgements = good ? kJudgements : judgements + 1;
    if (good || judgements < kJudgements) return false;
  }
  felt = mechanism;
  process(Event::Rechoose);
  return true;
}

// Back along the way that was felt, to where the handle was taken. True once it is there, or will not get there.
bool Mission::Impl::lead_back(const RobotState& state) noexcept {
  const bool back = opener.step_back(tick(state));
  command_solution();
  command.gripper_closed = true;
  return back || time_in_phase > kBackTime;
}

// A path of the arm to its driving posture, the base standing. False if there is none.
bool Mission::Impl::start_folding(const RobotState& state) {
  command_zero();
  opener.scene().place(clearance, false);
  // A leaf is thin: between two looks the hand must not get from one side to the other.
  JointPathConfig fine;
  fine.step = kFoldStep;
  std::vector<JointVector> path = plan_joint_path(model, clearance, state.base, state.q, model.home(), seed, fine);
  if (path.empty()) return false;
  joint_move.start(std::move(path));
  planned = true;
  return true;
}

}  // namespace ajar
