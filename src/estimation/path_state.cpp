#include "ajar/estimation/path_state.hpp"

#include <cmath>

#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

using Vector14d = Eigen::Matrix<double, 14, 1>;

// Below this curvature the rotation about k is no direction of its own [1/m].
constexpr double kStraight = 1e-6;

// One scalar row z = h·d + noise: updates covariance and error, returns its share of the NIS.
double update_row(Matrix14d& P, Vector14d& d, const Vector14d& row, double residual, double variance) {
  Vector14d Ph = Vector14d::Zero();
  for (Eigen::Index j = 0; j < row.size(); ++j) {
    if (row[j] != 0.0) Ph += row[j] * P.col(j);  // two or six of them
  }
  const double innovation = residual - row.dot(d);
  const double S = row.dot(Ph) + variance;
  const Vector14d gain = Ph / S;
  d += gain * innovation;
  P.noalias() -= gain * Ph.transpose();
  return innovation * innovation / S;
}

// Odometry's yaw error turns all that the robot believes, path, curvature and grasp alike; its position error shifts it.
void add_walk(PathState& state, double travel, const PoseNoise& noise) {
  const Vector3d up = state.F.row(2);  // the base's axis of yaw, local axes
  Eigen::Matrix<double, 9, 1> turn = Eigen::Matrix<double, 9, 1>::Zero();
  turn.segment<2>(2) = up.tail<2>();
  turn.segment<2>(4) = up.x() * Vector2d(-state.kap.y(), state.kap.x());  // the frame does not roll, the curvature does
  turn.tail<3>() = up;
  state.P.topLeftCorner<9, 9>().noalias() += noise.rotation_walk * travel * turn * turn.transpose();
  state.P.diagonal().head<2>().array() += noise.position_walk * travel;
}

void apply_error(PathState& state, const Vector14d& d) {
  state.p += state.F.rightCols<2>() * d.head<2>();
  state.R = exp_so3(state.F * d.segment<3>(6)) * state.R;
  state.kap += d.segment<2>(4);
  state.error += d.tail<5>();
  state.F = state.F * exp_so3(Vector3d(0.0, d[2], d[3]));
}

}  // namespace

double arc_to(const PathState& state, const Vector3d& position) noexcept {
  const Vector3d v = state.F.transpose() * (position - state.p);
  double ds = 0.0;
  for (int i = 0; i < 3; ++i) {
    const CurvePoint point = curve_at(state.kap, ds);
    ds += point.t.dot(v - point.q);
  }
  return ds;
}

void move_along(PathState& state, double ds) noexcept {
  const Vector3d kl = local_curvature(state.kap);
  const Matrix3d E = exp_so3(ds * kl);
  state.p += state.F * curve_at(state.kap, ds).q;
  state.R = state.F * E * state.F.transpose() * state.R;
  state.F = state.F * E;
}

void predict_path(PathState& state, double ds, const PathBin& bin, const PoseNoise& noise) noexcept {
  const Matrix9d T = curve_transport(state.kap, ds);
  const double ro = std::exp(-std::abs(ds) / noise.correlation_length);
  Matrix14d& P = state.P;

  // P ← T P Tᵀ with T = [T6 | φ], ro on the correlated errors.
  Eigen::Matrix<double, 9, 14> X;
  X.noalias() = T.leftCols<6>().lazyProduct(P.topRows<6>());
  X.bottomRows<3>() += P.middleRows<3>(6);
  P.topLeftCorner<9, 9>().noalias() = X.leftCols<6>().lazyProduct(T.leftCols<6>().transpose());
  P.block<9, 3>(0, 6) += X.middleCols<3>(6);
  P.topRightCorner<9, 5>() = ro * X.rightCols<5>();
  P.bottomLeftCorner<5, 9>() = P.topRightCorner<9, 5>().transpose();
  P.bottomRightCorner<5, 5>() *= ro * ro;

  const double fresh = 1.0 - ro * ro;
  const double cp2 = noise.position_correlated * noise.position_correlated + bin.extra_sigma * bin.extra_sigma;
  const double cR2 = noise.rotation_correlated * noise.rotation_correlated;
  P.diagonal().segment<2>(9).array() += cp2 * fresh;
  P.diagonal().tail<3>().array() += cR2 * fresh;
  // The correlated error along the path shows in the rotation about k.
  const Vector3d kl = local_curvature(state.kap);
  P.bottomRightCorner<3, 3>() += cp2 * fresh * kl * kl.transpose();
  if (bin.base_travel > 0.0) add_walk(state, bin.base_travel, noise);
  for (Eigen::Index j = 0; j < P.cols(); ++j) {
    for (Eigen::Index i = 0; i < j; ++i) P(i, j) = P(j, i) = 0.5 * (P(i, j) + P(j, i));
  }

  state.error *= ro;
  move_along(state, ds);
}

PathCorrection correct_path(PathState& state, const PathBin& bin, const PoseNoise& noise, bool use_rotation) noexcept {
  const Vector3d offset = state.F.transpose() * (bin.position - state.p);
  const double white = noise.position_white * noise.position_white / bin.count;
  Vector14d d = Vector14d::Zero();
  PathCorrection correction;
  for (int i = 0; i < 2; ++i) {
    Vector14d row = Vector14d::Zero();
    row[i] = row[9 + i] = 1.0;
    correction.nis += update_row(state.P, d, row, offset[1 + i] - state.error[i], white);
  }
  correction.rows = 2;
  if (use_rotation) {
    // Rows turned to (k, x, k × x): the error of the arc position enters along k alone.
    const Vector3d turn = state.F.transpose() * log_so3(bin.rotation * state.R.transpose()) - state.error.tail<3>();
    const double kappa = state.kap.norm();
    const Vector3d u = kappa > kStraight ? Vector3d(local_curvature(state.kap) / kappa) : Vector3d::UnitZ();
    const Vector3d axes[3] = {u, Vector3d::UnitX(), u.cross(Vector3d::UnitX())};
    const double rotation_white = noise.rotation_white * noise.rotation_white / bin.count;
    const double along_k = kappa * kappa * white;
    for (int i = 0; i < 3; ++i) {
      Vector14d row = Vector14d::Zero();
      row.segment<3>(6) = axes[i];
      row.tail<3>() = axes[i];
      correction.nis += update_row(state.P, d, row, axes[i].dot(turn), rotation_white + (i == 0 ? along_k : 0.0));
    }
    correction.rows = 5;
  }
  apply_error(state, d);
  return correction;
}

Vector4d path_difference(const Matrix3d& F, const Vector2d& kap, const Vector3d& x, const Vector3d& k) noexcept {
  const Vector3d local = F.transpose() * x;
  const Vector3d axis(0.0, -local.z(), local.y());  // e1 × local
  const double sine = axis.norm();
  const double angle = std::atan2(sine, local.x());
  const Vector3d w = sine > 1e-12 ? Vector3d(axis * (angle / sine)) : Vector3d::Zero();
  const Vector3d turned = exp_so3(-w) * (F.transpose() * k);
  Vector4d difference;
  difference << w.tail<2>(), turned.tail<2>() - kap;
  return difference;
}

}  // namespace ajar
