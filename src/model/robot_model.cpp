#include "ajar/model/robot_model.hpp"

#include <cassert>
#include <cmath>

#include "robot_impl.hpp"

namespace ajar {
namespace {

// Below this distance the direction from the axle to the hand is not defined; the row is then zero. [m]
constexpr double kLeastDistance = 1e-9;

bool all_finite(const BasePose& base, const JointVector& q) noexcept {
  return std::isfinite(base.x + base.y + base.yaw) && std::isfinite(q.sum());
}

void clear(Kinematics& out) noexcept {
  out.J.setZero();
  out.distance_jacobian.setZero();
  out.valid = false;
}

}  // namespace

RobotModel::RobotModel(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
RobotModel::RobotModel(const RobotModel& other) : impl_(std::make_unique<Impl>(*other.impl_)) {}
RobotModel& RobotModel::operator=(const RobotModel& other) {
  if (this != &other) {
    impl_ = std::make_unique<Impl>(*other.impl_);
  }
  return *this;
}
RobotModel::RobotModel(RobotModel&&) noexcept = default;
RobotModel& RobotModel::operator=(RobotModel&&) noexcept = default;
RobotModel::~RobotModel() = default;

RobotModel RobotModel::load(const std::filesystem::path& urdf, const std::filesystem::path& toml) {
  return RobotModel(std::make_unique<Impl>(assemble_robot(urdf, toml)));
}

const std::string& RobotModel::name() const noexcept { return impl_->parts.name; }
int RobotModel::joints() const noexcept { return static_cast<int>(impl_->parts.names.joints.size()); }
const std::vector<std::string>& RobotModel::joint_names() const noexcept { return impl_->parts.names.joints; }
BaseType RobotModel::base_type() const noexcept { return impl_->parts.base_type; }
double RobotModel::wheel_radius() const noexcept { return impl_->parts.wheel_radius; }
double RobotModel::wheel_track() const noexcept { return impl_->parts.wheel_track; }
const RobotLimits& RobotModel::limits() const noexcept { return impl_->parts.limits; }
const std::vector<CollisionShape>& RobotModel::shapes() const noexcept { return impl_->parts.shapes; }
const RobotDrawing& RobotModel::drawing() const noexcept { return impl_->parts.drawing; }
double RobotModel::tool_mass() const noexcept { return impl_->parts.tool_mass; }
const Vector3d& RobotModel::tool_com() const noexcept { return impl_->parts.tool_com; }
const JointVector& RobotModel::home() const noexcept { return impl_->parts.home; }
double RobotModel::gripper_stroke() const noexcept { return impl_->parts.gripper_stroke; }
const std::filesystem::path& RobotModel::urdf_path() const noexcept { return impl_->parts.urdf; }
const std::string& RobotModel::hand_frame() const noexcept { return impl_->parts.names.hand_frame; }
const std::string& RobotModel::sensor_frame() const noexcept { return impl_->parts.names.sensor_frame; }
const std::vector<std::array<int, 2>>& RobotModel::unchecked_pairs() const noexcept { return impl_->parts.unchecked_pairs; }

void RobotModel::compute(const BasePose& base, const JointVector& q, Kinematics& out) const noexcept {
  const Eigen::Index n = joints();
  assert(q.size() == n);
  out.J.resize(6, n + 2);
  out.distance_jacobian.resize(n + 2);
  if (q.size() != n || !all_finite(base, q)) {
    clear(out);
    impl_->evaluated = false;
    return;
  }
  impl_->chain.compute(q);
  impl_->evaluated = true;
  const Heading& heading = impl_->face(base.yaw);
  const Matrix3d R_WB = heading.matrix();
  const Vector3d p_WB(base.x, base.y, 0.0);
  const Pose& X_BE = impl_->chain.hand();
  const Pose& X_BF = impl_->chain.sensor();
  const Vector3d r_W = heading.turn(X_BE.translation());  // from the axle to the hand, world axes
  out.X_WE.linear().noalias() = R_WB * X_BE.linear();
  out.X_WE.translation() = p_WB + r_W;
  out.R_WF.noalias() = R_WB * X_BF.linear();
  out.p_WF = p_WB + heading.turn(X_BF.translation());

  const auto& J_B = impl_->chain.jacobian();
  for (Eigen::Index i = 0; i < n; ++i) {
    const Vector3d w_B = J_B.col(i).tail<3>();
    const Vector3d v_B = J_B.col(i).head<3>() + w_B.cross(X_BE.translation());
    out.J.col(i).head<3>() = heading.turn(v_B);
    out.J.col(i).tail<3>() = heading.turn(w_B);
  }
  if (base_type() == BaseType::Fixed) {
    out.J.rightCols<2>().setZero();
  } else {
    out.J.col(n) << -r_W.y(), r_W.x(), 0.0, 0.0, 0.0, 1.0;
    out.J.col(n + 1) << heading.c, heading.s, 0.0, 0.0, 0.0, 0.0;
  }

  out.distance = std::hypot(r_W.x(), r_W.y());
  out.distance_jacobian.setZero();
  if (out.distance > kLeastDistance) {
    const Eigen::RowVector2d towards_hand(r_W.x() / out.distance, r_W.y() / out.distance);
    out.distance_jacobian.head(n).noalias() =
        towards_hand * out.J.topLeftCorner(2, n);  // (1, n); base columns stay exactly zero
  }
  out.valid = true;
}

bool RobotModel::evaluated() const noexcept { return impl_->evaluated; }

Pose RobotModel::joint_pose(int joint, const BasePose& base) const noexcept {
  const Heading& heading = impl_->face(base.yaw);
  const Vector3d p_WB(base.x, base.y, 0.0);
  Pose X_WJ = Pose::Identity();
  if (joint < 0) {
    X_WJ.linear() = heading.matrix();
    X_WJ.translation() = p_WB;
    return X_WJ;
  }
  const Pose X_BJ = impl_->chain.joint(joint);
  X_WJ.linear().noalias() = heading.matrix() * X_BJ.linear();
  X_WJ.translation() = p_WB + heading.turn(X_BJ.translation());
  return X_WJ;
}

void RobotModel::point_jacobian(int joint, const Vector3d& p_W, const BasePose& base,
                                Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxInputs>& out) const noexcept {
  const Eigen::Index n = joints();
  out.setZero(3, n + 2);
  const Heading& heading = impl_->face(base.yaw);
  const Vector3d r_W = p_W - Vector3d(base.x, base.y, 0.0);
  const Vector3d p_B = heading.turn_back(r_W);
  const auto& J_B = impl_->chain.jacobian();
  for (Eigen::Index i = 0; i <= joint; ++i) {
    const Vector3d w_B = J_B.col(i).tail<3>();
    out.col(i) = heading.turn(J_B.col(i).head<3>() + w_B.cross(p_B));
  }
  if (base_type() == BaseType::Differential) {
    out.col(n) = Vector3d(-r_W.y(), r_W.x(), 0.0);
    out.col(n + 1) = Vector3d(heading.c, heading.s, 0.0);
  }
}

}  // namespace ajar
