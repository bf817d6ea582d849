#pragma once

// A second, independent kinematics: UR5e by its Denavit-Hartenberg table on a unicycle, in plain trigonometry.
// Mount: 0.15, 0.05, 0.60 m, yaw 0.3 rad; tool centre point at the flange.

#include <array>
#include <cmath>
#include <numbers>

#include "ajar/model/robot_model.hpp"

namespace ajar::test {

inline Pose dh_step(double q, double a, double d, double alpha) {
  Pose T = Pose::Identity();
  T.linear() = (Eigen::AngleAxisd(q, Vector3d::UnitZ()) * Eigen::AngleAxisd(alpha, Vector3d::UnitX())).toRotationMatrix();
  T.translation() = Vector3d(a * std::cos(q), a * std::sin(q), d);
  return T;
}

inline Kinematics ur5e_kinematics(const BasePose& base, const JointVector& q) {
  constexpr double kHalfTurn = std::numbers::pi / 2.0;
  constexpr std::array<double, 6> a{0.0, -0.425, -0.3922, 0.0, 0.0, 0.0};
  constexpr std::array<double, 6> d{0.1625, 0.0, 0.0, 0.1333, 0.0997, 0.0996};
  constexpr std::array<double, 6> alpha{kHalfTurn, 0.0, 0.0, kHalfTurn, -kHalfTurn, 0.0};
  const Pose X_WB = to_pose(base);
  Pose T = X_WB * Eigen::Translation3d(0.15, 0.05, 0.60) * Eigen::AngleAxisd(0.3, Vector3d::UnitZ());
  std::array<Vector3d, 6> axis;
  std::array<Vector3d, 6> origin;
  for (size_t i = 0; i < 6; ++i) {
    axis[i] = T.linear().col(2);
    origin[i] = T.translation();
    T = T * dh_step(q[static_cast<int>(i)], a[i], d[i], alpha[i]);
  }
  Kinematics kinematics;
  kinematics.X_WE = T;
  const Vector3d p = T.translation();
  kinematics.J = HandJacobian::Zero(6, 8);
  for (int i = 0; i < 6; ++i) {
    const auto k = static_cast<size_t>(i);
    kinematics.J.col(i).head<3>() = axis[k].cross(p - origin[k]);
    kinematics.J.col(i).tail<3>() = axis[k];
  }
  kinematics.J.col(6) << -(p.y() - base.y), p.x() - base.x, 0.0, 0.0, 0.0, 1.0;
  kinematics.J.col(7).head<3>() = X_WB.linear().col(0);
  const Vector2d reach(p.x() - base.x, p.y() - base.y);
  kinematics.distance = reach.norm();
  kinematics.distance_jacobian = InputRow::Zero(1, 8);
  kinematics.distance_jacobian.head(6) = reach.transpose() / reach.norm() * kinematics.J.topLeftCorner(2, 6);
  return kinematics;
}

}  // namespace ajar::test
