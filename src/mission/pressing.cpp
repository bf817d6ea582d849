// A flap that no hand can follow to its end by the handle: let go half open and pressed down from inside.
// (docs/equations.md#press)
#include <algorithm>
#include <cmath>

#include "ajar/core/so3.hpp"
#include "ajar/planning/hypotheses.hpp"
#include "mission_impl.hpp"

namespace ajar {
namespace {

// Half open: the hand still stands in front of the leaf, and another has room above its inner face [rad].
constexpr double kHalfOpen = 0.785;
// A leaf that stands still earlier leaves too little room between itself and what it closes [rad].
constexpr double kLeastOpen = 0.55;
// A roll-out worth less does not reach the end, or without the room that is wanted: what ten seconds cost an arm without
// manoeuvring room, and 2 % of the travel or half a centimetre.
constexpr double kWorthHolding = -0.06;
// A leaf that pulls the hand along with more than this comes down when nothing holds it, against the friction of rest
// too; the sooner it is let go the slower it starts [N].
constexpr double kFalls = 1.5;
constexpr double kFallsFrom = 0.26;  // its weight has a lever by then [rad]
constexpr double kPullTime = 0.15;   // mean of that pull [s]
// A hand that distances hold back to this share of its speed does not get to the end, but may jam on the way there [-].
constexpr double kFenced = 0.3;
// Nearer to its end than this it goes on slowly: letting go and coming back takes half a minute [rad].
constexpr double kNearlyOpen = 0.3;
// A hand that leans off the leaf by more has not turned with it as it should, 60 degrees; at 90 it lies on the leaf [rad].
constexpr double kFarthestLean = 1.3;
constexpr double kFencedTime = 0.1;  // [s]
// Following a flap to its end with less to spare jams more often than pressing it down takes longer: half a good value.
constexpr double kWorthFollowing = 0.05;
constexpr double kPressSpeed = 0.12;  // along the way: what a stop meets is a stiff arm, not a grasp [m/s]
constexpr double kPressSigma = 0.03;  // of a direction that was felt over half the way [rad]
constexpr double kTooFar = 0.35;      // beyond the wanted opening [rad]
constexpr double kSearch = 0.07;      // fingers look for the leaf this far below where they should meet it [m]
constexpr double kFeelSpeed = 0.04;   // [m/s]
constexpr double kLevelAxis = 0.3;    // sine: within 17 degrees of level
constexpr double kTouch = 4.0;        // four deviations of noise and drift of the sensor [N]
constexpr double kMetAt = 5e-3;       // the end of the search [m]
constexpr double kSearchTime = 12.0;  // [s]
// Nearer than this to where the face should be, what the sight errs by, the hand is slow: a flap at its stop is as hard as a
// wall, and K v T is the blow of bare fingers (as of an end stop, docs/equations.md#speed-law).
constexpr double kNearFace = 0.03;      // [m]
constexpr double kFaceBlow = 50.0;      // [N]
constexpr double kFaceStiffness = 7e4;  // of bare fingers and arm: five stiff grasps [N/m]
constexpr double kReaction = 0.025;     // of the arm, beyond the loop's own delay [s]
constexpr double kLookAgain = 0.5;      // [s]
constexpr double kFell = 0.2;           // by so much no flap swings that does not run on to its stop [rad]
constexpr double kMoved = 0.05;         // a leaf that has turned more than this since the choice moves by itself [rad]

}  // namespace

void Opener::start_pressing(const RobotState& state, const Kinematics& kinematics, const HandleBelief& belief) noexcept {
  if (!belief.press) return;
  const FlapPress& press = *belief.press;
  press_ = press;
  const Vector3d& hand = kinematics.X_WE.translation();
  R_grasp_ = kinematics.X_WE.linear();
  bar_in_hand_ = R_grasp_.transpose() * press.way.curvature.normalized();
  base_law_.reset(state.base, hand);
  straight_ = held_fast_ = false;
  taken_at_ = hand;
  opened_ = press.opened;
  scene_.reset(belief);
  force_law().reset();
  speed_law().reset();
  ends_.reset();
  if (thesis_) thesis_->reset();
  base_lag_ = 0.0;
}

MechanismEstimate Opener::pressing_at(const Vector3d& hand) const noexcept {
  if (!press_) return estimator_.estimate();
  const FlapPress& press = *press_;
  const Vector3d axis = press.way.curvature.normalized();
  const auto arm = [&](const Vector3d& p) -> Vector3d { return p - press.centre - axis * axis.dot(p - press.centre); };
  const Vector3d from = arm(taken_at_);
  const Vector3d to = arm(hand);
  const double radius = std::max(to.norm(), 1e-3);
  MechanismEstimate out = estimator_.estimate();
  out.type = MechanismType::Hinge;
  out.fitted = true;
  out.direction = axis.cross(to) / radius;
  out.curvature = axis / radius;
  out.point = hand;
  out.direction_sigma = kPressSigma;
  out.angle = std::atan2(axis.dot(from.cross(to)), from.dot(to));
  out.arc = (opened_ + out.angle) * radius;
  return out;
}

EndDetector::Verdict Opener::step_pressing(const Tick& tick) noexcept {
  if (!press_) return EndDetector::Verdict::Going;
  const FeltMechanism way = press_->way;
  const Vector3d velocity = hand_velocity(tick);
  const MechanismEstimate estimate = pressing_at(tick.kin.X_WE.translation());
  const ForceCorrection correction = force_law().step(tick.wrench, estimate.direction, Vector3d::Zero());
  const double along = estimate.direction.dot(velocity);
  const double speed = wanted_speed(estimate, correction, along, std::min(kPressSpeed, speed_cap(estimate)));
  move(tick, estimate, correction, speed);
  EndDetector::Verdict verdict = ends_.step({.dt = config_.period,
                                             .speed = along,
                                             .wanted_speed = speed,
                                             .pull_force = correction.pull_force,
                                             .running_force = speed_law().running_force(),
                                             .force_cap = config_.force.force_limit,
                                             .speed_factor = tick.record.solution.speed_factor,
                                             .binding = tick.record.solution.binding},
                                            tick.record.estimate);
  // A leaf that runs ahead is not where the hand is: its stop ends the way, or a turn that no leaf makes.
  const bool pressing = correction.pull_force > kTouch || tick.record.estimate.angle > config_.goal.opening_angle + kTooFar;
  if (verdict == EndDetector::Verdict::Goal && !pressing) verdict = EndDetector::Verdict::Going;
  // A hand that comes to stand beyond the goal had no leaf in its way.
  const bool stands = verdict == EndDetector::Verdict::ClearanceStop || verdict == EndDetector::Verdict::Stalled;
  if (stands && tick.record.estimate.angle > config_.goal.opening_angle) verdict = EndDetector::Verdict::Goal;
  // What is recorded is the way of the handle.
  const Vector3d axis = way.curvature.normalized();
  tick.record.estimate.direction = exp_so3(tick.record.estimate.angle * axis) * way.direction;
  tick.record.estimate.curvature = way.curvature;
  return verdict;
}

// A flap whose handle no hand can follow to the end is let go half open; so is one that stands still farther than that.
bool Mission::Impl::press_instead(EndDetector::Verdict verdict) noexcept {
  if (handle.press || handle.passage) return false;
  const double angle = record.estimate.angle;
  const double pull = record.wrench.force.dot(record.estimate.direction);
  leaf_pull += std::min(1.0, config.period / kPullTime) * (pull - leaf_pull);
  const WbcSolution& u = record.solution;
  fenced = u.binding == BindingLimit::Clearance && u.speed_factor < kFenced ? fenced + config.period : 0.0;
  const bool stands = verdict == EndDetector::Verdict::ClearanceStop || verdict == EndDetector::Verdict::Stalled;
  const bool falls = leaf_pull < -kFalls && angle > kFallsFrom;
  const Vector3d back = -record.kinematics.X_WE.linear().col(2);
  const double lean = std::acos(std::clamp(back.dot(opener.scene().leaf_normal()), -1.0, 1.0));
  const bool due = half_way && (falls || angle > kHalfOpen);
  const bool jams = (fenced > kFencedTime || lean > kFarthestLean) && angle < config.goal.opening_angle - kNearlyOpen;
  if (!due && !((stands || jams) && angle > kLeastOpen)) return false;
  const std::optional<FeltMechanism> mechanism = opener.felt();
  if (!mechanism || !comes_down(handle, *mechanism)) return false;
  flap = make_press(*mechanism, taken_at.translation(), angle);
  let_go_at = angle;
  closed_handle = handle;
  process(Event::Rechoose);
  return true;
}

// Whether the grasp is worth keeping to the end for what was felt.
bool Mission::Impl::good_to_the_end(const FeltMechanism& mechanism) noexcept {
  HandleBelief known = handle;
  known.felt = mechanism;
  return planner.value_for_felt(known, chosen) >= (comes_down(handle, mechanism) ? kWorthFollowing : kWorthHolding);
}

// Whether the grasp reaches half the way of a flap, if not all of it.
bool Mission::Impl::good_half_way(const FeltMechanism& mechanism) noexcept {
  if (!comes_down(handle, mechanism)) return false;
  HandleBelief known = handle;
  FeltMechanism half = mechanism;
  half.angle = kHalfOpen;
  known.felt = half;
  half_way = planner.value_for_felt(known, chosen) >= kWorthHolding;
  return half_way;
}

// Grasps for a flap that was felt: to its end if there is one, else half the way.
void Mission::Impl::choose_half_way() {
  half_way = false;
  if (!felt || !comes_down(handle, *felt) || (!candidates.empty() && candidates.front().value >= kWorthFollowing)) return;
  FeltMechanism half = *felt;
  half.angle = kHalfOpen;
  handle.felt = half;
  candidates = planner.choose(handle, seed, &detail);
  half_way = !candidates.empty();
}

// Looks how far the leaf stands open that was let go, and what is believed of it. True if there is nothing left to press.
bool Mission::Impl::look_at_flap() noexcept {
  if (!flap) return false;
  FlapPress press = *flap;
  press.opened = seen_opening(press, handle.normal);
  flap = press;
  handle = closed_handle;
  handle.felt.reset();
  handle.press = press;
  handle.normal = press.way.curvature.normalized().cross(Vector3d::UnitZ());
  record.estimate.angle = press.opened;
  if (press.opened > config.goal.opening_angle) {  // it came down by itself
    process(Event::Ended, EndReason::GoalReached);
  }
  return phase != Phase::Choose;
}

// The flap that was let go, as it is believed to stand.
HandleBelief Mission::Impl::half_open() const noexcept {
  HandleBelief belief = closed_handle;
  belief.press = flap;
  return belief;
}

// Waits until a leaf that comes down by itself has come to rest, and believes in it where it is seen.
bool Mission::Impl::flap_rests(const RobotState& state) noexcept {
  command_zero();
  if (!flap) return true;
  FlapPress press = *flap;
  if (flap_looked == 0.0) flap_looked = time_in_phase;
  if (time_in_phase < flap_looked + kLookAgain) return false;
  flap_looked = time_in_phase;
  SightAverage now;
  now.add(state.handle, state.base);
  const double opened = seen_opening(press, now.belief().normal);
  const bool rests = std::abs(opened - press.opened) < kMoved;
  press.opened = opened;
  flap = press;
  if (rests) {
    opener.scene().reset(half_open());
  }
  return rests;
}

// How far a flap stands open once the hand is off it is seen better than it was felt.
void Mission::Impl::look_at_result(const RobotState& state) noexcept {
  if (handle.passage || !state.handle.visible || record.estimate.type != MechanismType::Hinge) return;
  const FeltMechanism way{.direction = record.estimate.direction, .curvature = record.estimate.curvature};
  const bool level = std::abs(way.curvature.z()) < kLevelAxis * way.curvature.norm();
  if (!level || std::abs(handle.bar.z()) > kLevelAxis) return;
  SightAverage now;
  now.add(state.handle, state.base);
  const double opened = seen_opening(FlapPress{.way = way}, now.belief().normal);
  went_back = went_back || opened < record.estimate.angle - kFell;
  record.estimate.angle = opened;
}

// A leaf that moves by itself is no landmark.
bool Mission::Impl::flap_moved() noexcept {
  if (!flap) return false;
  FlapPress press = *flap;
  const double opened = seen_opening(press, seen().normal);
  const bool moved = std::abs(opened - press.opened) > kMoved;
  press.opened = opened;
  flap = press;
  handle.press = press;
  return moved;
}

// A flap that comes down by itself weighs more the farther it is down: what holds it before it lies level is its stop. That
// is not felt, and said only where no hand gets to it.
bool Mission::Impl::at_its_stop() noexcept {
  if (!handle.press || !flap) return false;
  const double opened = flap->opened;
  fell = opened > let_go_at + kFell && opened > config.goal.opening_angle - kNearlyOpen;
  if (fell) process(Event::Ended, EndReason::StopFelt);
  return fell;
}

// Down until the fingers stand on the leaf.
void Mission::Impl::press_down(const RobotState& state) noexcept {
  command.gripper_closed = true;
  Pose below = chosen.hand;
  below.translation() += kSearch * below.linear().col(2);
  const double above = chosen.hand.linear().col(2).dot(chosen.hand.translation() - ahead.kinematics.X_WE.translation());
  const double slow = kFaceBlow / (kFaceStiffness * (config.period + config.dead_time + kReaction));
  const double left = move_hand(below, above > kNearFace ? kFeelSpeed : std::min(kFeelSpeed, slow));
  const bool met = record.wrench.force.norm() > kTouch;
  if (!met && left > kMetAt && time_in_phase < kSearchTime) return;
  // A leaf that moves more easily than can be felt has gone along.
  if (!met && handle.press) {
    FlapPress press = *handle.press;
    press.opened = pressed_opening(handle, press, record.kinematics.X_WE.translation());
    handle.press = press;
  }
  taken_at = record.kinematics.X_WE;
  opener.start_pressing(state, record.kinematics, handle);
  process(Event::Held);
}

}  // namespace ajar
