#include "posture_finder.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <numbers>

#include "ajar/core/so3.hpp"
#include "ajar/planning/hypotheses.hpp"
#include "ajar/planning/passage.hpp"

namespace ajar {

namespace {

constexpr double kPi = std::numbers::pi;
// Room that a joint keeps at the grasp: 90 degrees of opening turn the wrist less than this plus what the other joints take.
constexpr double kLimitRoom = 0.24;  // [rad]
// Newton steps of a start that converges; others do not get better with more.
constexpr int kIterations = 25;
// Same branch if all joints agree this well [rad].
constexpr double kSamePosture = 0.1;
// On the straight way to the handle: checked points, largest joint motion between them, distance kept.
constexpr int kApproachPoints = 4;
constexpr double kApproachJump = 0.5;        // [rad] for 2.5 cm
constexpr double kApproachClearance = 0.02;  // the rows' stop distance [m]
// Between open fingers and leaf where the hand comes askew: more than what the handle is misplaced by sight [m].
constexpr double kFingerRoom = 0.005;
// A hand that presses down leans by these about the axis of the flap; positive: from the robot to the flap's foot [rad].
constexpr std::array kPressLeans = {0.0, 0.3, -0.3};

template <typename... Values>
std::string text(const char* format, Values... values) {
  std::array<char, 160> buffer{};
  std::snprintf(buffer.data(), buffer.size(), format, values...);
  return buffer.data();
}

}  // namespace

// Hand z into the leaf; fingers close along hand y, so the bar lies along hand x. A knob has no bar: x is up.
Matrix3d grasp_orientation(const HandleBelief& belief, bool flip) {
  const Vector3d z = -belief.normal.normalized();
  Vector3d x = belief.bar.norm() > 0.5 ? belief.bar : Vector3d(Vector3d::UnitZ());
  x -= z * z.dot(x);
  x = x.norm() > 1e-6 ? Vector3d(x.normalized()) : any_perpendicular(z).normalized();
  Matrix3d R;
  R.col(0) = flip ? Vector3d(-x) : x;
  R.col(1) = z.cross(R.col(0));
  R.col(2) = z;
  return R;
}

// Fingers down on the inner face of a flap, side by side along its axis, leaning a little to or fro.
static std::vector<Matrix3d> pressing_orientations(const FlapPress& press) {
  std::vector<Matrix3d> out;
  const Vector3d axis = press.way.curvature.normalized();
  for (const double lean : kPressLeans) {
    for (const double sign : {1.0, -1.0}) {
      Matrix3d R;
      R.col(2) = -(exp_so3(lean * axis) * Vector3d::UnitZ());
      R.col(1) = sign * axis;
      R.col(0) = R.col(1).cross(R.col(2));
      out.push_back(R);
    }
  }
  return out;
}

std::vector<Matrix3d> hand_orientations(const HandleBelief& belief, const PlannerConfig& config) {
  if (belief.press) return pressing_orientations(*belief.press);
  std::vector<Matrix3d> out{grasp_orientation(belief, false), grasp_orientation(belief, true)};
  if (belief.bar.norm() < 0.5) {
    for (const double roll : {0.25 * kPi, 0.5 * kPi, 0.75 * kPi}) {
      const Matrix3d R = Eigen::AngleAxisd(roll, Vector3d::UnitZ()).toRotationMatrix();
      out.push_back(grasp_orientation(belief, false) * R);
      out.push_back(grasp_orientation(belief, true) * R);
    }
  }
  if (!belief.passage) return out;
  std::vector<Matrix3d> turned;
  for (const double yaw : config.passage_yaws) {
    for (const Matrix3d& R : out) turned.push_back(turned_to_hinge(R, *belief.passage, yaw));
  }
  return turned;
}

Vector3d hand_place(const HandleBelief& belief) {
  return belief.press ? press_point(belief, *belief.press, belief.press->opened) : belief.position;
}

Pose hand_at(const HandleBelief& belief, const Matrix3d& R) {
  Pose hand = Pose::Identity();
  hand.linear() = R;
  hand.translation() = hand_place(belief);
  return hand;
}

bool same_posture(const JointVector& a, const JointVector& b) noexcept {
  for (Eigen::Index i = 0; i < a.size(); ++i) {
    if (std::abs(wrap_angle(a[i] - b[i])) > kSamePosture) return false;
  }
  return true;
}

JointVector PostureFinder::unwind(const JointVector& q) const {
  const RobotLimits& limits = model_.limits();
  JointVector out = q;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const bool turns = limits.position_upper[i] - limits.position_lower[i] > 2.0 * kPi - 0.1;
    if (turns) out[i] = wrap_angle(q[i]);
  }
  return out;
}

bool PostureFinder::inside_limits(const JointVector& q) const {
  const RobotLimits& limits = model_.limits();
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    const double room = std::min(kLimitRoom, 0.1 * (limits.position_upper[i] - limits.position_lower[i]));
    if (q[i] < limits.position_lower[i] + room || q[i] > limits.position_upper[i] - room) return false;
  }
  return true;
}

std::optional<JointVector> PostureFinder::reach(const BasePose& base, const Pose& hand, Random& random,
                                                PostureTally& tally) const {
  const RobotLimits& limits = model_.limits();
  JointVector q(model_.joints());
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    q[i] = random.uniform(std::max(-kPi, limits.position_lower[i]), std::min(kPi, limits.position_upper[i]));
  }
  ++tally.starts;
  if (!model_.solve_ik(base, hand, q, kIterations)) return std::nullopt;
  return unwind(q);
}

bool PostureFinder::usable(const HandleBelief& belief, const BasePose& base, const JointVector& q,
                           const PostureLimits& limits, PostureTally& tally) const {
  ++tally.reached;
  if (!inside_limits(q)) return false;
  ++tally.inside_limits;
  const RollOutResult at = roll_out_.look(belief, base, q);
  tally.best_sigma = std::max(tally.best_sigma, at.sigma);
  if (at.sigma < limits.sigma) return false;
  ++tally.regular;
  tally.best_own = std::max(tally.best_own, at.own);
  if (at.own < limits.own) return false;
  ++tally.clear_of_self;
  tally.best_wall = std::max(tally.best_wall, at.arm);
  if (at.arm < limits.wall) return false;
  if (belief.passage && roll_out_.hand_to_leaf(belief, base, q) < kFingerRoom) return false;
  ++tally.clear_of_wall;
  return true;
}

std::optional<JointVector> PostureFinder::approach(const HandleBelief& belief, const Posture& grasp) const {
  JointVector q = grasp.q;
  for (int i = 1; i <= kApproachPoints; ++i) {
    Pose hand = grasp.hand;
    hand.translation() -= (config_.approach_distance * i / kApproachPoints) * hand.linear().col(2);
    const JointVector before = q;
    if (!model_.solve_ik(grasp.base, hand, q, kIterations) || !inside_limits(q)) return std::nullopt;
    if ((q - before).cwiseAbs().maxCoeff() > kApproachJump) return std::nullopt;
    const RollOutResult at = roll_out_.look(belief, grasp.base, q);
    if (at.own < kApproachClearance || at.arm < kApproachClearance) return std::nullopt;
  }
  return q;
}

std::string explain(const PostureTally& tally, const HandleBelief& belief, const PostureLimits& limits) {
  const double z = belief.position.z();
  if (tally.reached == 0) return text("no base pose reaches a handle at %.2f m height", z);
  if (tally.inside_limits == 0) return text("every posture that reaches the handle at %.2f m is at a joint limit", z);
  if (tally.regular == 0) {
    return text("every posture that reaches the handle at %.2f m is near singular: sigma %.3f, needed %.3f", z,
                tally.best_sigma, limits.sigma);
  }
  if (tally.clear_of_self == 0) {
    return text("every posture that reaches the handle at %.2f m comes within %.3f m of the robot's own body, needed %.3f",
                z, std::max(0.0, tally.best_own), limits.own);
  }
  if (tally.clear_of_wall == 0 && belief.doorway && reveal_depth(belief) > 0.0) {
    const Vector3d left = belief.doorway->left - belief.position;
    const Vector3d right = belief.doorway->right - belief.position;
    const double beside = std::min(left.head<2>().norm(), right.head<2>().norm());
    return text("the hand does not fit between the handle at %.2f m height and the edge of the frame %.3f m from it", z,
                beside);
  }
  if (tally.clear_of_wall == 0) {
    return text("every posture that reaches the handle at %.2f m comes within %.3f m of the wall, needed %.3f", z,
                std::max(0.0, tally.best_wall), limits.wall);
  }
  return text("no posture at %.2f m can come straight to the handle", z);
}

}  // namespace ajar
