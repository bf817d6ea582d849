#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "ajar/core/so3.hpp"
#include "ajar/model/robot_model.hpp"
#include "robot_impl.hpp"

namespace ajar {
namespace {

using Matrix6d = Eigen::Matrix<double, 6, 6>;

constexpr double kTolerance = 1e-5;   // Position [m] and rotation [rad], as promised
constexpr double kGoal = 1e-8;        // Newton goes on to here, it costs one or two more steps
constexpr double kLargestStep = 0.4;  // Of one joint per iteration; the linear model holds for about 25 degrees [rad or m]
constexpr double kDamping = 1e-4;     // λ², corresponds to a singular value of 0.01, far below any useful posture
constexpr int kPatience = 12;         // Iterations after which the error must have fallen ...
constexpr double kProgress = 0.5;     // ... to this part of its value, else the start leads nowhere

// One step of shifted inverse iteration for σ_min: how far it may fall in a tick (share and absolute), which Cholesky
// proves, and how far above that floor the result may lie.
constexpr double kFallRelative = 0.05;
constexpr double kFallAbsolute = 1e-3;
constexpr double kRiseRelative = 0.06;
constexpr double kRiseAbsolute = 2e-3;
// Keeps the product of a singular arm regular.
constexpr double kSingularShift = 1e-15;

bool inside(const RobotLimits& limits, const JointVector& q) {
  return (q.array() >= limits.position_lower.array()).all() && (q.array() <= limits.position_upper.array()).all();
}

// Turns wrapped to (-π, π], or by the whole turn that brings them inside their limits.
void wrap_turns(const RobotParts& parts, JointVector& q) {
  constexpr double kTurn = 2.0 * std::numbers::pi;
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (!parts.free_turning[static_cast<std::size_t>(i)]) {
      continue;
    }
    q[i] = wrap_angle(q[i]);
    if (q[i] < parts.limits.position_lower[i]) {
      q[i] += kTurn;
    } else if (q[i] > parts.limits.position_upper[i]) {
      q[i] -= kTurn;
    }
  }
}

// Joints with less than a turn of range stay inside it on the way.
void clamp_others(const RobotParts& parts, JointVector& q) {
  for (Eigen::Index i = 0; i < q.size(); ++i) {
    if (!parts.free_turning[static_cast<std::size_t>(i)]) {
      q[i] = std::clamp(q[i], parts.limits.position_lower[i], parts.limits.position_upper[i]);
    }
  }
}

Vector6d pose_error(const Pose& wanted, const Pose& is) {
  Vector6d e;
  e.head<3>() = wanted.translation() - is.translation();
  e.tail<3>() = log_so3(wanted.linear() * is.linear().transpose());
  return e;
}

bool reached(const Vector6d& e, double tolerance) {
  return e.head<3>().norm() < tolerance && e.tail<3>().norm() < tolerance;
}

}  // namespace

bool RobotModel::solve_ik(const BasePose& base, const Pose& X_WE, JointVector& q, int iterations) const {
  const Eigen::Index n = joints();
  if (q.size() != n || !q.allFinite() || !X_WE.matrix().allFinite()) {
    return false;
  }
  const RobotParts& parts = impl_->parts;
  JointVector trial = q;
  Kinematics k;
  Vector6d e = Vector6d::Ones();
  double error_before = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= iterations; ++i) {
    compute(base, trial, k);
    if (!k.valid) {
      return false;
    }
    e = pose_error(X_WE, k.X_WE);
    const double error = e.norm();
    if (reached(e, kGoal) || i == iterations) {
      break;
    }
    if (i % kPatience == 0) {
      if (error > kProgress * error_before) {
        break;
      }
      error_before = error;
    }
    const auto J = k.J.leftCols(n);  // (6, n)
    Matrix6d A = J * J.transpose();
    A.diagonal().array() += kDamping * std::min(1.0, error);  // fades with the error, so that the end is quadratic
    JointVector step = J.transpose() * A.ldlt().solve(e);
    const double largest = step.cwiseAbs().maxCoeff();
    if (largest > kLargestStep) {
      step *= kLargestStep / largest;
    }
    trial += step;
    clamp_others(parts, trial);
  }
  if (!reached(e, kTolerance)) {
    return false;
  }
  wrap_turns(parts, trial);
  if (!inside(parts.limits, trial)) {
    return false;
  }
  q = trial;
  return true;
}

namespace {

using GramFactor = Eigen::Matrix<double, 6, kMaxJoints>;

// S J_a with rotation rows scaled by L, or its transpose where the arm has fewer than six joints; the rest is zero.
GramFactor scaled_arm(const Kinematics& kinematics, double length, Eigen::Index n) {
  GramFactor A = GramFactor::Zero();
  Vector6d scale;
  scale << 1.0, 1.0, 1.0, length, length, length;
  if (n >= 6) {
    A.leftCols(n) = scale.asDiagonal() * kinematics.J.leftCols(n);
  } else {
    A.topLeftCorner(n, 6) = kinematics.J.leftCols(n).transpose() * scale.asDiagonal();
  }
  return A;
}

}  // namespace

double arm_sigma_min(const Kinematics& kinematics, double length) noexcept {
  SigmaTrack track;
  return arm_sigma_min(kinematics, length, track);
}

double arm_sigma_min(const Kinematics& kinematics, double length, SigmaTrack& track) noexcept {
  const Eigen::Index n = kinematics.J.cols() - 2;
  if (n < 1 || !std::isfinite(kinematics.J.sum())) {
    track = {};
    return 0.0;
  }
  const GramFactor A = scaled_arm(kinematics, length, n);
  Matrix6d product = Matrix6d::Zero();  // lower triangle
  product.triangularView<Eigen::Lower>() = A.lazyProduct(A.transpose());
  if (n < 6) {
    product.diagonal().tail(6 - n).setConstant(product.trace() + 1.0);  // rows that do not exist
  }
  if (track.direction.squaredNorm() > 0.5) {
    const double floor = std::max(0.0, (1.0 - kFallRelative) * std::sqrt(track.square) - kFallAbsolute);
    Matrix6d shifted = product;
    shifted.diagonal().array() -= floor * floor - kSingularShift * product.trace();
    const Eigen::LLT<Matrix6d> factor(shifted);
    const Vector6d v = factor.solve(track.direction).normalized();
    const double square = (A.transpose() * v).squaredNorm();
    const double sigma = std::sqrt(square);
    if (factor.info() == Eigen::Success && sigma - floor <= kRiseRelative * sigma + kRiseAbsolute) {
      track = {v, square};
      return sigma;
    }
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(product);
  track.direction = solver.eigenvectors().col(0);
  track.square = std::max(0.0, solver.eigenvalues()[0]);
  return std::sqrt(track.square);
}

}  // namespace ajar
