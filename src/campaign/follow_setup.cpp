#include "follow_setup.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ajar/core/error.hpp"
#include "ajar/model/clearance.hpp"
#include "ajar/planning/grasp_planner.hpp"

namespace ajar {
namespace {

/// Farther than any arm and any drive of an experiment [m].
constexpr double kOutOfTheWay = 100.0;
// The stated posture is turned about its first joint in steps of 15°.
constexpr int kTurnedPostures = 24;
constexpr double kGoodSigma = 0.10;     // a little more than a grasp must have [-]
constexpr double kGoodDistance = 0.03;  // [m]
constexpr double kPlenty = 2.0;

/// Fingers across the bar, hand x against the bar: the orientation of the thesis's experiments.
Matrix3d hand_orientation(const Handle& handle) {
  HandleBelief belief;
  belief.position = handle.position;
  belief.normal = handle.normal;
  belief.bar = handle.bar;
  const Matrix3d R = grasp_orientation(belief, false);
  return R.col(0).dot(handle.bar) > 0.0 ? grasp_orientation(belief, true) : R;
}

/// Room to singularities and to the robot itself, each counted up to what is plenty; 2 = nothing to wish for.
double posture_value(const RobotModel& model, ClearanceChecker& clearance, const BasePose& base, const JointVector& q) {
  Kinematics kinematics;
  model.compute(base, q, kinematics);
  ClearanceResult distances;
  clearance.compute(model, base, distances);
  const double own = distances.smallest[static_cast<std::size_t>(ClearanceKind::Self)];
  return std::min(arm_sigma_min(kinematics) / kGoodSigma, 1.0) + std::min(own / kGoodDistance, 1.0);
}

/// Brings the hand to the handle, starting from the stated posture turned about its first joint, the smallest turns first:
/// the first posture with plenty of room, or the best one.
bool find_posture(const RobotModel& model, const ClearanceConfig& limits, const BasePose& base, const Pose& hand,
                  JointVector& q) {
  ClearanceChecker clearance(model, limits);
  const JointVector stated = q;
  double best = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < kTurnedPostures && best < kPlenty; ++i) {
    JointVector trial = stated;
    const int steps = (i % 2 == 0 ? -1 : 1) * ((i + 1) / 2);
    trial[0] += steps * 2.0 * M_PI / kTurnedPostures;
    if (!model.solve_ik(base, hand, trial)) continue;
    const double value = posture_value(model, clearance, base, trial);
    if (value <= best) continue;
    best = value;
    q = trial;
  }
  return std::isfinite(best);
}

}  // namespace

FollowSetup make_follow_setup(const Scenario& scenario, const RobotModel& model, const Mechanism& mechanism) {
  const FollowConfig& follow = scenario.mission.follow;
  const HandleMotion motion = handle_motion(mechanism, 0.0);
  const bool hinge = mechanism.kind == JointKind::Hinge;
  const GoalConfig& goal = scenario.mission.goal;
  Pose hand = Pose::Identity();
  hand.linear() = hand_orientation(mechanism.handle);
  hand.translation() = mechanism.handle.position;
  FollowSetup out;
  out.path.direction = hand.linear().transpose() * motion.direction;
  out.path.curvature = hand.linear().transpose() * motion.curvature;
  out.path.length =
      std::min(hinge ? goal.opening_angle : goal.opening_length, mechanism.travel) * (hinge ? motion.radius : 1.0);
  if (static_cast<int>(follow.posture.size()) != model.joints()) {
    throw ConfigError(fmt::format("{}: follow.posture: {} numbers: allowed: {}, one per joint of {}", scenario.file.string(),
                                  follow.posture.size(), model.joints(), model.name()));
  }
  out.posture = Eigen::Map<const Eigen::VectorXd>(follow.posture.data(), model.joints());
  const BasePose parking{follow.parking.x(), follow.parking.y(), follow.parking_yaw};
  if (!find_posture(model, scenario.mission.clearance, parking, hand, out.posture)) {
    throw ConfigError(fmt::format("{}: follow.parking_m = [{}, {}]: the arm does not reach the handle from there",
                                  scenario.file.string(), parking.x, parking.y));
  }
  return out;
}

Mechanism out_of_the_way(Mechanism mechanism) {
  const Vector3d away(0.0, kOutOfTheWay, 0.0);
  mechanism.point += away;
  mechanism.com += away;
  mechanism.handle.position += away;
  for (Box& box : mechanism.leaf) box.pose.pretranslate(away);
  mechanism.world.clear();
  return mechanism;
}

FollowedPath::FollowedPath(const HandPath& path, const Mechanism& mechanism)
    : path_(path), hinge_(mechanism.kind == JointKind::Hinge) {
  const HandleMotion closed = handle_motion(mechanism, 0.0);
  seen_.handle = closed.position;
  seen_.direction = closed.direction;
  seen_.curvature = closed.curvature;
}

const Truth& FollowedPath::see(const Truth& truth, Phase phase) noexcept {
  const Truth before = seen_;
  seen_ = truth;
  seen_.handle = before.handle;
  seen_.direction = before.direction;
  seen_.curvature = before.curvature;
  seen_.opening = before.opening;
  seen_.opening_rate = 0.0;
  if (phase != Phase::Open && !begun_) return seen_;
  if (!begun_) start_ = truth.hand;
  begun_ = true;
  const Matrix3d& R = start_.linear();
  const Vector3d x = R * path_.direction;
  const Vector3d k = R * path_.curvature;
  const Vector3d way = truth.hand.translation() - start_.translation();
  const double kappa = k.norm();
  double arc = x.dot(way);
  if (kappa > 0.0) {
    // Angle about the centre c = p0 + (k × x)/κ², from the radius at the start.
    const Vector3d inward = k.cross(x) / kappa;
    arc = std::atan2(x.dot(way), 1.0 / kappa - inward.dot(way)) / kappa;
  }
  const Pose near = pose_on_path(path_, start_, arc);
  seen_.handle = near.translation();
  seen_.direction = near.linear() * path_.direction;
  seen_.curvature = near.linear() * path_.curvature;
  seen_.opening = hinge_ ? arc * kappa : arc;
  return seen_;
}

}  // namespace ajar
