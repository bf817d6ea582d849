#pragma once

#include <Eigen/Cholesky>
#include <cmath>
#include <numbers>
#include <vector>

#include "ajar/core/random.hpp"
#include "ajar/core/so3.hpp"
#include "ajar/estimation/path_filter.hpp"

namespace ajar::test {

inline constexpr double kDegree = std::numbers::pi / 180.0;

/// A circle or line in space, walked from s = 0.
struct TruePath {
  Matrix3d F = Matrix3d::Identity();
  Vector2d kap = Vector2d::Zero();
  Vector3d origin = Vector3d::Zero();
  Matrix3d grasp = Matrix3d::Identity();

  /// Pose of the hand at the grasp.
  [[nodiscard]] Pose start() const {
    Pose pose = Pose::Identity();
    pose.translation() = origin;
    pose.linear() = grasp;
    return pose;
  }
  [[nodiscard]] Vector3d k() const { return F * local_curvature(kap); }
  [[nodiscard]] Vector3d position(double s) const { return origin + F * curve_at(kap, s).q; }
  [[nodiscard]] Matrix3d turn(double s) const { return exp_so3(s * k()); }
  [[nodiscard]] Vector3d direction(double s) const { return turn(s) * F.col(0); }
};

/// A path with a random pose; radius 0 stands for a slide.
inline TruePath random_path(double radius, Random& rng) {
  TruePath path;
  path.F = exp_so3(rng.normal3(2.0));
  path.origin = rng.normal3(1.0);
  path.grasp = exp_so3(rng.normal3(1.0));
  const double angle = rng.uniform(0.0, 2.0 * std::numbers::pi);
  if (radius > 0.0) path.kap = Vector2d(std::cos(angle), std::sin(angle)) / radius;
  return path;
}

/// Poses along a path with white and exponentially correlated errors, as the noise model states them.
class Measured {
 public:
  Measured(const TruePath& path, const PoseNoise& noise, Random& rng)
      : path_(path),
        noise_(noise),
        rng_(rng),
        b_(rng.normal3(noise.position_correlated)),
        c_(rng.normal3(noise.rotation_correlated)) {}

  /// @param follow  Share of the mechanism's turning that the hand follows: 1 rigid grasp, 0 pivot.
  PathSample at(double s, double follow = 1.0) {
    const double ro = std::exp(-std::abs(s - s_) / noise_.correlation_length);
    const double fresh = std::sqrt(1.0 - ro * ro);
    b_ = ro * b_ + fresh * rng_.normal3(noise_.position_correlated);
    c_ = ro * c_ + fresh * rng_.normal3(noise_.rotation_correlated);
    s_ = s;
    PathSample sample;
    sample.position = path_.position(s) + b_ + rng_.normal3(noise_.position_white);
    sample.rotation = exp_so3(c_ + rng_.normal3(noise_.rotation_white)) * path_.turn(follow * s) * path_.grasp;
    return sample;
  }

 private:
  TruePath path_;
  PoseNoise noise_;
  Random& rng_;
  Vector3d b_, c_;
  double s_ = 0.0;
};

/// Turn and curvature errors of an estimate against the truth at the point of the true path in the plane through the
/// estimated point across the estimated direction (the estimate's own gauge).
inline Vector4d own_gauge_error(const PathOutput& out, const TruePath& path, double s_near) {
  double s = s_near;
  for (int i = 0; i < 5; ++i) {
    s -= out.F.col(0).dot(path.position(s) - out.point) / out.F.col(0).dot(path.direction(s));
  }
  return path_difference(out.F, out.kap, path.direction(s), path.k());
}

/// Cramér-Rao covariance of the nine curve parameters at the newest of n poses spaced evenly over `length`, arc positions
/// unknown: the tangential residual fixes them and enters the rotation along k.
inline Matrix9d cramer_rao(const Vector2d& kap, double length, double spacing, const PoseNoise& n, bool rotation,
                           double prior) {
  const int count = static_cast<int>(std::floor(length / spacing + 1e-9)) + 1;
  const Vector3d kl = local_curvature(kap);
  const double kappa = kap.norm();
  Eigen::MatrixXd M(count, count);
  Eigen::MatrixXd white = Eigen::MatrixXd::Identity(count, count);
  Eigen::MatrixXd Jp[2], Jr[3];
  for (auto& J : Jp) J.resize(count, 9);
  for (auto& J : Jr) J.resize(count, 9);
  const Vector3d u = kappa > 0.0 ? Vector3d(kl / kappa) : Vector3d::UnitZ();
  Matrix3d U;
  U << u.transpose(), Vector3d::UnitX().transpose(), u.cross(Vector3d::UnitX()).transpose();
  for (int i = 0; i < count; ++i) {
    const double s = (i - 0.5 * (count - 1)) * spacing;
    for (int j = 0; j < count; ++j) M(i, j) = std::exp(-std::abs(i - j) * spacing / n.correlation_length);
    const CurvePoint point = curve_at(kap, s);
    const Matrix3d E = exp_so3(s * kl);
    Eigen::Matrix<double, 3, 9> A = Eigen::Matrix<double, 3, 9>::Zero();
    A(1, 0) = A(2, 1) = 1.0;
    A.middleCols<2>(2) = -hat(point.q).rightCols<2>();
    A.middleCols<2>(4) = point.D;
    A = (E.transpose() * A).eval();
    Eigen::Matrix<double, 3, 9> R = Eigen::Matrix<double, 3, 9>::Zero();
    const Matrix3d Jl = s * left_jacobian_so3(s * kl);
    R.rightCols<3>() = Matrix3d::Identity();
    R.middleCols<2>(2) = -(E.transpose() * Jl * hat(kl)).rightCols<2>();
    R.middleCols<2>(4) = (E.transpose() * Jl).rightCols<2>();
    R = (U * (R - kl * A.row(0))).eval();
    for (int c = 0; c < 2; ++c) Jp[c].row(i) = A.row(1 + c);
    for (int c = 0; c < 3; ++c) Jr[c].row(i) = R.row(c);
  }
  const double sp2 = n.position_white * n.position_white, cp2 = n.position_correlated * n.position_correlated;
  const double sR2 = n.rotation_white * n.rotation_white, cR2 = n.rotation_correlated * n.rotation_correlated;
  Matrix9d H = Matrix9d::Zero();
  const Eigen::LLT<Eigen::MatrixXd> Cp(sp2 * white + cp2 * M);
  for (const auto& J : Jp) H += J.transpose() * Cp.solve(J);
  if (rotation) {
    const Eigen::LLT<Eigen::MatrixXd> Ck((sR2 + kappa * kappa * sp2) * white + (cR2 + kappa * kappa * cp2) * M);
    const Eigen::LLT<Eigen::MatrixXd> Cr(sR2 * white + cR2 * M);
    for (int c = 0; c < 3; ++c) H += Jr[c].transpose() * (c == 0 ? Ck : Cr).solve(Jr[c]);
  } else {
    H.bottomRightCorner<3, 3>() += Matrix3d::Identity();
  }
  H.diagonal().segment<2>(4).array() += 1.0 / (prior * prior);
  const Matrix9d T = curve_transport(kap, 0.5 * (count - 1) * spacing);
  return T * H.llt().solve(Matrix9d::Identity()) * T.transpose();
}

}  // namespace ajar::test
