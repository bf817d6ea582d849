#pragma once

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <span>

#include "ajar/core/so3.hpp"
#include "ajar/estimation/path_fit.hpp"

namespace ajar {

/// Gauss-Newton on a circle or line and a grasp rotation, every bin's arc position eliminated. `kMax` bounds the bins (no
/// allocation) or is Eigen::Dynamic for recorded tracks. (docs/equations.md#estimator)
template <int kMax>
class PathProblem {
 public:
  using Vector9d = Eigen::Matrix<double, 9, 1>;
  using Matrix39d = Eigen::Matrix<double, 3, 9>;
  using BinVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMax, 1>;
  using BinMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMax, kMax>;
  /// One residual series: first the residual, then its nine derivatives.
  using Series = Eigen::Matrix<double, Eigen::Dynamic, 10, 0, kMax, 10>;

  PathProblem(std::span<const PathBin> from, const PathFitConfig& settings)
      : bins(from), config(&settings), size(static_cast<Eigen::Index>(from.size())) {
    for (BinVector* v : {&s, &walked, &white, &extra, &travel}) v->resize(size);
    for (Series& series : position) series.resize(size, 10);
    for (Series& series : rotation) series.resize(size, 10);
    double base = 0.0;
    for (Eigen::Index i = size - 1; i >= 0; --i) {
      const PathBin& bin = at(i);
      white[i] = 1.0 / bin.count;
      extra[i] = bin.extra_sigma;
      travel[i] = base;
      base += bin.base_travel;
    }
  }

  [[nodiscard]] const PathBin& at(Eigen::Index i) const { return bins[static_cast<std::size_t>(i)]; }

  /// One Newton step of every bin's arc position, and the path walked so far.
  void find_arcs() {
    for (Eigen::Index i = 0; i < size; ++i) {
      const CurvePoint point = curve_at(anchor.kap, s[i]);
      const Vector3d v = anchor.F.transpose() * (at(i).position - anchor.p);
      s[i] += std::clamp(point.t.dot(v - point.q), -kMaxArcStep, kMaxArcStep);
      walked[i] = i == 0 ? 0.0 : walked[i - 1] + std::abs(s[i] - s[i - 1]);
    }
  }

  /// Residuals and derivatives at the present parameters.
  void fill_rows() {
    for (Eigen::Index i = 0; i < size; ++i) fill_row(i);
  }

  /// One Gauss-Newton iteration; returns the largest component of the step, or a negative number when it failed.
  /// @param[out] H  Normal matrix
  double iterate(Matrix9d& H);

  /// Iterates until the step is small; false when it fails.
  bool solve(Matrix9d& H) {
    find_arcs();
    for (int i = 0; i < kMaxIterations; ++i) {
      find_arcs();
      const double step = iterate(H);
      if (step < 0.0) return false;
      if (step < kConverged) break;
    }
    find_arcs();
    fill_rows();
    return true;
  }

  /// Covariance of one series: white/n, correlated over the path walked, walk over base travel.
  /// @param a  Weight of the position terms @param b  Weight of the rotation terms
  [[nodiscard]] BinMatrix series_covariance(double a, double b) const;

  /// Axes (k, x, k × x) of the rotation rows, local: the error of the arc position enters along the first alone.
  [[nodiscard]] Matrix3d rotation_axes() const {
    const double kappa = anchor.kap.norm();
    const Vector3d u = kappa > 1e-6 ? Vector3d(local_curvature(anchor.kap) / kappa) : Vector3d::UnitZ();
    Matrix3d axes;
    axes << u, Vector3d::UnitX(), u.cross(Vector3d::UnitX());
    return axes;
  }
  /// Rotation residuals along one of those axes.
  [[nodiscard]] Series rotation_series(const Vector3d& axis) const {
    return axis[0] * rotation[0] + axis[1] * rotation[1] + axis[2] * rotation[2];
  }

  std::span<const PathBin> bins;
  const PathFitConfig* config;
  Eigen::Index size;
  PathState anchor;  // only F, kap, p, R are used
  BinVector s;       // arc positions from the anchor
  BinVector walked;  // path walked since the first bin
  BinVector white;   // 1/n
  BinVector extra;   // standard deviation of the bin's own correlated position error
  BinVector travel;  // base travel between the bin and the newest one
  Series position[2];
  Series rotation[3];

 private:
  static constexpr int kMaxIterations = 15;      // four to eight are usual
  static constexpr double kConverged = 1e-7;     // largest step that ends the iteration [m, rad, 1/m]
  static constexpr double kMaxTurn = 0.5;        // largest turn of x per iteration [rad]
  static constexpr double kMaxBend = 2.0;        // largest change of curvature per iteration [1/m]
  static constexpr double kMaxCurvature = 12.0;  // r = 8 cm: tighter than any handle's path [1/m]
  static constexpr double kMaxArcStep = 0.1;     // largest change of an arc position per Newton step [m]

  struct Normal {
    Matrix9d H = Matrix9d::Zero();
    Vector9d g = Vector9d::Zero();

    void add(const Eigen::LLT<BinMatrix>& factor, const Series& series) {
      Series whitened = series;
      factor.matrixL().solveInPlace(whitened);
      H.noalias() += whitened.template rightCols<9>().transpose().lazyProduct(whitened.template rightCols<9>());
      g.noalias() -= whitened.template rightCols<9>().transpose().lazyProduct(whitened.col(0));
    }
  };

  void fill_row(Eigen::Index i);
  [[nodiscard]] Normal normal_equations() const;
};

template <int kMax>
void PathProblem<kMax>::fill_row(Eigen::Index i) {
  const PathBin& bin = at(i);
  const Vector3d kl = local_curvature(anchor.kap);
  const Matrix3d E = exp_so3(s[i] * kl);
  const CurvePoint point = curve_at(anchor.kap, s[i]);
  const Vector3d v = anchor.F.transpose() * (bin.position - anchor.p);

  Matrix39d J = Matrix39d::Zero();
  J(1, 0) = J(2, 1) = -1.0;
  J.template middleCols<2>(2) = hat(v).rightCols<2>();
  J.template middleCols<2>(4) = -point.D;
  J = (E.transpose() * J).eval();
  const Vector3d e = E.transpose() * (v - point.q);
  for (int c = 0; c < 2; ++c) {
    position[c](i, 0) = e[1 + c];
    position[c].row(i).template tail<9>() = J.row(1 + c);
  }
  if (!config->use_rotation) return;

  const Matrix3d turned = anchor.F * E * anchor.F.transpose() * anchor.R;  // grasp rotation predicted at s
  const Matrix3d Jl = s[i] * left_jacobian_so3(s[i] * kl);
  Matrix39d Jr = Matrix39d::Zero();
  Jr.template middleCols<2>(2) = (Jl * hat(kl)).template rightCols<2>();
  Jr.template middleCols<2>(4) = -Jl.template rightCols<2>();
  Jr = (E.transpose() * Jr).eval();
  Jr.template rightCols<3>() = -Matrix3d::Identity();
  Jr -= kl * J.row(0);
  // log(R_i (Exp(s k) R)ᵀ) in the moving frame F E.
  const Vector3d rho = E.transpose() * anchor.F.transpose() * log_so3(bin.rotation * turned.transpose()) - kl * e[0];
  for (int c = 0; c < 3; ++c) {
    rotation[c](i, 0) = rho[c];
    rotation[c].row(i).template tail<9>() = Jr.row(c);
  }
}

template <int kMax>
typename PathProblem<kMax>::BinMatrix PathProblem<kMax>::series_covariance(double a, double b) const {
  const PoseNoise& n = config->noise;
  const double cp2 = n.position_correlated * n.position_correlated;
  const double cR2 = n.rotation_correlated * n.rotation_correlated;
  BinMatrix C(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const double ro = std::exp(-(walked[i] - walked[j]) / n.correlation_length);
      const double shared = std::min(travel[i], travel[j]);
      C(i, j) = (a * (cp2 + extra[i] * extra[j]) + b * cR2) * ro + (a * n.position_walk + b * n.rotation_walk) * shared;
      C(j, i) = C(i, j);
    }
    C(i, i) += (a * n.position_white * n.position_white + b * n.rotation_white * n.rotation_white) * white[i];
  }
  return C;
}

template <int kMax>
typename PathProblem<kMax>::Normal PathProblem<kMax>::normal_equations() const {
  Normal normal;
  const Eigen::LLT<BinMatrix> across_path(series_covariance(1.0, 0.0));
  for (const Series& series : position) normal.add(across_path, series);
  if (config->use_rotation) {
    const Eigen::LLT<BinMatrix> along(series_covariance(anchor.kap.squaredNorm(), 1.0));
    const Eigen::LLT<BinMatrix> across(series_covariance(0.0, 1.0));
    const Matrix3d axes = rotation_axes();
    for (int c = 0; c < 3; ++c) normal.add(c == 0 ? along : across, rotation_series(axes.col(c)));
  } else {
    normal.H.template bottomRightCorner<3, 3>() += Matrix3d::Identity();  // the grasp's turn is not seen: any value will do
  }
  const double prior = 1.0 / (config->curvature_prior * config->curvature_prior);
  normal.H.diagonal().template segment<2>(4).array() += prior;
  normal.g.template segment<2>(4) -= prior * anchor.kap;
  return normal;
}

template <int kMax>
double PathProblem<kMax>::iterate(Matrix9d& H) {
  fill_rows();
  const Normal normal = normal_equations();
  const Eigen::LLT<Matrix9d> factor(normal.H);
  if (factor.info() != Eigen::Success) return -1.0;
  Vector9d d = factor.solve(normal.g);
  if (!d.allFinite()) return -1.0;
  const double bend = d.template segment<2>(4).cwiseAbs().maxCoeff();
  d *= std::min({1.0, kMaxTurn / std::max(d.template segment<2>(2).norm(), 1e-9), kMaxBend / std::max(bend, 1e-9)});
  anchor.p += anchor.F.template rightCols<2>() * d.template head<2>();
  anchor.R = exp_so3(anchor.F * d.template tail<3>()) * anchor.R;
  anchor.kap += d.template segment<2>(4);
  anchor.kap *= std::min(1.0, kMaxCurvature / std::max(anchor.kap.norm(), 1e-9));
  anchor.F = anchor.F * exp_so3(Vector3d(0.0, d[2], d[3]));
  H = normal.H;
  return d.cwiseAbs().maxCoeff();
}

}  // namespace ajar
