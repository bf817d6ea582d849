#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "ajar/core/so3.hpp"
#include "mission_impl.hpp"

namespace ajar {
namespace {

constexpr double kLookTime = 0.1;       // sights averaged before a choice [s]
constexpr double kBlindTime = 2.0;      // no sight for this long: there is no handle to see [s]
constexpr double kApproachTime = 60.0;  // a drive of a few metres takes a third of this [s]
constexpr double kZeroTime = 0.5;       // the mean of 250 samples has a noise of 0.03 N [s]
constexpr double kQuietTime = 0.15;     // ten servo lags before zeroing [s]
constexpr double kHandSpeed = 0.06;     // towards and away from the handle [m/s]
constexpr double kHandGain = 2.5;       // [1/s]
constexpr double kAtHandle = 2e-3;      // [m]
constexpr double kNearHandle = 0.015;   // the fingers still close round the bar [m]
constexpr double kTouchForce = 12.0;    // the hand has met something [N]
constexpr double kAdvanceTime = 6.0;    // [s]
constexpr double kFingerTime = 2.5;     // longest closing: stroke over the slowest finger speed [s]
constexpr double kFingersStill = 0.15;  // [s]
constexpr double kHeldOpening = 0.003;  // fingers farther apart than this hold something [m]
constexpr int kMaxMisses = 3;
constexpr int kMaxProbes = 3;
constexpr double kProbeReserve = 8.0;    // over the force that moved it in probing [N]
constexpr double kRelease = 1e-3;        // gives way to what force is left: half of α_f [m/(N s)]
constexpr double kReleaseTurn = 0.05;    // [rad/(N m s)]
constexpr double kRelaxTime = 0.3;       // the hand gives way at least this long before the fingers open [s]
constexpr double kEaseTime = 0.8;        // the same for a pushed leaf; then the hand stands and feels whether it closes [s]
constexpr double kFeelTime = 0.5;        // for that [s]
constexpr double kHoldTime = 1.5;        // force that remains after this comes from the leaf, not from the arm [s]
constexpr double kLeadBackTime = 15.0;   // 12 cm at 1 cm/s, with reserve [s]
constexpr double kShutTime = 5.0;        // way back to where the leaf was taken: 14 cm at 6 cm/s, twice [s]
constexpr double kShut = 5e-3;           // nearer than this to that place it is shut [m]
constexpr double kLightForce = 1.5;      // three deviations of noise and drift of the sensor after a minute [N]
constexpr double kStillForce = 0.8;      // the same of a mean over half a second: what is left of noise is a tenth [N]
constexpr double kOpenFingerTime = 0.6;  // [s]
constexpr double kLetTime = 0.02;        // the fingers give way: 2 mm of their travel [s]
constexpr double kQuickHand = 0.6;       // away from a flap that may come down once nothing holds it [m/s]
constexpr double kQuickWay = 0.25;       // [m]
constexpr double kAllTheWay = 1.57;      // a flap that was let go may come down so far [rad]
constexpr double kWithdraw = 0.15;       // the hand leaves the handle by this much [m]
constexpr std::uint64_t kSecondDraw = 1000;  // added to the seed of the choice: another draw than any posture search had

}  // namespace

void Mission::Impl::choose(const RobotState& state) {
  command_zero();
  sights.add(state.handle, state.base);
  if (sights.count() == 0) {
    if (time_in_phase > kBlindTime) process(Event::GaveUp, EndReason::HandleUnseen);
    return;
  }
  if (time_in_phase < kLookTime) return;
  handle = landmark = seen();
  if (flap && look_at_flap()) return;
  if (felt_side) handle.passage = make_passage(handle, *felt_side);
  if (handle.passage && felt_radius) {
    if (const std::optional<Passage> pivot = pivot_passage(handle, *handle.passage, *felt_radius)) handle.passage = pivot;
  }
  if (!flap) handle.felt = felt;
  if (handle.thickness <= 0.0 || handle.thickness > model.gripper_stroke()) {
    detail = handle.thickness <= 0.0 ? std::string("nothing to grip: flush with the leaf")
                                     : fmt::format("nothing to grip: {:.3f} m thick, the fingers open to {:.3f} m",
                                                   handle.thickness, model.gripper_stroke());
    process(Event::GaveUp, EndReason::NothingToGrip);
    return;
  }
  candidates = planner.choose(handle, seed, &detail);
  if (!flap) choose_half_way();
  const bool narrow = handle.passage && passage_width(*handle.passage) < base_width(model);
  if (narrow) detail = passage_room(*handle.passage, model);
  if (candidates.empty() || (narrow && candidates.front().value < 0.0)) {
    if (at_its_stop()) return;
    if (flap) detail = fmt::format("let go, it stands open by {:.0f} deg: {}", flap->opened * 180.0 / M_PI, detail);
    process(Event::GaveUp, EndReason::Unreachable);
    return;
  }
  candidate = 0;
  tried = 0;
  drawn_anew = false;
  process(Event::Chosen);
}

KeepOut Mission::Impl::for_this_base(KeepOut keep_out) const noexcept {
  keep_out.front = footprint.front;
  keep_out.rear = footprint.rear;
  keep_out.half_width = footprint.half_width;
  return keep_out;
}

// The wall, or what stands beside it, that the base keeps out of on its way.
KeepOut Mission::Impl::kept_out() const noexcept {
  if (handle.press) return for_this_base(beside_flap(handle, *handle.press, handle.press->opened));
  KeepOut wall = for_this_base({});
  wall.point = (handle.position + (reveal_depth(handle) - handle.standoff) * handle.normal).head<2>();
  wall.normal = handle.normal.head<2>().normalized();
  if (handle.passage) {
    wall.point = handle.passage->hinge.head<2>();
    wall.normal = -handle.passage->inward.head<2>();
  }
  return wall;
}

void Mission::Impl::approach(const RobotState& state) {
  if (!planned) {
    const KeepOut wall = kept_out();
    if (handle.press && !off_flap(wall, state)) return;
    const bool upright = handle.normal.head<2>().norm() > 0.5;  // a lid has no wall behind it
    navigator.set_target(state.base, candidates[candidate].base, upright ? &wall : nullptr);
    planned = true;
  }
  command_base(navigator.step(ahead.robot.base_end));
  if (navigator.arrived()) {
    process(Event::Arrived);
  } else if (time_in_phase > kApproachTime) {
    process(Event::GaveUp, EndReason::ApproachBlocked);
  }
}

void Mission::Impl::next_candidate(const RobotState&) {
  ++tried;
  if (at_its_stop()) return;
  if (++candidate >= candidates.size() && !drawn_anew) {
    drawn_anew = true;  // other postures, for the handle as it is known from near
    candidates = planner.choose(handle, seed + kSecondDraw, nullptr);
    candidate = 0;
  }
  if (candidate < candidates.size()) {
    process(Event::NextPose);
    return;
  }
  if (detail.empty()) detail = fmt::format("no posture is good enough from any of {} base poses", tried);
  process(Event::GaveUp, EndReason::Unreachable);
}

void Mission::Impl::zero(const RobotState& state) noexcept {
  command_zero();
  if (time_in_phase > kQuietTime) wrench.zero(state, record.kinematics);
  if (time_in_phase > kQuietTime + kZeroTime) process(Event::Zeroed);
}

void Mission::Impl::solve_hand_twist(const Vector6d& twist, bool base_fixed) noexcept {
  WbcProblem problem;
  problem.kinematics = &ahead.kinematics;
  problem.q = &ahead.robot.q;
  problem.base_motion = ahead.robot.base_motion;
  problem.tangential = twist;
  problem.base_fixed = base_fixed;
  if (!base_fixed) problem.base = {run_up, 0.0};
  opener.scene().place(clearance, true);
  clearance.compute(model, ahead.robot.base, clearances);
  problem.clearance = &clearances;
  (void)controller.solve(problem, record.solution);  // its status travels in the record
  record.reference = twist;
  record.clearance_min = *std::min_element(clearances.smallest.begin(), clearances.smallest.end());
  command_solution();
}

double Mission::Impl::move_hand(const Pose& target, double speed, bool base_fixed) noexcept {
  const Pose& hand = ahead.kinematics.X_WE;
  const Vector3d error = target.translation() - hand.translation();
  Vector3d v = kHandGain * error;
  if (v.norm() > speed) v *= speed / v.norm();
  Vector6d twist;
  twist << v, kHandGain * log_so3(target.linear() * hand.linear().transpose());
  solve_hand_twist(twist, base_fixed);
  return error.norm();
}

void Mission::Impl::grasp(const RobotState& state) noexcept {
  if (handle.press) {
    press_down(state);
    return;
  }
  if (closing) {
    close_fingers(state);
    return;
  }
  const double error = move_hand(chosen.hand, kHandSpeed);
  const bool touched = error < kNearHandle && record.wrench.force.norm() > kTouchForce;
  if (error < kAtHandle || touched || (time_in_phase > kAdvanceTime && error < kNearHandle)) {
    closing = true;
    still_fingers = 0.0;
    last_opening = state.gripper_opening;
    time_in_phase = 0.0;
  } else if (time_in_phase > kAdvanceTime) {
    process(Event::GaveUp, EndReason::GraspMissed);
  }
}

void Mission::Impl::close_fingers(const RobotState& state) noexcept {
  command_zero();
  command.gripper_closed = true;
  const bool moving = std::abs(state.gripper_opening - last_opening) > 1e-3 * config.period;
  last_opening = state.gripper_opening;
  still_fingers = moving ? 0.0 : still_fingers + config.period;
  if (time_in_phase < 2.0 * kFingersStill || (still_fingers < kFingersStill && time_in_phase < kFingerTime)) return;
  if (state.gripper_opening > kHeldOpening) {
    direction = guess.value_or(handle.normal);
    if (handle.passage) direction = passage_direction(handle, *handle.passage);
    if (felt) direction = felt->direction;
    taken_at = record.kinematics.X_WE;
    opener.start(state, record.kinematics, handle, direction, moving_force);
    record.estimate = opener.estimate();
    process(guess || handle.passage || felt ? Event::Held : Event::HeldBlind);
    return;
  }
  command.gripper_closed = false;
  if (++misses < kMaxMisses) {
    process(Event::Missed);
  } else {
    process(Event::GaveUp, EndReason::GraspMissed);
  }
}

void Mission::Impl::probe() noexcept {
  solve_hand_twist(prober.step(record.kinematics.X_WE, record.wrench, config.period));
  if (prober.status() == Prober::Status::Found) {
    moving_force = prober.force() + kProbeReserve;
    opener.redirect(record.kinematics, prober.direction(), moving_force);
    record.estimate = opener.estimate();
    process(Event::Found);
  } else if (prober.status() == Prober::Status::Nothing) {
    process(Event::Ended, EndReason::Locked);
  }
}

void Mission::Impl::open(const RobotState& state) noexcept {
  if (!handle.press && state.gripper_opening < kHeldOpening) {
    process(Event::Fault, EndReason::GraspLost);
    return;
  }
  const EndDetector::Verdict verdict = handle.press ? opener.step_pressing(tick(state)) : opener.step(tick(state));
  command_solution();
  if (found_to_open_away(verdict) || found_to_pivot(verdict) || press_instead(verdict) || better_held_otherwise(verdict))
    return;
  switch (verdict) {
    case EndDetector::Verdict::Going: break;
    case EndDetector::Verdict::Goal: process(Event::Ended, EndReason::GoalReached); break;
    case EndDetector::Verdict::Stop: process(Event::Ended, EndReason::StopFelt); break;
    case EndDetector::Verdict::Blocked:
      if (probes < kMaxProbes) {
        process(Event::Blocked);
      } else {
        process(Event::Ended, EndReason::Locked);
      }
      break;
    case EndDetector::Verdict::TooHeavy: process(Event::Ended, EndReason::NeedsMoreForce); break;
    case EndDetector::Verdict::Stalled: process(Event::Ended, EndReason::Stalled); break;
    case EndDetector::Verdict::ClearanceStop:
      if (opener.clearances().count > 0) fence = opener.clearances().rows[0];
      process(Event::Ended, EndReason::ClearanceStop);
      break;
  }
}

// Gives way to what force is left, opens the fingers and draws the hand back along its axis. True once it is clear.
bool Mission::Impl::let_go(double give_time) noexcept {
  // A hand that goes on giving way would not feel a leaf that closes slowly by itself.
  const bool feels = handle.passage && time_in_phase > kEaseTime;
  if (given_until == 0.0) {
    if (feels) still_force += (record.wrench.force - still_force) / ++still_ticks;
    const bool light = feels ? still_force.norm() < kStillForce : record.wrench.force.norm() < kLightForce;
    presses = !light;
    const double least = handle.passage ? kEaseTime + kFeelTime : kRelaxTime;
    if (time_in_phase > least && !runs_up() && (light || time_in_phase > give_time)) given_until = time_in_phase;
  }
  // What comes down once nothing holds it leaves no time: the open fingers slide off the bar along themselves.
  const bool quick = flap && !handle.press;
  if (given_until == 0.0 || time_in_phase < given_until + (quick ? kLetTime + config.dead_time : kOpenFingerTime)) {
    // The arm takes up what the base still rolls and lets the force go; then the fingers open.
    Vector6d give;
    give << -kRelease * record.wrench.force, -kReleaseTurn * record.wrench.torque;
    if (given_until > 0.0 || feels) give.setZero();
    solve_hand_twist(give, false);
    command.gripper_closed = given_until == 0.0;
    clear_pose = record.kinematics.X_WE;
    if (given_until > 0.0) clear_pose.translation() += (flap ? kQuickWay : kWithdraw) * way_out();
    return false;
  }
  // An arm that has no room left draws back with the base.
  const double left = move_hand(clear_pose, quick ? kQuickHand : kHandSpeed, false);
  return left < 5.0 * kAtHandle || time_in_phase > kAdvanceTime + given_until;
}

// A pushed leaf that closes by itself would come down on hand and base: it is held and not let go.
void Mission::Impl::release(const RobotState& state) {
  const bool pushed = handle.passage.has_value();
  if (!planned) {
    const bool clear = let_go(pushed ? kHoldTime : kRelaxTime);
    if (pushed && time_in_phase == given_until && presses) {
      command_zero();
      command.gripper_closed = true;
      holding = true;
      process(Event::Holding);
    } else if (clear && !pushed) {
      process(Event::Clear);
    } else if (clear && !start_folding(state)) {
      process(Event::Holding);  // no way back: it stays where it is
    }
    return;
  }
  command_joints(joint_move.step(ahead.robot.q, config.period));
  if (joint_move.done()) {
    process(Event::Clear);
  } else if (time_in_phase > kReachTime) {
    process(Event::Holding);  // something is in the way: it stays where it is
  }
}

// Leads what is held back to where it was taken hold of, so that the hand leaves a frame the way it came. Sideways it gives
// way. True once it is there or goes no further.
bool Mission::Impl::shut() noexcept {
  const Pose& hand = ahead.kinematics.X_WE;
  const Vector3d back = taken_at.translation() - hand.translation();
  const Vector3d along = back.normalized();
  const Vector3d& f = record.wrench.force;
  Vector6d twist;
  twist << std::min(kHandSpeed, kHandGain * back.norm()) * along - kRelease * (f - f.dot(along) * along),
      kHandGain * log_so3(taken_at.linear() * hand.linear().transpose()) - kReleaseTurn * record.wrench.torque;
  solve_hand_twist(twist);
  if (back.norm() < kShut) opener.scene().reset(handle);  // the leaf stands as it was first seen
  return back.norm() < kShut || time_in_phase > kShutTime;
}

// Lets go and folds the arm for the drive to another place.
void Mission::Impl::regrasp(const RobotState& state) {
  if (felt && !flap && !led_back) {
    led_back = lead_back(state);
    if (led_back) time_in_phase = 0.0;
    return;
  }
  if (!is_shut) {
    is_shut = flap || shut();
    if (is_shut) time_in_phase = 0.0;
    return;
  }
  if (!planned) {
    // A leaf that closes by itself is led back to its frame, or it would follow the hand.
    if (flap && given_until == 0.0) start_run_up();
    cleared = cleared || let_go(flap ? kRelaxTime : kLeadBackTime);
    if (!cleared ||
        (flap && (!off_flap(for_this_base(beside_flap(closed_handle, *flap, kAllTheWay)), state) || !flap_rests(state))))
      return;
    if (!start_folding(state)) process(Event::GaveUp, EndReason::Unreachable);
    return;
  }
  command_joints(joint_move.step(ahead.robot.q, config.period));
  if (joint_move.done()) {
    process(Event::Clear);
  } else if (time_in_phase > kReachTime + kLeadBackTime) {
    process(Event::GaveUp, EndReason::ApproachBlocked);
  }
}

}  // namespace ajar
