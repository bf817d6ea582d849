#include "ajar/wbc/pseudo_inverse.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

namespace ajar {
namespace {

// Relative length below which a Jacobian row adds no new direction to the row space.
constexpr double kDependentRow = 1e-12;

}  // namespace

double squared_damping(double sigma_min, const Damping& damping) noexcept {
  if (sigma_min >= damping.onset) {
    return 0.0;
  }
  const double ratio = sigma_min / damping.onset;
  return damping.largest * damping.largest * (1.0 - ratio * ratio);
}

PseudoInverse damped_pseudo_inverse(const HandJacobian& J, const InputVector& weight, const Damping& damping) noexcept {
  PseudoInverse out;
  out.matrix = InverseJacobian::Zero(J.cols(), 6);
  if (!J.allFinite() || !weight.allFinite() || !(weight.minCoeff() > 0.0)) {
    return out;
  }
  Vector6d scale = Vector6d::Ones();
  scale.tail<3>().setConstant(damping.length);
  const InputVector root = weight.cwiseSqrt().cwiseInverse();
  const HandJacobian A = scale.asDiagonal() * J * root.asDiagonal();  // (6, n + 2)
  Eigen::Matrix<double, 6, 6> gram;
  gram.noalias() = A.lazyProduct(A.transpose());
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 6, 6>> eigen(gram);
  out.sigma_min = std::sqrt(std::max(eigen.eigenvalues()[0], 0.0));
  out.squared_damping = squared_damping(out.sigma_min, damping);
  // Directions without any authority stay at rest instead of dividing by zero.
  const double floor = 1e-12 * std::max(eigen.eigenvalues()[5], 1e-12);
  const Vector6d inverse = (eigen.eigenvalues().array() > floor)
                               .select((eigen.eigenvalues().array() + out.squared_damping).max(floor).inverse(), 0.0);
  const Eigen::Matrix<double, 6, 6> middle =
      eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose() * scale.asDiagonal();
  const InverseJacobian weighted = A.transpose().lazyProduct(middle);
  out.matrix = root.asDiagonal() * weighted;
  return out;
}

InputMatrix null_space_projector(const HandJacobian& J, const InputVector& weight) noexcept {
  const Eigen::Index m = J.cols();
  InputMatrix N = InputMatrix::Zero(m, m);
  if (!J.allFinite() || !weight.allFinite() || !(weight.minCoeff() > 0.0)) {
    return N;
  }
  const InputVector root = weight.cwiseSqrt();
  N.setIdentity();
  // Gram-Schmidt over the rows of J W^(-1/2), each cleaned twice: orthogonal to round-off.
  for (int row = 0; row < 6; ++row) {
    InputVector direction = J.row(row).transpose().cwiseQuotient(root);
    const double length = direction.norm();
    for (int pass = 0; pass < 2; ++pass) {
      const InputVector remaining = N.lazyProduct(direction);
      direction = remaining;
    }
    const double left = direction.norm();
    if (left > kDependentRow * std::max(length, kDependentRow)) {
      direction /= left;
      N -= direction.lazyProduct(direction.transpose());
    }
  }
  return root.cwiseInverse().asDiagonal() * N * root.asDiagonal();
}

}  // namespace ajar
