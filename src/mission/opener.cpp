#include "ajar/mission/opener.hpp"

#include <algorithm>
#include <cmath>

#include "ajar/core/so3.hpp"
#include "ajar/estimation/direction_law.hpp"
#include "ajar/mission/follower.hpp"
#include "ajar/planning/hypotheses.hpp"
#include "ajar/planning/passage.hpp"

namespace ajar {
namespace {

// Base and speed come in while the direction becomes sure and the arm has covered the first centimetres itself.
// (#confidence)
constexpr double kUnsure = 0.25;     // direction sigma without any confidence [rad]
constexpr double kSure = 0.05;       // direction sigma with full confidence [rad]
constexpr double kArcBegin = 0.015;  // [m]
constexpr double kArcFull = 0.06;    // [m]
// Where an unknown end stop may come, the hand is slow: the blow grows with speed. (#speed-law)
constexpr double kStopPossibleAngle = 1.36;  // first end stops of hinged doors: 80 degrees, less 2 [rad]
constexpr double kStopPossibleArc = 0.25;    // shortest drawers: 0.3 m, less what the slow-down lags [m]
constexpr double kBlow = 34.0;               // what the stop's blow K v T may add [N]
constexpr double kStopForce = 44.0;          // together with the force that the motion needs anyway [N]
// Less is not left, and with more than that a stop is hard anyway: a hand that creeps only sticks against a closer.
constexpr double kLeastBlow = 15.0;       // [N]
constexpr double kBlowStiffness = 1.5e4;  // K: a stiff grasp [N/m]
constexpr double kArmReaction = 0.025;    // T without dead time: the force rises, the joints brake [s]
constexpr double kBareShare = 0.2;        // of speed and gains for fingers on a bare leaf: stiffer than a grasp by as much
constexpr double kFlapSpeed = 0.15;       // a flap: its weight and the base behind the hand are not stopped at once [m/s]
constexpr double kLeastCurvature = 0.2;   // a hinge of more than 5 m radius is driven as a slide [1/m]
constexpr double kPivotCentring = 0.3;    // weak turn of a hand about a free bar towards where it should be [1/s]
// Whether a bar turns in the fingers is tried on level axes along it. (#free-grip)
constexpr double kAlongBar = 0.9;    // cosine: an axis within 25 degrees of the bar
constexpr double kLevel = 0.7071;    // sine: a bar that lies rather than stands
constexpr double kHeldTorque = 2.0;  // pads on a bar slip below this; held fast, 100 N m/rad reach it within 1.2° [N m]
// The way is known well enough to judge the grasp by it.
constexpr double kKnownArc = 0.10;        // [m]
constexpr double kKnownDirection = 0.06;  // [rad]
constexpr double kKnownCurvature = 0.25;  // of the curvature, or of 1/m
// The way back: as fast as a hand that cannot be surprised, against half the pull that opening may use.
constexpr double kBackSpeed = 0.10;        // [m/s]
constexpr double kBackForce = 30.0;        // [N]
constexpr double kBackAtStart = 0.05;      // the rest of the way is as good as straight [m]
constexpr double kBackStillSpeed = 0.006;  // the closed stop is met a little before or behind [m/s]
constexpr double kBackStillTime = 1.5;     // [s]

constexpr double kProbedDoubt = 0.15;  // largest error of a probed direction: usual is 0.5°, seen were 7° [rad]

// Rotation vector of the leaf since the grasp, as the estimate has it now: errors of the first centimetres do not stay in
// it.
Vector3d leaf_turn(const MechanismEstimate& estimate) {
  const double kappa = estimate.curvature.norm();
  return kappa > 1e-6 ? Vector3d(estimate.angle / kappa * estimate.curvature) : Vector3d(Vector3d::Zero());
}

// Gains for fingers on a bare leaf.
ForceLawConfig bare(ForceLawConfig config) {
  config.total_stiffness /= kBareShare;
  config.gain_max *= kBareShare;
  config.give_gain *= kBareShare;
  return config;
}

}  // namespace

Opener::Opener(const RobotModel& model, const MissionConfig& config)
    : model_(model),
      config_(config),
      estimator_(config.estimator),
      force_law_(config.force, config.period, config.dead_time),
      speed_law_(config.force, config.period, config.dead_time),
      bare_force_law_(bare(config.force), config.period, config.dead_time),
      bare_speed_law_(bare(config.force), config.period, config.dead_time),
      base_law_(config.base_law),
      ends_(EndConfig{}, config.goal, config.limits.force),
      blow_rate_(1.0 / (kBlowStiffness * (config.period + config.dead_time + kArmReaction))) {
  if (config.controller == "thesis") thesis_.emplace(model, config.thesis, config.wbc, config.period);
}

void Opener::start(const RobotState& state, const Kinematics& kinematics, const HandleBelief& belief,
                   const Vector3d& direction, double force) noexcept {
  R_grasp_ = kinematics.X_WE.linear();
  bar_in_hand_ = R_grasp_.transpose() * belief.bar;
  base_law_.reset(state.base, kinematics.X_WE.translation(),
                  belief.passage ? std::optional(passage_line(*belief.passage)) : std::nullopt);
  straight_ = belief.passage.has_value();
  taken_at_ = kinematics.X_WE.translation();
  held_fast_ = false;
  felt_ = belief.felt.value_or(FeltMechanism{.direction = direction});
  opened_ = belief.passage ? belief.passage->opened : 0.0;
  press_.reset();
  HandleBelief held = belief;
  held.position = kinematics.X_WE.translation();
  scene_.reset(held);
  redirect(kinematics, direction, force);
  direction_doubt_ = 0.0;  // a guess: nothing is known of its error
}

void Opener::redirect(const Kinematics& kinematics, const Vector3d& direction, double force) noexcept {
  estimator_.reset(kinematics.X_WE, direction, felt_.curvature, felt_.bar_turns);
  force_law_.reset();
  speed_law_.reset();
  ends_.reset();
  if (thesis_) thesis_->reset();  // the robot stands
  base_lag_ = back_still_ = 0.0;
  direction_doubt_ = std::sin(kProbedDoubt);
  start_force_ = std::max(config_.force.start_force, force);
}

double Opener::confidence(const MechanismEstimate& estimate) const noexcept {
  if (!estimate.fitted) return 0.0;
  const double sure = std::clamp((kUnsure - estimate.direction_sigma) / (kUnsure - kSure), 0.0, 1.0);
  return sure * std::clamp((estimate.arc - kArcBegin) / (kArcFull - kArcBegin), 0.0, 1.0);
}

double Opener::speed_cap(const MechanismEstimate& estimate) const noexcept {
  const double kappa = estimate.curvature.norm();
  const bool hinge = estimate.type == MechanismType::Hinge && kappa > kLeastCurvature;
  const double left = hinge ? (kStopPossibleAngle - opened_ - estimate.angle) / kappa : kStopPossibleArc - estimate.arc;
  const double spare = kStopForce - kLeastBlow - speed_law().running_force();
  const double blow = std::min(kBlow, kLeastBlow + std::abs(spare));
  const double slow = (press_ ? kBareShare : 1.0) * std::max(config_.force.speed_start, blow_rate_ * blow);
  const double cap = std::sqrt(slow * slow + 2.0 * config_.force.deceleration * std::max(0.0, left));
  const double level = std::hypot(estimate.curvature.x(), estimate.curvature.y());
  return hinge && level > kLevel * kappa ? std::min(cap, kFlapSpeed) : cap;
}

double Opener::force_cap(const MechanismEstimate& estimate) const noexcept {
  const double sure = estimate.fitted ? std::clamp((kUnsure - estimate.direction_sigma) / (kUnsure - kSure), 0.0, 1.0) : 0.0;
  return start_force_ + sure * std::max(0.0, config_.force.force_limit - start_force_);
}

void Opener::solve(const WbcProblem& problem, WholeBodyController& controller, WbcSolution& out) noexcept {
  // The status travels in the solution.
  if (!thesis_) {
    (void)controller.solve(problem, out);
    return;
  }
  (void)thesis_->solve(problem, out);
  controller.reset(out.u);  // letting go brakes from here
}

double Opener::wanted_speed(const MechanismEstimate& estimate, const ForceCorrection& correction, double along,
                            double speed_cap) noexcept {
  return speed_law().step({.confidence = confidence(estimate),
                           .base_lag = base_lag_,
                           .pull_force = correction.pull_force,
                           .normal_force = correction.normal_force,
                           .measured_speed = along,
                           .speed_cap = speed_cap,
                           .force_cap = force_cap(estimate)});
}

BaseLawOutput Opener::drive(const PredictedState& robot, const MechanismEstimate& estimate, const Pose& hand, double along,
                            double speed) noexcept {
  // The base answers later than the arm: its law sees the hand where it will be by then.
  const Pose then = pose_on_path({estimate.direction, estimate.curvature, 0.0}, hand, along * robot.base_lead);
  const BaseLawOutput base = base_law_.step({.dt = config_.period,
                                             .base = robot.base_end,
                                             .hand = then.translation(),
                                             .direction = then.linear() * estimate.direction,
                                             .curvature = estimate.curvature,
                                             .wanted_speed = speed,
                                             .measured_speed = along,
                                             .confidence = confidence(estimate)});
  base_lag_ = thesis_ ? 0.0 : base.lag;  // the thesis's law follows no base pose: it is only compared with it
  return base;
}

bool Opener::bar_turns(const Vector3d& bar, const HandWrench& wrench) noexcept {
  const MechanismEstimate& estimate = estimator_.estimate();
  if (bar.squaredNorm() < 0.5) return false;
  if (!estimate.rigid_grasp) return true;
  const double along = std::abs(estimate.curvature.dot(bar));
  const bool flap = estimate.type == MechanismType::Hinge && along > kAlongBar * estimate.curvature.norm();
  if (!flap || std::abs(bar.z()) > kLevel) return false;
  held_fast_ = held_fast_ || std::abs(wrench.torque.dot(bar)) > kHeldTorque;
  return !held_fast_;
}

void Opener::pivot_about(const Vector3d& axis, double leaf_turn, const Vector3d& correcting_turn, const Matrix3d& R,
                         WbcProblem& problem) const noexcept {
  // A hand that presses keeps its direction.
  const double turn = press_ ? 0.0 : leaf_turn;
  const double rate = press_ ? 0.0 : problem.tangential.tail<3>().dot(axis);
  problem.free_axis = axis;
  problem.free_axis_rate = free_grip_share(axis, turn) * rate +
                           kPivotCentring * (free_grip_turn(axis, turn) - log_so3(R * R_grasp_.transpose()).dot(axis)) -
                           correcting_turn.dot(axis);
}

void Opener::learn(const RobotState& state, const Kinematics& kin, const HandWrench& wrench,
                   const ForceCorrection& correction, const Vector3d& velocity) noexcept {
  const double dt = config_.period;
  // A pull F that is off by δ shows F sin δ across the way, with the sign opposite to a constraint's force: only what
  // exceeds the doubt turns a direction that was probed (docs/equations.md#adaptive-law).
  const double doubt = estimator_.estimate().fitted ? 0.0 : direction_doubt_;
  const double told = unexplained_share(correction.pull_force, correction.normal_force, doubt);
  // The status says nothing that the estimate does not: it states itself how sure it is.
  (void)estimator_.update({.dt = dt,
                           .hand = kin.X_WE,
                           .velocity = velocity,
                           .force = wrench.force,
                           .normal_correction = told * correction.velocity,
                           .base_travel = std::abs(state.base_v) * dt});
}

// The whole body for a wanted hand speed along the way: base, believed scene, distance rows, hand twist.
void Opener::move(const Tick& tick, const MechanismEstimate& estimate, const ForceCorrection& correction,
                  double speed) noexcept {
  const PredictedState& robot = tick.ahead.robot;
  const Kinematics& kin = thesis_ ? tick.kin : tick.ahead.kinematics;
  const Matrix3d& R = kin.X_WE.linear();
  // The way where the hand will be: its direction turns until there.
  const double way = estimate.direction.dot(kin.X_WE.translation() - tick.kin.X_WE.translation());
  const Matrix3d turned_ahead = exp_so3(way * estimate.curvature);
  const Vector3d x = turned_ahead * estimate.direction;
  const Vector3d& k = estimate.curvature;
  const Vector3d bar = R * bar_in_hand_;
  const bool turns = press_ || bar_turns(bar, tick.wrench);
  const Vector3d turned = leaf_turn(estimate) + way * k;
  Pose hand = Pose::Identity();
  hand.translation() = kin.X_WE.translation();
  hand.linear() = turned_ahead;
  MissionRecord& record = tick.record;
  record.base = drive(robot, estimate, hand, estimate.direction.dot(hand_velocity(tick)), speed);

  // What is near.
  scene_.update(estimate, kin.X_WE.translation(), turns ? turned : log_so3(R * R_grasp_.transpose()));
  scene_.turn_flap(opened_ + estimate.angle);
  scene_.place(tick.clearance);

  WbcProblem problem;
  problem.kinematics = &kin;
  problem.q = thesis_ ? &tick.state.q : &robot.q;
  problem.base_motion = robot.base_motion;
  problem.tangential << speed * x, speed * k;
  problem.correction << -turned_ahead * correction.velocity, -correction.turn;
  if (turns) pivot_about(bar, turned.dot(bar), correction.turn, R, problem);
  problem.base = record.base.twist;
  problem.base_fixed = confidence(estimate) <= 0.0;
  problem.keep_heading = straight_;
  tick.clearance.compute(model_, robot.base, clearances_);
  problem.clearance = &clearances_;
  problem.leaf_velocity_at_hand = speed * x;
  problem.leaf_turn = speed * k;
  problem.leaf_obstacle = kLeafObstacle;
  solve(problem, tick.controller, record.solution);

  record.estimate = estimate;
  record.estimate.angle += opened_;
  record.wanted_speed = speed;
  record.reference = problem.tangential + problem.correction;
  record.clearance_min = *std::min_element(clearances_.smallest.begin(), clearances_.smallest.end());
}

Vector3d Opener::hand_velocity(const Tick& tick) noexcept {
  InputVector measured(tick.kin.J.cols());
  measured << tick.state.dq, tick.state.base_w, tick.state.base_v;
  return (tick.kin.J * measured).head<3>();
}

EndDetector::Verdict Opener::step(const Tick& tick) noexcept {
  const Vector3d velocity = hand_velocity(tick);
  // Torque is nulled about every axis: a grip that pivots shows its friction only, one falsely taken to pivot is saved by
  // it.
  const ForceCorrection correction = force_law().step(tick.wrench, estimator_.estimate().direction, Vector3d::Zero());
  learn(tick.state, tick.kin, tick.wrench, correction, velocity);
  const MechanismEstimate& estimate = estimator_.estimate();
  const double along = estimate.direction.dot(velocity);
  const double speed = wanted_speed(estimate, correction, along, speed_cap(estimate));
  move(tick, estimate, correction, speed);
  return ends_.step({.dt = config_.period,
                     .speed = along,
                     .wanted_speed = speed,
                     .pull_force = correction.pull_force,
                     .running_force = speed_law().running_force(),
                     .force_cap = force_cap(estimate),
                     .speed_factor = tick.record.solution.speed_factor,
                     .binding = tick.record.solution.binding},
                    tick.record.estimate);
}

MechanismEstimate Opener::estimate_at(const Vector3d& hand) const noexcept {
  MechanismEstimate out = estimator_.estimate();
  const double kappa = out.curvature.norm();
  if (out.type != MechanismType::Hinge || kappa < kLeastCurvature) {
    out.arc = out.direction.dot(hand - taken_at_);
    return out;
  }
  const Vector3d axis = out.curvature / kappa;
  const Vector3d centre = out.point + out.curvature.cross(out.direction) / (kappa * kappa);
  const auto arm = [&](const Vector3d& p) -> Vector3d { return p - centre - axis * axis.dot(p - centre); };
  const Vector3d from = arm(taken_at_);
  const Vector3d to = arm(hand);
  out.direction = axis.cross(to).normalized();
  out.angle = std::atan2(axis.dot(from.cross(to)), from.dot(to));
  out.arc = out.angle / kappa;
  return out;
}

std::optional<FeltMechanism> Opener::felt() const noexcept {
  const MechanismEstimate& estimate = estimator_.estimate();
  const double kappa = estimate.curvature.norm();
  const bool known = estimate.type != MechanismType::Unknown && estimate.arc > kKnownArc &&
                     estimate.direction_sigma < kKnownDirection &&
                     estimate.curvature_sigma < kKnownCurvature * std::max(1.0, kappa);
  if (!known || thesis_) return std::nullopt;
  const MechanismEstimate closed = estimate_at(taken_at_);
  const bool hinge = estimate.type == MechanismType::Hinge;
  if (hinge && kappa < config_.estimator.hinge_curvature) return std::nullopt;  // flatter than any: not yet learnt
  return FeltMechanism{.direction = closed.direction,
                       .curvature = hinge ? closed.curvature : Vector3d(Vector3d::Zero()),
                       .bar_turns = !estimate.rigid_grasp};
}

bool Opener::step_back(const Tick& tick) noexcept {
  const MechanismEstimate estimate = estimate_at(tick.kin.X_WE.translation());
  const ForceCorrection correction = force_law().step(tick.wrench, estimate.direction, Vector3d::Zero());
  const double strength = std::clamp((kBackForce + correction.pull_force) / (0.5 * kBackForce), 0.0, 1.0);
  move(tick, estimate, correction, -kBackSpeed * strength * waiting_share(base_lag_));
  const bool still = std::abs(estimate.direction.dot(hand_velocity(tick))) < kBackStillSpeed;
  back_still_ = still ? back_still_ + config_.period : 0.0;
  return estimate.arc < kBackAtStart || back_still_ > kBackStillTime;
}

}  // namespace ajar
