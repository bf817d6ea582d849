#include "ajar/estimation/path_fit.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "path_problem.hpp"

namespace ajar {
namespace {

constexpr double kMaxStartCurvature = 12.0;  // r = 8 cm: tighter than any handle's path [1/m]

using Problem = PathProblem<kMaxFitBins>;

void start_from_chord(Problem& problem) {
  const PathBin& first = problem.bins.front();
  const PathBin& last = problem.bins.back();
  const Vector3d chord = last.position - first.position;
  const Vector3d x = chord.normalized();
  PathState& anchor = problem.anchor;
  anchor.F.col(0) = x;
  anchor.F.col(1) = any_perpendicular(x);
  anchor.F.col(2) = x.cross(anchor.F.col(1));
  anchor.p = 0.5 * (first.position + last.position);
  anchor.R = problem.at(problem.size / 2).rotation;
  anchor.kap.setZero();
  if (problem.config->use_rotation) {
    const Vector3d turn = log_so3(last.rotation * first.rotation.transpose());
    anchor.kap = anchor.F.rightCols<2>().transpose() * turn / chord.norm();
    anchor.kap *= std::min(1.0, kMaxStartCurvature / std::max(anchor.kap.norm(), 1e-9));
  }
  for (Eigen::Index i = 0; i < problem.size; ++i) problem.s[i] = x.dot(problem.at(i).position - anchor.p);
}

// Posterior of one component of the correlated error at the newest bin: mean, dependence on the parameters, own variance.
struct ErrorPosterior {
  double mean, variance;
  Eigen::Matrix<double, 1, 9> slope;
};

ErrorPosterior newest_error(const Eigen::LLT<Problem::BinMatrix>& factor, const Problem::BinVector& with_newest,
                            double variance, const Problem::Series& series) {
  const Problem::BinVector g = factor.solve(with_newest);
  const Eigen::Matrix<double, 1, 10> gained = g.transpose().lazyProduct(series);
  return {gained[0], std::max(variance - g.dot(with_newest), 0.0), gained.tail<9>()};
}

void join_errors(const Problem& problem, const Matrix9d& transport, const Matrix9d& C, PathState& state) {
  const PoseNoise& n = problem.config->noise;
  const Eigen::Index last = problem.size - 1;
  const double cp2 = n.position_correlated * n.position_correlated;
  const double cR2 = n.rotation_correlated * n.rotation_correlated;
  Problem::BinVector position(last + 1);
  Problem::BinVector rotation(last + 1);
  for (Eigen::Index i = 0; i <= last; ++i) {
    const double ro = std::exp(-(problem.walked[last] - problem.walked[i]) / n.correlation_length);
    position[i] = (cp2 + problem.extra[i] * problem.extra[last]) * ro;
    rotation[i] = cR2 * ro;
  }
  Eigen::Matrix<double, 14, 9> A = Eigen::Matrix<double, 14, 9>::Zero();
  A.topRows<9>() = transport;
  Eigen::Matrix<double, 14, 1> own = Eigen::Matrix<double, 14, 1>::Zero();
  Matrix3d own_turn = Matrix3d::Zero();
  const auto add = [&](int index, const ErrorPosterior& posterior) {
    state.error[index] = posterior.mean;
    A.row(9 + index) = posterior.slope;
    own[9 + index] = posterior.variance;
  };
  const Eigen::LLT<Problem::BinMatrix> across(problem.series_covariance(1.0, 0.0));
  for (int c = 0; c < 2; ++c) add(c, newest_error(across, position, position[last], problem.position[c]));
  if (problem.config->use_rotation) {
    // Along k the error of the position along the path takes part.
    const double k2 = problem.anchor.kap.squaredNorm();
    const Matrix3d axes = problem.rotation_axes();
    const Eigen::LLT<Problem::BinMatrix> along(problem.series_covariance(k2, 1.0));
    const Eigen::LLT<Problem::BinMatrix> turn(problem.series_covariance(0.0, 1.0));
    for (int c = 0; c < 3; ++c) {
      const Problem::BinVector with_newest = c == 0 ? Problem::BinVector(rotation + k2 * position) : rotation;
      add(2 + c, newest_error(c == 0 ? along : turn, with_newest, with_newest[last], problem.rotation_series(axes.col(c))));
    }
    state.error.tail<3>() = axes * Vector3d(state.error.tail<3>());
    A.bottomRows<3>() = (axes * A.bottomRows<3>()).eval();
    own_turn = axes * own.tail<3>().asDiagonal() * axes.transpose();
  } else {
    state.error.tail<3>().setZero();
    own_turn = cR2 * Matrix3d::Identity();
  }
  state.P.noalias() = A * C * A.transpose();
  state.P.diagonal().head<11>() += own.head<11>();
  state.P.bottomRightCorner<3, 3>() += own_turn;
}

}  // namespace

bool fit_path(std::span<const PathBin> bins, const PathFitConfig& config, PathState& state) noexcept {
  if (bins.size() < 4 || bins.size() > kMaxFitBins) return false;
  if (!((bins.back().position - bins.front().position).norm() > 1e-6)) return false;
  Problem problem(bins, config);
  start_from_chord(problem);
  Matrix9d H;
  if (!problem.solve(H)) return false;

  PathState fitted = problem.anchor;
  const double ds = problem.s[problem.size - 1];
  join_errors(problem, curve_transport(problem.anchor.kap, ds), H.llt().solve(Matrix9d::Identity()), fitted);
  move_along(fitted, ds);
  if (!fitted.P.allFinite() || !fitted.p.allFinite() || !fitted.F.allFinite()) return false;
  state = fitted;
  return true;
}

}  // namespace ajar
