#include "ajar/navigation/navigator.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"

namespace ajar {

namespace {

// Nearer than this the laws' curvature ~ error/r only amplifies errors: the base docks straight (singular at r = 0).
constexpr double kDockRadius = 0.03;
// A target that was passed at most this far aside is left to the terminal corrections.
constexpr double kPassRadius = 0.3;
// A point on the way counts as reached this near: nothing happens there but a turn.
constexpr double kViaRadius = 0.10;
constexpr double kViaPassRadius = 0.4;
// Gain of the last straight centimetres: well below 1/(0.1 s lag + 0.05 s delay) [1/s].
constexpr double kCreepGain = 1.5;
// Share of the braking power that profiles plan with; the rest covers lag and delay of the drives.
constexpr double kBrakingShare = 0.6;
// Longer than lag plus delay of a drive: the base stands when its errors are judged [s].
constexpr double kSettleTime = 0.35;
// A heading this near is good enough to start a leg; the law turns the rest while driving [rad].
constexpr double kStartHeading = 0.1;
// A correcting move of at most a few cm needs no better direction: 0.02 rad x 3 cm = 0.6 mm.
constexpr double kAlignHeading = 0.02;
// Farther off than this a correction is a journey of its own [m].
constexpr double kFarOff = 0.2;
// Tolerances that a base at rest may be off before it starts again: hysteresis against the latch.
constexpr double kUnlatch = 20.0;
// No stage lasts longer, whatever the base does [s]; a journey of 3 m takes about 12 s.
constexpr double kStageTime = 60.0;
constexpr double kTerminalStageTime = 12.0;
// Prediction: step and horizon [s].
constexpr double kPredictionStep = 0.05;
constexpr double kPredictionTime = 60.0;
// What a turn on the spot must save to be preferred: smooth paths disturb odometry and load less [s].
constexpr double kTurnPrice = 2.0;
// More than any time: what a route costs that goes where it must not [s].
constexpr double kForbidden = 1e3;
// A path may bend to this radius without being charged [1/m].
constexpr double kEasyCurvature = 3.0;
// A way round by a point this far in front of the keep-out border leaves room to turn on the spot
// (circumscribed radius 0.57 m, twice, plus margin) [m].
constexpr double kViaDistance = 1.3;

/// Speed that removes an error: proportional, able to stop in time, bounded.
double profile(double error, double gain, double acceleration, double bound) {
  const double braking = std::sqrt(2.0 * kBrakingShare * acceleration * std::abs(error));
  return std::copysign(std::min({gain * std::abs(error), braking, bound}), error);
}

double distance_between(const BasePose& a, const BasePose& b) { return std::hypot(a.x - b.x, a.y - b.y); }

/// Signed distance to the goal along a heading.
double along(const BasePose& base, const BasePose& goal, double yaw) {
  return (goal.x - base.x) * std::cos(yaw) + (goal.y - base.y) * std::sin(yaw);
}

}  // namespace

Navigator::Navigator(const NavigationConfig& config, double period)
    : config_(config), polar_(config.law != "graceful"), period_(period) {
  config_.validate();
  if (!(period > 0.0) || !std::isfinite(period)) {
    throw ConfigError("navigation: period = " + std::to_string(period) + " s: must be positive and finite");
  }
}

BaseTwist Navigator::step(const BasePose& base) noexcept {
  if (!std::isfinite(base.x) || !std::isfinite(base.y) || !std::isfinite(base.yaw)) {
    state_.last = {};  // blind: stand still at once
    return {};
  }
  return advance(state_, base, period_);
}

// Stage changes first (a bounded chain), then the wanted twist, then the limits with one common factor: scaling v and ω
// together only re-times the path. (docs/equations.md#navigation)
BaseTwist Navigator::advance(State& state, const BasePose& base, double dt) const noexcept {
  state.timer += dt;
  for (int i = 0; i < 4 && leave_stage(state, base); ++i) state.timer = 0.0;
  BaseTwist want = wanted(state, base);
  const double v_bound = want.v < 0.0 ? std::min(config_.v_reverse, config_.v_max) : config_.v_max;
  const double excess = std::max({1.0, std::abs(want.v) / v_bound, std::abs(want.w) / config_.w_max});
  want = {want.v / excess, want.w / excess};
  const double dv = want.v - state.last.v;
  const double dw = want.w - state.last.w;
  const double share =
      std::max({1.0, std::abs(dv) / (config_.acceleration * dt), std::abs(dw) / (config_.yaw_acceleration * dt)});
  state.last = {state.last.v + dv / share, state.last.w + dw / share};
  return state.last;
}

bool Navigator::inside_tolerance(const State& state, const BasePose& base) const noexcept {
  // Each correction that missed doubles what is accepted (at most fourfold): a slipping base still terminates.
  const double relaxed = std::min(4.0, std::exp2(std::max(0, state.corrections - 2)));
  return distance_between(base, state.target) <= relaxed * config_.position_tolerance &&
         std::abs(wrap_angle(state.target.yaw - base.yaw)) <= relaxed * config_.heading_tolerance;
}

// What is still wrong decides: a journey, a small straight move, or the last turn.
void Navigator::correct(State& state, const BasePose& base) const noexcept {
  const double error = distance_between(base, state.target);
  const double bearing = std::atan2(state.target.y - base.y, state.target.x - base.x);
  if (error > kFarOff) {
    const bool ahead = std::abs(wrap_angle(bearing - base.yaw)) <= 0.5 * std::numbers::pi;
    state.legs[0] = {{state.target.x, state.target.y, wrap_angle(bearing + (ahead ? 0.0 : std::numbers::pi))}, ahead, true};
    state.leg_count = 1;
    state.leg = 0;
    state.stage = Stage::Start;
  } else if (error > 0.7 * config_.position_tolerance) {
    state.align_yaw = wrap_angle(base.yaw + wrap_half_turn(bearing - base.yaw));
    state.stage = Stage::Align;
  } else {
    state.stage = Stage::FinalTurn;
  }
}

double Navigator::start_heading(const Leg& leg, const BasePose& base) const noexcept {
  const double sight = std::atan2(leg.goal.y - base.y, leg.goal.x - base.x) + (leg.forward ? 0.0 : std::numbers::pi);
  return sight + std::atan(-config_.k_phi * wrap_angle(leg.goal.yaw - sight));
}

/// The stages of a journey. @return true when the stage changed
bool Navigator::leave_journey(State& state, const BasePose& base) const noexcept {
  const Leg& leg = state.legs[static_cast<std::size_t>(state.leg)];
  const double r = distance_between(base, leg.goal);
  if (state.stage == Stage::Start) {
    state.stage = leg.turn_first && !polar_ ? Stage::FirstTurn : Stage::Drive;
    return true;
  }
  if (state.stage == Stage::FirstTurn) {
    const bool turned = std::abs(wrap_angle(start_heading(leg, base) - base.yaw)) <= kStartHeading;
    if (!turned && r > kDockRadius && state.timer < kTerminalStageTime) return false;
    state.stage = Stage::Drive;
    return true;
  }
  const bool passed = !polar_ && (leg.forward ? 1.0 : -1.0) * along(base, leg.goal, leg.goal.yaw) <= 0.0;
  const bool on_the_way = state.leg + 1 < state.leg_count;
  const double near = on_the_way ? kViaRadius : kDockRadius;
  const double pass = on_the_way ? kViaPassRadius : kPassRadius;
  if (r > near && !(passed && r < pass) && state.timer < kStageTime) return false;
  if (on_the_way) ++state.leg;
  state.stage = on_the_way ? Stage::Start : Stage::Dock;
  return true;
}

/// The stages at the goal. @return true when the stage changed
bool Navigator::leave_terminal(State& state, const BasePose& base) const noexcept {
  const Leg& leg = state.legs[static_cast<std::size_t>(state.leg)];
  const bool late = state.timer > kTerminalStageTime;
  const double near = 0.3 * config_.position_tolerance;
  switch (state.stage) {
    case Stage::Dock:
      if (std::abs(along(base, leg.goal, leg.goal.yaw)) > near && !late) return false;
      correct(state, base);
      return true;
    case Stage::Align:
      if (std::abs(wrap_angle(state.align_yaw - base.yaw)) > kAlignHeading && !late) return false;
      state.stage = Stage::Creep;
      return true;
    case Stage::Creep:
      if (std::abs(along(base, state.target, base.yaw)) > near && !late) return false;
      state.stage = Stage::FinalTurn;
      return true;
    case Stage::FinalTurn:
      if (std::abs(wrap_angle(state.target.yaw - base.yaw)) > 0.5 * config_.heading_tolerance && !late) return false;
      state.stage = Stage::Settle;
      return true;
    case Stage::Settle:
      if (state.timer < kSettleTime) return false;
      if (inside_tolerance(state, base)) {
        state.stage = Stage::Arrived;
      } else {
        ++state.corrections;
        correct(state, base);
      }
      return true;
    default: break;
  }
  return false;
}

/// @return true when the stage changed
bool Navigator::leave_stage(State& state, const BasePose& base) const noexcept {
  switch (state.stage) {
    case Stage::Idle: return false;
    case Stage::Start:
    case Stage::FirstTurn:
    case Stage::Drive: return leave_journey(state, base);
    case Stage::Arrived:
      if (distance_between(base, state.target) < kUnlatch * config_.position_tolerance) return false;
      correct(state, base);  // pushed away
      return true;
    default: return leave_terminal(state, base);
  }
}

BaseTwist Navigator::drive(const Leg& leg, const BasePose& base) const noexcept {
  BaseTwist twist = polar_ ? polar_law(base, leg.goal, config_) : graceful_law(base, leg.goal, leg.forward, config_);
  if (polar_) return twist;
  const double r = distance_between(base, leg.goal);
  if (std::abs(twist.w) > config_.max_curvature * std::abs(twist.v)) {
    // The law asks for a sharper curve and would all but stop for it: drive the sharpest allowed one at that curve's speed.
    const double kappa = config_.max_curvature;
    const double v = std::min({config_.v_max / (1.0 + config_.beta * std::pow(kappa, config_.lambda)),
                               config_.v_max * r / config_.slow_radius, config_.w_max / kappa});
    twist = {std::copysign(v, twist.v), std::copysign(kappa * v, twist.w)};
  }
  const double stopping = profile(r, std::numeric_limits<double>::max(), config_.acceleration, config_.v_max);
  const double share = std::min(1.0, stopping / std::max(std::abs(twist.v), 1e-9));
  return {twist.v * share, twist.w * share};
}

BaseTwist Navigator::wanted(const State& state, const BasePose& base) const noexcept {
  const Leg& leg = state.legs[static_cast<std::size_t>(state.leg)];
  const auto turn_to = [&](double yaw) {
    return profile(wrap_angle(yaw - base.yaw), config_.k_final, config_.yaw_acceleration, config_.w_max);
  };
  const auto creep = [&](double error) { return profile(error, kCreepGain, config_.acceleration, config_.v_max); };
  switch (state.stage) {
    case Stage::FirstTurn: return {0.0, turn_to(start_heading(leg, base))};
    case Stage::Drive: return drive(leg, base);
    case Stage::Dock: return {creep(along(base, leg.goal, leg.goal.yaw)), turn_to(leg.goal.yaw)};
    case Stage::Align: return {0.0, turn_to(state.align_yaw)};
    case Stage::Creep: return {creep(along(base, state.target, base.yaw)), 0.0};
    case Stage::FinalTurn: return {0.0, turn_to(state.target.yaw)};
    case Stage::Idle:
    case Stage::Start:
    case Stage::Settle:
    case Stage::Arrived: break;
  }
  return {};
}

/// Straight from one place to another, turning at both ends.
Navigator::Leg Navigator::straight(const BasePose& from, const BasePose& to, bool forward) noexcept {
  const double sight = std::atan2(to.y - from.y, to.x - from.x);
  return {{to.x, to.y, wrap_angle(forward ? sight : sight + std::numbers::pi)}, forward, true};
}

Navigator::Prediction Navigator::predict(State state, BasePose base, const KeepOut* keep_out) const noexcept {
  // Slower than this the base turns rather than drives: ω/v is no path curvature [m/s].
  constexpr double kDriving = 0.03;
  Prediction out;
  out.clearance = out.box = std::numeric_limits<double>::infinity();
  while (out.time < kPredictionTime && state.stage != Stage::Arrived) {
    const BaseTwist twist = advance(state, base, kPredictionStep);
    base = integrate_base(base, twist.v, twist.w, kPredictionStep);
    if (std::abs(twist.v) > kDriving) out.curvature = std::max(out.curvature, std::abs(twist.w / twist.v));
    if (keep_out != nullptr) {
      out.clearance = std::min(out.clearance, footprint_clearance(base, *keep_out));
      out.box = std::min(out.box, box_clearance(base, *keep_out));
    }
    out.time += kPredictionStep;
  }
  out.arrives = state.stage == Stage::Arrived;
  return out;
}

// Cost = predicted time + prices; entering what is kept out of deeper than start and target do costs more than any time.
void Navigator::consider(State candidate, const BasePose& base, const KeepOut* keep_out) noexcept {
  const Prediction p = predict(candidate, base, keep_out);
  double cost = p.time + (p.arrives ? 0.0 : 1e4) + std::max(0.0, p.curvature - kEasyCurvature);
  for (int i = 0; i < candidate.leg_count; ++i)
    cost += candidate.legs[static_cast<std::size_t>(i)].turn_first ? kTurnPrice : 0.0;
  if (keep_out != nullptr) {
    const auto price = [&](double at_start, double at_target, double on_the_way) {
      // 1 cm: path following is not exact.
      const double intrusion = std::min(keep_out->margin, std::min(at_start, at_target) - 0.01) - on_the_way;
      return intrusion > 0.0 ? kForbidden * (1.0 + intrusion) : 0.0;
    };
    const BasePose& target = candidate.target;
    cost += price(footprint_clearance(base, *keep_out), footprint_clearance(target, *keep_out), p.clearance) +
            price(box_clearance(base, *keep_out), box_clearance(target, *keep_out), p.box);
  }
  if (cost < best_cost_) {
    best_cost_ = cost;
    state_ = candidate;
    predicted_time_ = p.time;
  }
}

void Navigator::set_target(const BasePose& base, const BasePose& target, const KeepOut* keep_out) noexcept {
  State fresh;
  fresh.last = state_.last;
  fresh.target = target;
  fresh.stage = Stage::Start;
  fresh.legs[0].goal = target;
  best_cost_ = std::numeric_limits<double>::infinity();
  predicted_time_ = 0.0;
  state_ = fresh;
  const bool usable = std::isfinite(base.x) && std::isfinite(base.y) && std::isfinite(base.yaw) && std::isfinite(target.x) &&
                      std::isfinite(target.y) && std::isfinite(target.yaw);
  if (!usable) {
    state_.stage = Stage::Idle;
    state_.last = {};
    return;
  }
  if (config_.law == "thesis") {  // one law from start to goal, no choice of route
    consider(fresh, base, keep_out);
    return;
  }
  for (const bool forward : {true, false}) {
    for (const bool turn_first : {false, true}) {
      fresh.legs[0] = {target, forward, turn_first};
      consider(fresh, base, keep_out);
    }
    fresh.legs[0] = straight(base, target, forward);
    consider(fresh, base, keep_out);
  }
  if (keep_out == nullptr || best_cost_ < kForbidden) return;
  consider_by_way(fresh, base, *keep_out);
}

// By way of a point in the free, or of one on the target's own line where the base can turn, so that it comes in straight.
void Navigator::consider_by_way(State fresh, const BasePose& base, const KeepOut& keep_out) noexcept {
  const BasePose target = fresh.target;
  fresh.leg_count = 2;
  const Vector2d offset = Vector2d(target.x, target.y) - keep_out.point;
  const Vector2d free =
      Vector2d(target.x, target.y) + std::max(0.0, kViaDistance - offset.dot(keep_out.normal)) * keep_out.normal;
  const BasePose via{free.x(), free.y(), target.yaw};
  for (const bool first : {true, false}) {
    fresh.legs[0] = straight(base, via, first);
    for (const bool second : {true, false}) {
      fresh.legs[1] = straight(via, target, second);
      consider(fresh, base, &keep_out);
      fresh.legs[1] = {target, second, true};
      consider(fresh, base, &keep_out);
    }
  }
  if (!keep_out.box) return;
  for (const double sense : {1.0, -1.0}) {
    const double way = way_to_turn(target, keep_out, sense);
    if (!std::isfinite(way)) continue;
    const BasePose turn = integrate_base(target, sense * way, 0.0, 1.0);
    fresh.legs[1] = {target, sense < 0.0, true};
    for (const bool first : {true, false}) {
      fresh.legs[0] = straight(base, turn, first);
      consider(fresh, base, &keep_out);
    }
  }
}

}  // namespace ajar
