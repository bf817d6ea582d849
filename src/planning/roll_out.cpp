#include "ajar/planning/roll_out.hpp"

#include <algorithm>
#include <cmath>

#include "ajar/core/so3.hpp"
#include "ajar/interaction/force_law.hpp"
#include "ajar/planning/believed_scene.hpp"
#include "ajar/planning/passage.hpp"

namespace ajar {

namespace {

// Indices of the believed obstacles, as the loop places them.
constexpr int kWall = 0;
constexpr int kLeaf = 1;
constexpr int kHingeWall = 2;
constexpr int kRevealSides[] = {2, 3};

// Values above this are all good: the damping of the controller starts at 0.08.
constexpr double kBestSigma = 0.12;
// Distances below which a roll-out loses value, and by how much per metre: 1 cm short costs a third of a good value.
// Past the edges of a doorway a posture needs this much: what the believed axis may be off, beyond the rows' 3 cm.
constexpr double kPassageArm = 0.045;
constexpr double kWantedBase = 0.05;
constexpr double kShortfallPrice = 4.0;
// Travel and tracking that count as complete.
constexpr double kWholeTravel = 0.99;
constexpr double kTrackingAllowance = 0.02;  // [m]
// Ten seconds of opening weigh as much as a third of a good value: time decides between postures that are alike.
constexpr double kTimePrice = 4e-3;  // [1/s]
// A flap may be out of reach for low handles: its value is squeezed so that it cannot rule alone.
constexpr double kSoftOffset = 0.06;
constexpr double kSoftShare = 0.5;

// The loop's own gating of base and speed by arc and lag (docs/equations.md#confidence, #speed-law).
constexpr double kStartSpeed = 0.02;  // [m/s]
constexpr double kArcBegin = 0.015;   // [m]
constexpr double kArcFull = 0.06;     // [m]
// The estimator knows type and leaf only after this arc [m].
constexpr double kKindArc = 0.10;
// Farther from the path than this the grasp would be lost [m].
constexpr double kLostError = 0.06;
// A standstill this long ends a roll-out [s].
constexpr double kStallTime = 1.5;
constexpr double kStallSpeed = 0.004;  // [m/s]
constexpr double kPathGain = 2.0;      // of the roll-out's path error, in place of the force law [1/s]
// A free grip is brought weakly to where it hinders least (as the loop does).
constexpr double kPivotCentring = 0.3;  // [1/s]

}  // namespace

/// State of one roll-out.
struct RollOut::Motion {
  BasePose base;
  JointVector q;
  Vector3d p0 = Vector3d::Zero();
  Matrix3d R0 = Matrix3d::Identity();
  double arc = 0.0;
  double speed = 0.0;     // wanted along the path [m/s]
  double measured = 0.0;  // reached along the path [m/s]
  double lag = 0.0;
  double confidence = 0.0;
};

double roll_out_value(const RollOutResult& result, bool soft) noexcept {
  const double shortfall = std::max(0.0, result.own_room - result.own) + std::max(0.0, result.arm_room - result.arm) +
                           std::max(0.0, kWantedBase - result.base);
  const double value = std::min(result.sigma, kBestSigma) - kShortfallPrice * shortfall +
                       std::min(0.0, result.fraction - kWholeTravel) - std::max(0.0, result.error - kTrackingAllowance) -
                       kTimePrice * result.duration;
  return soft ? kSoftOffset + kSoftShare * value : value;
}

RollOut::RollOut(const RobotModel& model, const PlannerConfig& config, const WbcConfig& wbc, const BaseLawConfig& base_law,
                 const ClearanceConfig& clearance)
    : model_(model),
      config_(config),
      wbc_(wbc),
      base_law_(base_law),
      controller_(model, wbc_, config.step),
      clearance_(model, clearance) {}

void RollOut::place_leaf(const HandleBelief& belief, const MechanismHypothesis& hypothesis, const HypothesisPoint& point,
                         double arc) {
  if (belief.press) {
    const double angle = belief.press->opened + arc * hypothesis.curvature.norm();
    clearance_.set_obstacle(kLeaf, leaf_pressed(belief, *belief.press, angle), MayTouch::Hand);
    return;
  }
  const Matrix3d R = exp_so3(point.turned) * leaf_axes(belief.normal);
  const Vector3d foot = belief.position + point.shift + belief.standoff * R.col(1);
  const double kappa = hypothesis.curvature.norm();
  Box leaf = leaf_behind_handle(R, foot);
  if ((arc > kKindArc || belief.passage) && kappa > 0.0) {
    const Vector3d centre = belief.position + hypothesis.curvature.cross(hypothesis.direction) / (kappa * kappa);
    leaf = leaf_from_axis(R, foot, centre, std::abs(hypothesis.curvature.z()) > 0.7 * kappa);
  }
  clearance_.set_obstacle(kLeaf, leaf, holding_hand(belief));
}

void RollOut::note_clearances(RollOutResult& result) const noexcept {
  result.own = std::min(result.own, clearances_.smallest[0]);
  result.arm = std::min(result.arm, clearances_.smallest[1]);
  result.base = std::min(result.base, clearances_.smallest[2]);
}

// A closed wall behind the handle; or the two sides of a doorway, with the leaf in it.
void RollOut::place_walls(const HandleBelief& belief) {
  if (!belief.passage) {
    clearance_.set_obstacle(kWall, believed_wall(belief), MayTouch::Hand);
    clearance_.clear_obstacle(kLeaf);
    if (belief.press) place_leaf(belief, MechanismHypothesis{}, HypothesisPoint{}, 0.0);
    for (const int side : kRevealSides) clearance_.clear_obstacle(side);  // a leaf that opens leaves them behind
    return;
  }
  const std::array<Box, 2> walls = passage_walls(*belief.passage);
  clearance_.set_obstacle(kWall, walls[0], MayTouch::Nothing);
  clearance_.set_obstacle(kHingeWall, walls[1], MayTouch::Nothing);
  place_leaf(belief, make_hypotheses(belief, config_).front(), HypothesisPoint{}, 0.0);
}

RollOutResult RollOut::look(const HandleBelief& belief, const BasePose& base, const JointVector& q) {
  RollOutResult result;
  place_walls(belief);
  if (const std::optional<std::array<Box, 2>> sides = reveal_walls(belief)) {
    for (std::size_t i = 0; i < 2; ++i) clearance_.set_obstacle(kRevealSides[i], (*sides)[i], MayTouch::Nothing);
  }
  model_.compute(base, q, kinematics_);
  clearance_.compute(model_, base, clearances_);
  note_clearances(result);
  result.sigma = arm_sigma_min(kinematics_, wbc_.length);
  return result;
}

double RollOut::hand_to_leaf(const HandleBelief& belief, const BasePose& base, const JointVector& q) {
  for (const int obstacle : {kWall, kHingeWall}) clearance_.clear_obstacle(obstacle);
  const Matrix3d R = leaf_axes(belief.normal);
  clearance_.set_obstacle(kLeaf, leaf_behind_handle(R, belief.position + belief.standoff * R.col(1)), MayTouch::Nothing);
  model_.compute(base, q, kinematics_);
  clearance_.compute(model_, base, clearances_);
  return clearances_.smallest[1];
}

BaseTwist RollOut::base_twist(BaseLaw& law, const MechanismHypothesis& hypothesis, Motion& motion, double dt) const {
  const HypothesisPoint point = point_at(hypothesis, motion.arc);
  motion.confidence = std::clamp((motion.arc - kArcBegin) / (kArcFull - kArcBegin), 0.0, 1.0);
  motion.speed = kStartSpeed + (config_.speed - kStartSpeed) * motion.confidence * waiting_share(motion.lag);
  const Vector3d curvature = motion.arc > kArcFull ? hypothesis.curvature : Vector3d(Vector3d::Zero());
  const BaseLawOutput out = law.step({.dt = dt,
                                      .base = motion.base,
                                      .hand = motion.p0 + point.shift,
                                      .direction = point.direction,
                                      .curvature = curvature,
                                      .wanted_speed = motion.speed,
                                      .measured_speed = motion.measured,
                                      .confidence = motion.confidence});
  motion.lag = out.lag;
  return out.twist;
}

// Position and rotation that are missing; about a free axis only a gentle turn is asked for.
Vector6d RollOut::pose_error(const MechanismHypothesis& hypothesis, const Motion& motion,
                             const HypothesisPoint& point) const {
  const Matrix3d& R = kinematics_.X_WE.linear();
  Vector6d error;
  error.head<3>() = motion.p0 + point.shift - kinematics_.X_WE.translation();
  error.tail<3>() = log_so3(exp_so3(point.turned) * motion.R0 * R.transpose());
  if (hypothesis.free_axis.squaredNorm() > 0.0) {
    const Vector3d axis = R * motion.R0.transpose() * hypothesis.free_axis;
    error.tail<3>() -= axis * axis.dot(error.tail<3>());
  }
  return error;
}

RollOut::Motion RollOut::begin(const HandleBelief& belief, const BasePose& base, const JointVector& q) {
  place_walls(belief);
  model_.compute(base, q, kinematics_);
  Motion motion;
  motion.base = base;
  motion.q = q;
  motion.p0 = kinematics_.X_WE.translation();
  motion.R0 = kinematics_.X_WE.linear();
  return motion;
}

void RollOut::pose_problem(const MechanismHypothesis& hypothesis, const Motion& motion, const HypothesisPoint& point,
                           WbcProblem& problem) const {
  problem.base_fixed = motion.confidence <= 0.0;
  problem.q = &motion.q;
  problem.tangential << motion.speed * point.direction, motion.speed * hypothesis.curvature;
  problem.leaf_velocity_at_hand = motion.speed * point.direction;
  problem.leaf_turn = motion.speed * hypothesis.curvature;
  if (hypothesis.free_axis.squaredNorm() == 0.0) return;
  const Matrix3d turned = kinematics_.X_WE.linear() * motion.R0.transpose();
  problem.free_axis = turned * hypothesis.free_axis;
  const double leaf_turn = hypothesis.hand_stays ? 0.0 : point.turned.dot(problem.free_axis);
  const double leaf_rate = hypothesis.hand_stays ? 0.0 : problem.tangential.tail<3>().dot(problem.free_axis);
  const double wanted = free_grip_turn(problem.free_axis, leaf_turn);
  problem.free_axis_rate = free_grip_share(problem.free_axis, leaf_turn) * leaf_rate +
                           kPivotCentring * (wanted - log_so3(turned).dot(problem.free_axis));
}

RollOutResult RollOut::run(const HandleBelief& belief, const MechanismHypothesis& hypothesis, const BasePose& base,
                           const JointVector& q, double enough) {
  const double dt = config_.step;
  const int n = model_.joints();
  RollOutResult result;
  result.fraction = 1.0;  // while it runs: nothing lost yet
  result.own_room = hypothesis.own_room;
  if (belief.passage) result.arm_room = kPassageArm;
  Motion motion = begin(belief, base, q);
  BaseLaw law(base_law_);
  law.reset(base, motion.p0, belief.passage ? std::optional(passage_line(*belief.passage)) : std::nullopt);
  controller_.reset();
  WbcSolution solution;
  WbcProblem problem;
  problem.leaf_obstacle = kLeaf;
  problem.keep_heading = belief.passage.has_value();
  problem.clearance = &clearances_;
  problem.kinematics = &kinematics_;
  double standing = 0.0;
  while (motion.arc < hypothesis.travel) {
    const HypothesisPoint point = point_at(hypothesis, motion.arc);
    model_.compute(motion.base, motion.q, kinematics_);
    place_leaf(belief, hypothesis, point, motion.arc);
    clearance_.compute(model_, motion.base, clearances_);
    note_clearances(result);
    const Vector6d error = pose_error(hypothesis, motion, point);
    result.error = std::max(result.error, error.head<3>().norm());
    problem.base = base_twist(law, hypothesis, motion, dt);
    problem.correction = kPathGain * error;
    pose_problem(hypothesis, motion, point, problem);
    const WbcStatus status = controller_.solve(problem, solution);
    result.sigma = std::min(result.sigma, solution.sigma_min);
    motion.measured = motion.speed * solution.speed_factor;
    standing = motion.measured < kStallSpeed ? standing + dt : 0.0;
    if (status == WbcStatus::Invalid || result.error > kLostError || standing > kStallTime) break;
    if (roll_out_value(result, hypothesis.soft) < enough) break;
    motion.q += dt * solution.u.head(n);
    motion.base = integrate_base(motion.base, solution.u[n + 1], solution.u[n], dt);
    motion.arc += motion.measured * dt;
    result.duration += dt;
  }
  result.fraction = std::min(1.0, motion.arc / hypothesis.travel);
  result.value = roll_out_value(result, hypothesis.soft);
  return result;
}

}  // namespace ajar
