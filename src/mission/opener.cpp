#include "ajar/mission/opener.hpp"

#include <algorithm>
#include <cmath>

#include "ajar/core/so3.hpp"
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
constexpr double kBlowStiffness = 1.5e4;     // K: a stiff grasp [N/m]
constexpr double kArmReaction = 0.025;       // T without dead time: the force rises, the joints brake [s]
constexpr double kLeastCurvature = 0.2;      // a hinge of more than 5 m radius is driven as a slide [1/m]
// A flap's hand must not follow the leaf all the way round: it would end up under the bar.
constexpr double kFlapTurn = 0.6;       // [rad]
constexpr double kPivotCentring = 0.3;  // weak turn of a hand about a free bar towards where it should be [1/s]

// Rotation vector of the leaf since the grasp, as the estimate has it now: errors of the first centimetres do not stay in
// it.
Vector3d leaf_turn(const MechanismEstimate& estimate) {
  const double kappa = estimate.curvature.norm();
  return kappa > 1e-6 ? Vector3d(estimate.angle / kappa * estimate.curvature) : Vector3d(Vector3d::Zero());
}

}  // namespace

Opener::Opener(const RobotModel& model, const MissionConfig& config)
    : model_(model),
      config_(config),
      estimator_(config.estimator),
      force_law_(config.force, config.period, config.dead_time),
      speed_law_(config.force, config.period, config.dead_time),
      base_law_(config.base_law),
      ends_(EndConfig{}, config.goal, config.limits.force),
      slow_speed_(
          std::max(config.force.speed_start, kBlow / (kBlowStiffness * (config.period + config.dead_time + kArmReaction)))) {
  if (config.controller == "thesis") thesis_.emplace(model, config.thesis, config.wbc, config.period);
}

void Opener::start(const RobotState& state, const Kinematics& kinematics, const HandleBelief& belief,
                   const Vector3d& direction, double force) noexcept {
  R_grasp_ = kinematics.X_WE.linear();
  bar_in_hand_ = R_grasp_.transpose() * belief.bar;
  base_law_.reset(state.base, kinematics.X_WE.translation(),
                  belief.passage ? std::optional(passage_line(*belief.passage)) : std::nullopt);
  straight_ = belief.passage.has_value();
  opened_ = belief.passage ? belief.passage->opened : 0.0;
  HandleBelief held = belief;
  held.position = kinematics.X_WE.translation();
  scene_.reset(held);
  redirect(kinematics, direction, force);
}

void Opener::redirect(const Kinematics& kinematics, const Vector3d& direction, double force) noexcept {
  estimator_.reset(kinematics.X_WE, direction);
  force_law_.reset();
  speed_law_.reset();
  ends_.reset();
  if (thesis_) thesis_->reset();  // the robot stands
  base_lag_ = 0.0;
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
  return std::sqrt(slow_speed_ * slow_speed_ + 2.0 * config_.force.deceleration * std::max(0.0, left));
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

double Opener::drive(const RobotState& state, const Kinematics& kin, const ForceCorrection& correction, double along,
                     BaseLawOutput& base) noexcept {
  const MechanismEstimate& estimate = estimator_.estimate();
  const double sure = confidence(estimate);
  const double speed = speed_law_.step({.confidence = sure,
                                        .base_lag = base_lag_,
                                        .pull_force = correction.pull_force,
                                        .normal_force = correction.normal_force,
                                        .measured_speed = along,
                                        .speed_cap = speed_cap(estimate),
                                        .force_cap = force_cap(estimate)});
  base = base_law_.step({.dt = config_.period,
                         .base = state.base,
                         .hand = kin.X_WE.translation(),
                         .direction = estimate.direction,
                         .curvature = estimate.curvature,
                         .wanted_speed = speed,
                         .measured_speed = along,
                         .confidence = sure});
  base_lag_ = thesis_ ? 0.0 : base.lag;  // the thesis's law follows no base pose: it is only compared with it
  return speed;
}

void Opener::pivot_about(const Vector3d& axis, double leaf_turn, const Vector3d& correcting_turn, const Matrix3d& R,
                         WbcProblem& problem) const noexcept {
  const bool upright = std::abs(axis.z()) > 0.7;
  const double wanted = upright ? leaf_turn : std::clamp(-0.5 * leaf_turn, -kFlapTurn, kFlapTurn);
  problem.free_axis = axis;
  problem.free_axis_rate =
      kPivotCentring * (wanted - log_so3(R * R_grasp_.transpose()).dot(axis)) - correcting_turn.dot(axis);
}

void Opener::learn(const RobotState& state, const Kinematics& kin, const HandWrench& wrench,
                   const ForceCorrection& correction, const Vector3d& velocity) noexcept {
  const double dt = config_.period;
  // The status says nothing that the estimate does not: it states itself how sure it is.
  (void)estimator_.update({.dt = dt,
                           .hand = kin.X_WE,
                           .velocity = velocity,
                           .force = wrench.force,
                           .normal_correction = correction.velocity,
                           .base_travel = std::abs(state.base_v) * dt});
}

EndDetector::Verdict Opener::step(const RobotState& state, const Kinematics& kin, const HandWrench& wrench,
                                  WholeBodyController& controller, ClearanceChecker& clearance,
                                  MissionRecord& record) noexcept {
  const double dt = config_.period;
  InputVector measured(kin.J.cols());
  measured << state.dq, state.base_w, state.base_v;
  const Vector6d V = kin.J * measured;
  const Matrix3d& R = kin.X_WE.linear();

  // Feel and learn.
  const bool pivots = !estimator_.estimate().rigid_grasp && bar_in_hand_.squaredNorm() > 0.5;
  const Vector3d free_axis = pivots ? Vector3d(R * bar_in_hand_) : Vector3d(Vector3d::Zero());
  // Torque is nulled about every axis: a grip that pivots shows its friction only, one falsely taken to pivot is saved by
  // it.
  const ForceCorrection correction = force_law_.step(wrench, estimator_.estimate().direction, Vector3d::Zero());
  learn(state, kin, wrench, correction, V.head<3>());
  const MechanismEstimate& estimate = estimator_.estimate();
  const Vector3d& x = estimate.direction;
  const Vector3d& k = estimate.curvature;
  const double along = x.dot(V.head<3>());
  const Vector3d turned = leaf_turn(estimate);

  // How fast, and where the base should be.
  const double sure = confidence(estimate);
  const double speed = drive(state, kin, correction, along, record.base);

  // What is near.
  scene_.update(estimate, kin.X_WE.translation(), pivots ? turned : log_so3(R * R_grasp_.transpose()));
  scene_.place(clearance);

  // The whole body.
  WbcProblem problem;
  problem.kinematics = &kin;
  problem.q = &state.q;
  problem.measured = measured;
  problem.tangential << speed * x, speed * k;
  problem.correction << -correction.velocity, -correction.turn;
  if (pivots) pivot_about(free_axis, turned.dot(free_axis), correction.turn, R, problem);
  problem.base = record.base.twist;
  problem.base_fixed = sure <= 0.0;
  problem.keep_heading = straight_;
  clearance.compute(model_, state.base, clearances_);
  problem.clearance = &clearances_;
  problem.leaf_velocity_at_hand = speed * x;
  problem.leaf_turn = speed * k;
  problem.leaf_obstacle = kLeafObstacle;
  solve(problem, controller, record.solution);

  record.estimate = estimate;
  record.estimate.angle += opened_;
  record.wanted_speed = speed;
  record.reference = problem.tangential + problem.correction;
  record.clearance_min = *std::min_element(clearances_.smallest.begin(), clearances_.smallest.end());
  return ends_.step({.dt = dt,
                     .speed = along,
                     .wanted_speed = speed,
                     .pull_force = correction.pull_force,
                     .running_force = speed_law_.running_force(),
                     .force_cap = force_cap(estimate),
                     .speed_factor = record.solution.speed_factor,
                     .binding = record.solution.binding},
                    record.estimate);
}

}  // namespace ajar
