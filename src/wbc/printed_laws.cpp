#include "ajar/wbc/printed_laws.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "ajar/core/so3.hpp"

namespace ajar {

HandJacobian printed_arm_jacobian(const HandJacobian& J_A, const Pose& X_WA) {
  const Matrix3d R = X_WA.linear();
  HandJacobian J(6, J_A.cols());
  J.bottomRows<3>() = R * J_A.bottomRows<3>();
  J.topRows<3>() = hat(X_WA.translation()) * J_A.bottomRows<3>() + R * J_A.topRows<3>();
  return J;
}

HandJacobian printed_base_column(HandJacobian J) noexcept {
  J.col(J.cols() - 2).head<3>().setZero();
  return J;
}

double printed_damping(const HandJacobian& J, double largest, double epsilon) noexcept {
  const Eigen::Matrix<double, 6, 6> gram = J.lazyProduct(J.transpose());
  return largest / (std::sqrt(std::max(gram.determinant(), 0.0)) + epsilon);
}

InverseJacobian ridge_inverse(const HandJacobian& J, const InputVector& weight, double lambda) noexcept {
  if (!J.allFinite() || !weight.allFinite() || !(weight.minCoeff() > 0.0) || !(lambda > 0.0)) {
    return InverseJacobian::Zero(J.cols(), 6);
  }
  const InverseJacobian weighted = weight.cwiseInverse().asDiagonal() * J.transpose();
  Eigen::Matrix<double, 6, 6> gram = J.lazyProduct(weighted);
  gram.diagonal().array() += lambda;
  const Eigen::Matrix<double, 6, 6> inverse = gram.llt().solve(Eigen::Matrix<double, 6, 6>::Identity());
  return weighted.lazyProduct(inverse);
}

InputMatrix printed_projector(const HandJacobian& J, const InverseJacobian& inverse) noexcept {
  InputMatrix N = InputMatrix::Identity(J.cols(), J.cols());
  N -= inverse.lazyProduct(J);
  return N;
}

double printed_heading_error(double yaw, const Vector6d& twist) noexcept {
  const double planar = twist.head<2>().norm();
  if (!(planar > 0.0)) return 0.0;
  return std::acos(std::clamp((std::cos(yaw) * twist[0] + std::sin(yaw) * twist[1]) / planar, -1.0, 1.0));
}

}  // namespace ajar
