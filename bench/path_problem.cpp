#include "path_problem.hpp"

#include <cmath>
#include <numbers>

#include <nlohmann/json.hpp>

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"

namespace ajar::bench {
namespace {

// Secondary wishes: pull of the posture, the heading and the distance [1/s], distance wanted [m].
constexpr double kPosture = 0.5;
constexpr double kHeading = 1.0;
constexpr double kDistance = 0.5;
constexpr double kWanted = 0.75;
// cos²β + ε²: with the hand beside the base its driving cannot change the distance.
constexpr double kSideways = 0.05;

// Of the door, clockwise from above.
double angle(int step) { return -step * PathProblem::kPeriod * PathProblem::kSpeed / PathProblem::kRadius; }

std::vector<double> as_list(const Eigen::Ref<const Eigen::MatrixXd>& m) {
  std::vector<double> out;
  for (Eigen::Index i = 0; i < m.rows(); ++i)
    for (Eigen::Index j = 0; j < m.cols(); ++j) out.push_back(m(i, j));
  return out;
}

}  // namespace

PathProblem::PathProblem(Config config) : config_(std::move(config)), base_{-1.5, -1.15, std::numbers::pi / 6.0} {
  hand_.linear() << 0.0, 0.0, -1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 0.0;  // hand z along -x, away from the leaf's motion
  hand_.translation() = Vector3d(base_.x - 0.8, base_.y + 0.5, 1.0);
  q_.resize(6);
  q_ << 1.54, -1.957, 1.461, -1.073, -1.612, 0.0;
  if (!robot_.solve_ik(base_, hand_, q_, 1000)) throw Error("bench: no posture for the start of the path");
}

int PathProblem::steps() const { return static_cast<int>(0.5 * std::numbers::pi * kRadius / (kSpeed * kPeriod)); }

Pose PathProblem::target(int step) const {
  const Matrix3d turned = exp_so3({0.0, 0.0, angle(step)});
  const Vector3d hinge = hand_.translation() - Vector3d(0.0, kRadius, 0.0);
  Pose X = Pose::Identity();
  X.linear() = turned * hand_.linear();
  X.translation() = hinge + turned * (hand_.translation() - hinge);
  return X;
}

Vector6d PathProblem::path_twist(int step) const {
  Vector6d twist;
  twist << kSpeed * std::cos(angle(step)), kSpeed * std::sin(angle(step)), 0.0, 0.0, 0.0, -kSpeed / kRadius;
  return twist;
}

InputVector PathProblem::limits() const {
  InputVector limits = InputVector::Constant(8, config_.joint_rate);
  limits.tail<2>() << config_.yaw_rate, config_.speed;
  return limits;
}

InputVector PathProblem::wishes(int step, const BasePose& base, const JointVector& q) const {
  const double heading = angle(step);
  const Vector3d hand = target(step).translation();
  const Vector2d reach(hand.x() - base.x, hand.y() - base.y);
  const double distance = reach.norm();
  const double bearing = std::cos(std::atan2(reach.y(), reach.x()) - base.yaw);
  const double approach = reach.dot(Vector2d(std::cos(heading), std::sin(heading))) * kSpeed / distance;
  InputVector u(8);
  u.head<6>() = kPosture * (q_ - q);
  u[6] = -kSpeed / kRadius - kHeading * wrap_angle(base.yaw - heading);
  u[7] = (approach + kDistance * (distance - kWanted)) * bearing / (bearing * bearing + kSideways);
  return u;
}

std::string PathProblem::to_json() const {
  const nlohmann::json json = {{"name", config_.name},
                               {"urdf", robot_.urdf_path().string()},
                               {"joints", robot_.joint_names()},
                               {"hand_frame", robot_.hand_frame()},
                               {"start_base", {base_.x, base_.y, base_.yaw}},
                               {"start_q", as_list(q_)},
                               {"start_rotation", as_list(hand_.linear())},
                               {"start_position", as_list(hand_.translation())},
                               {"limits", as_list(limits())},
                               {"steps", steps()},
                               {"period", kPeriod},
                               {"radius", kRadius},
                               {"speed", kSpeed},
                               {"posture", kPosture},
                               {"heading", kHeading},
                               {"distance", kDistance},
                               {"wanted", kWanted},
                               {"sideways", kSideways}};
  return json.dump();
}

std::vector<PathProblem::Config> path_problems() {
  return {{"nominal limits", std::numbers::pi, 1.0, 0.8}, {"tight limits", 0.30, 0.20, 0.13}};
}

}  // namespace ajar::bench
