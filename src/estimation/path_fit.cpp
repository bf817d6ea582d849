#include "ajar/estimation/path_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

constexpr int kMaxIterations = 15;      // four to eight are usual
constexpr double kConverged = 1e-7;     // largest step that ends the iteration [m, rad, 1/m]
constexpr double kMaxTurn = 0.5;        // largest turn of x per iteration [rad]
constexpr double kMaxBend = 2.0;        // largest change of curvature per iteration [1/m]
constexpr double kMaxCurvature = 12.0;  // r = 8 cm: tighter than any handle's path [1/m]
constexpr double kMaxArcStep = 0.1;     // largest change of an arc position per Newton step [m]

constexpr int kMax = kMaxFitBins;
using Vector9d = Eigen::Matrix<double, 9, 1>;
using Matrix39d = Eigen::Matrix<double, 3, 9>;
using BinVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMax, 1>;
using BinMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMax, kMax>;
// One residual series per column block: first the residual, then its nine derivatives.
using Series = Eigen::Matrix<double, Eigen::Dynamic, 10, 0, kMax, 10>;

// Residuals of all bins at the present parameters, moving frame, arc positions eliminated.
struct Rows {
  Series position[2];
  Series rotation[3];
};

// What the bins contribute to the noise: counts, own correlated error, base travel up to the newest bin.
struct BinNoise {
  BinVector white;   // 1 / n
  BinVector extra;   // standard deviation of the correlated position error
  BinVector travel;  // base travel between the bin and the newest one
};

struct Problem {
  std::span<const PathBin> bins;
  const PathFitConfig* config;
  BinNoise noise;
  BinVector s;
  PathState anchor;  // only F, kap, p, R are used
  Rows rows;
};

void start_from_chord(Problem& problem) {
  const auto& bins = problem.bins;
  const PathBin& first = bins.front();
  const PathBin& last = bins.back();
  const Vector3d chord = last.position - first.position;
  const Vector3d x = chord.normalized();
  PathState& anchor = problem.anchor;
  anchor.F.col(0) = x;
  anchor.F.col(1) = any_perpendicular(x);
  anchor.F.col(2) = x.cross(anchor.F.col(1));
  anchor.p = 0.5 * (first.position + last.position);
  anchor.R = bins[bins.size() / 2].rotation;
  anchor.kap.setZero();
  if (problem.config->use_rotation) {
    const Vector3d turn = log_so3(last.rotation * first.rotation.transpose());
    anchor.kap = anchor.F.rightCols<2>().transpose() * turn / chord.norm();
    anchor.kap *= std::min(1.0, kMaxCurvature / std::max(anchor.kap.norm(), 1e-9));
  }
  for (Eigen::Index i = 0; i < problem.s.size(); ++i) {
    problem.s[i] = x.dot(bins[static_cast<std::size_t>(i)].position - anchor.p);
  }
}

void find_arcs(Problem& problem) {
  for (Eigen::Index i = 0; i < problem.s.size(); ++i) {
    const CurvePoint point = curve_at(problem.anchor.kap, problem.s[i]);
    const Vector3d v =
        problem.anchor.F.transpose() * (problem.bins[static_cast<std::size_t>(i)].position - problem.anchor.p);
    problem.s[i] += std::clamp(point.t.dot(v - point.q), -kMaxArcStep, kMaxArcStep);
  }
}

// Fills the residuals and derivatives of bin i.
void fill_rows(Problem& problem, Eigen::Index i) {
  const PathState& anchor = problem.anchor;
  const PathBin& bin = problem.bins[static_cast<std::size_t>(i)];
  const double s = problem.s[i];
  const Vector3d kl = local_curvature(anchor.kap);
  const Matrix3d E = exp_so3(s * kl);
  const CurvePoint point = curve_at(anchor.kap, s);
  const Vector3d v = anchor.F.transpose() * (bin.position - anchor.p);

  Matrix39d J = Matrix39d::Zero();
  J(1, 0) = J(2, 1) = -1.0;
  J.middleCols<2>(2) = hat(v).rightCols<2>();
  J.middleCols<2>(4) = -point.D;
  J = (E.transpose() * J).eval();
  const Vector3d e = E.transpose() * (v - point.q);
  for (int c = 0; c < 2; ++c) {
    problem.rows.position[c](i, 0) = e[1 + c];
    problem.rows.position[c].row(i).tail<9>() = J.row(1 + c);
  }
  if (!problem.config->use_rotation) return;

  const Matrix3d turned = anchor.F * E * anchor.F.transpose() * anchor.R;  // grasp rotation predicted at s
  const Matrix3d Jl = s * left_jacobian_so3(s * kl);
  Matrix39d Jr = Matrix39d::Zero();
  Jr.middleCols<2>(2) = (Jl * hat(kl)).rightCols<2>();
  Jr.middleCols<2>(4) = -Jl.rightCols<2>();
  Jr = (E.transpose() * Jr).eval();
  Jr.rightCols<3>() = -Matrix3d::Identity();
  Jr -= kl * J.row(0);
  // log(R_i (Exp(s k) R)ᵀ) in the moving frame F E.
  const Vector3d rho = E.transpose() * anchor.F.transpose() * log_so3(bin.rotation * turned.transpose()) - kl * e[0];
  for (int c = 0; c < 3; ++c) {
    problem.rows.rotation[c](i, 0) = rho[c];
    problem.rows.rotation[c].row(i).tail<9>() = Jr.row(c);
  }
}

// Covariance of one series: white/n, correlated over arc, walk over base travel.
// a: weights of the position terms, b: of the rotation terms.
BinMatrix series_covariance(const Problem& problem, double a, double b) {
  const PoseNoise& n = problem.config->noise;
  const Eigen::Index size = problem.s.size();
  const double cp2 = n.position_correlated * n.position_correlated;
  const double cR2 = n.rotation_correlated * n.rotation_correlated;
  BinMatrix C(size, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    for (Eigen::Index j = 0; j <= i; ++j) {
      const double ro = std::exp(-std::abs(problem.s[i] - problem.s[j]) / n.correlation_length);
      const double travel = std::min(problem.noise.travel[i], problem.noise.travel[j]);
      const double extra = problem.noise.extra[i] * problem.noise.extra[j];
      C(i, j) = (a * (cp2 + extra) + b * cR2) * ro + (a * n.position_walk + b * n.rotation_walk) * travel;
      C(j, i) = C(i, j);
    }
    C(i, i) += (a * n.position_white * n.position_white + b * n.rotation_white * n.rotation_white) * problem.noise.white[i];
  }
  return C;
}

struct Normal {
  Matrix9d H = Matrix9d::Zero();
  Vector9d g = Vector9d::Zero();
};

void add_series(Normal& normal, const Eigen::LLT<BinMatrix>& factor, const Series& series) {
  Series whitened = series;
  factor.matrixL().solveInPlace(whitened);
  normal.H.noalias() += whitened.rightCols<9>().transpose().lazyProduct(whitened.rightCols<9>());
  normal.g.noalias() -= whitened.rightCols<9>().transpose().lazyProduct(whitened.col(0));
}

Normal normal_equations(const Problem& problem) {
  const PathFitConfig& config = *problem.config;
  Normal normal;
  const Eigen::LLT<BinMatrix> position(series_covariance(problem, 1.0, 0.0));
  for (const Series& series : problem.rows.position) add_series(normal, position, series);
  if (config.use_rotation) {
    const double kappa = problem.anchor.kap.norm();
    const Vector3d u = kappa > 1e-6 ? Vector3d(local_curvature(problem.anchor.kap) / kappa) : Vector3d::UnitZ();
    const Vector3d axes[3] = {u, Vector3d::UnitX(), u.cross(Vector3d::UnitX())};
    const Eigen::LLT<BinMatrix> along(series_covariance(problem, kappa * kappa, 1.0));
    const Eigen::LLT<BinMatrix> across(series_covariance(problem, 0.0, 1.0));
    const auto& rotation = problem.rows.rotation;
    for (int c = 0; c < 3; ++c) {
      const Series series = axes[c][0] * rotation[0] + axes[c][1] * rotation[1] + axes[c][2] * rotation[2];
      add_series(normal, c == 0 ? along : across, series);
    }
  } else {
    normal.H.bottomRightCorner<3, 3>() += Matrix3d::Identity();  // the grasp's turn is not seen: any value will do
  }
  const double prior = 1.0 / (config.curvature_prior * config.curvature_prior);
  normal.H.diagonal().segment<2>(4).array() += prior;
  normal.g.segment<2>(4) -= prior * problem.anchor.kap;
  return normal;
}

// One Gauss-Newton iteration; returns the largest component of the step, or a negative number when it failed.
double iterate(Problem& problem, Matrix9d& H) {
  for (Eigen::Index i = 0; i < problem.s.size(); ++i) fill_rows(problem, i);
  const Normal normal = normal_equations(problem);
  const Eigen::LLT<Matrix9d> factor(normal.H);
  if (factor.info() != Eigen::Success) return -1.0;
  Vector9d d = factor.solve(normal.g);
  if (!d.allFinite()) return -1.0;
  const double bend = d.segment<2>(4).cwiseAbs().maxCoeff();
  d *= std::min({1.0, kMaxTurn / std::max(d.segment<2>(2).norm(), 1e-9), kMaxBend / std::max(bend, 1e-9)});
  PathState& anchor = problem.anchor;
  anchor.p += anchor.F.rightCols<2>() * d.head<2>();
  anchor.R = exp_so3(anchor.F * d.tail<3>()) * anchor.R;
  anchor.kap += d.segment<2>(4);
  anchor.kap *= std::min(1.0, kMaxCurvature / std::max(anchor.kap.norm(), 1e-9));
  anchor.F = anchor.F * exp_so3(Vector3d(0.0, d[2], d[3]));
  H = normal.H;
  return d.cwiseAbs().maxCoeff();
}

// Posterior of one component of the correlated error at the newest bin: mean, dependence on the parameters, own variance.
struct ErrorPosterior {
  double mean, variance;
  Eigen::Matrix<double, 1, 9> slope;
};

ErrorPosterior newest_error(const Eigen::LLT<BinMatrix>& factor, const BinVector& with_newest, double variance,
                            const Series& series) {
  const BinVector g = factor.solve(with_newest);
  const Eigen::Matrix<double, 1, 10> gained = g.transpose().lazyProduct(series);
  return {gained[0], std::max(variance - g.dot(with_newest), 0.0), gained.tail<9>()};
}

void join_errors(const Problem& problem, const Matrix9d& transport, const Matrix9d& C, PathState& state) {
  const PoseNoise& n = problem.config->noise;
  const Eigen::Index last = problem.s.size() - 1;
  const double cp2 = n.position_correlated * n.position_correlated;
  const double cR2 = n.rotation_correlated * n.rotation_correlated;
  BinVector position(last + 1);
  BinVector rotation(last + 1);
  for (Eigen::Index i = 0; i <= last; ++i) {
    const double ro = std::exp(-std::abs(problem.s[i] - problem.s[last]) / n.correlation_length);
    position[i] = (cp2 + problem.noise.extra[i] * problem.noise.extra[last]) * ro;
    rotation[i] = cR2 * ro;
  }
  Eigen::Matrix<double, 14, 9> A = Eigen::Matrix<double, 14, 9>::Zero();
  A.topRows<9>() = transport;
  Eigen::Matrix<double, 14, 1> own = Eigen::Matrix<double, 14, 1>::Zero();
  const auto add = [&](int index, const ErrorPosterior& posterior) {
    state.error[index] = posterior.mean;
    A.row(9 + index) = posterior.slope;
    own[9 + index] = posterior.variance;
  };
  const Eigen::LLT<BinMatrix> across(series_covariance(problem, 1.0, 0.0));
  for (int c = 0; c < 2; ++c) add(c, newest_error(across, position, position[last], problem.rows.position[c]));
  if (problem.config->use_rotation) {
    const Eigen::LLT<BinMatrix> turn(series_covariance(problem, 0.0, 1.0));
    for (int c = 0; c < 3; ++c) add(2 + c, newest_error(turn, rotation, cR2, problem.rows.rotation[c]));
  } else {
    state.error.tail<3>().setZero();
    own.tail<3>().setConstant(cR2);
  }
  state.P.noalias() = A * C * A.transpose();
  state.P.diagonal() += own;
}

}  // namespace

bool fit_path(std::span<const PathBin> bins, const PathFitConfig& config, PathState& state) noexcept {
  const auto size = static_cast<Eigen::Index>(bins.size());
  if (size < 4 || size > kMax) return false;
  if (!((bins.back().position - bins.front().position).norm() > 1e-6)) return false;
  Problem problem{.bins = bins, .config = &config, .noise = {}, .s = BinVector(size), .anchor = {}, .rows = {}};
  for (BinVector* v : {&problem.noise.white, &problem.noise.extra, &problem.noise.travel}) v->resize(size);
  for (Series& series : problem.rows.position) series.resize(size, 10);
  for (Series& series : problem.rows.rotation) series.resize(size, 10);
  double travel = 0.0;
  for (Eigen::Index i = size - 1; i >= 0; --i) {
    const PathBin& bin = bins[static_cast<std::size_t>(i)];
    problem.noise.white[i] = 1.0 / bin.count;
    problem.noise.extra[i] = bin.extra_sigma;
    problem.noise.travel[i] = travel;
    travel += bin.base_travel;
  }
  start_from_chord(problem);
  find_arcs(problem);
  Matrix9d H;
  for (int i = 0; i < kMaxIterations; ++i) {
    find_arcs(problem);
    const double step = iterate(problem, H);
    if (step < 0.0) return false;
    if (step < kConverged) break;
  }
  find_arcs(problem);
  for (Eigen::Index i = 0; i < size; ++i) fill_rows(problem, i);

  PathState fitted = problem.anchor;
  const double ds = problem.s[size - 1];
  join_errors(problem, curve_transport(problem.anchor.kap, ds), H.llt().solve(Matrix9d::Identity()), fitted);
  move_along(fitted, ds);
  if (!fitted.P.allFinite() || !fitted.p.allFinite() || !fitted.F.allFinite()) return false;
  state = fitted;
  return true;
}

}  // namespace ajar
