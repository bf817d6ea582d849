#include "track_fit.hpp"

#include <array>
#include <cmath>

#include "path_problem.hpp"

namespace ajar {
namespace {

using Problem = PathProblem<Eigen::Dynamic>;

// Grid of the noise search: share of the variance of one sample that is white, and correlation length.
constexpr std::array kWhiteShares{0.003, 0.01, 0.03, 0.1, 0.3, 0.7};
constexpr std::array kLengths{0.02, 0.035, 0.06, 0.1};
// Lengths found on real furniture lie within 2-6 cm; the fit takes the long waves, so the choice leans to 5 cm and more.
constexpr double kLikelyLength = 0.06;
constexpr double kLengthSpread = 0.7;  // of ln L
constexpr double kLeastNoise = 1e-6;   // of a level that is learnt: no sensor is better [m]

Problem problem_of(const std::vector<PathBin>& bins, const std::vector<double>& arcs, const PathState& start,
                   const PathFitConfig& config) {
  Problem problem(bins, config);
  problem.anchor = start;
  problem.s = Eigen::Map<const Eigen::VectorXd>(arcs.data(), problem.size);
  return problem;
}

double misfit(const Eigen::LLT<Eigen::MatrixXd>& factor, const Eigen::VectorXd& residual) {
  return factor.matrixL().solve(residual).squaredNorm();
}

// -2 log restricted likelihood of residuals whose covariance is scale · C, the best scale put in.
struct Restricted {
  double score = INFINITY;
  double scale = 0.0;
};

Restricted restricted_likelihood(const Problem& problem) {
  const Eigen::LLT<Eigen::MatrixXd> factor(problem.series_covariance(1.0, 0.0));
  if (factor.info() != Eigen::Success) return {};
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double squares = 0.0;
  for (const Problem::Series& series : problem.position) {
    const Eigen::MatrixXd whitened = factor.matrixL().solve(series.leftCols<7>());
    H += whitened.rightCols<6>().transpose() * whitened.rightCols<6>();
    g += whitened.rightCols<6>().transpose() * whitened.col(0);
    squares += whitened.col(0).squaredNorm();
  }
  const Eigen::LLT<Matrix6d> normal(H);
  if (normal.info() != Eigen::Success) return {};
  const double rows = 2.0 * static_cast<double>(problem.size) - 6.0;
  Restricted result;
  result.scale = std::max(squares - g.dot(normal.solve(g)), 0.0) / rows;
  if (!(result.scale > 0.0)) return {};
  const auto log_determinant = [](const auto& f) { return 2.0 * f.matrixLLT().diagonal().array().log().sum(); };
  result.score = rows * std::log(result.scale) + 2.0 * log_determinant(factor) + log_determinant(normal);
  return result;
}

}  // namespace

TrackFit fit_track(const std::vector<PathBin>& bins, const std::vector<double>& arcs, const PathState& start,
                   const PathFitConfig& config) {
  Problem problem = problem_of(bins, arcs, start, config);
  TrackFit fit;
  Eigen::Matrix<double, 9, 9> H;
  if (!problem.solve(H)) return fit;
  fit.path = problem.anchor;
  fit.covariance = H.llt().solve(Matrix9d::Identity());
  const Eigen::LLT<Eigen::MatrixXd> across_path(problem.series_covariance(1.0, 0.0));
  for (const Problem::Series& series : problem.position) fit.position_misfit += misfit(across_path, series.col(0));
  fit.rows = 2 * static_cast<int>(problem.size);
  if (config.use_rotation) {
    const Eigen::LLT<Eigen::MatrixXd> along(problem.series_covariance(problem.anchor.kap.squaredNorm(), 1.0));
    const Eigen::LLT<Eigen::MatrixXd> across(problem.series_covariance(0.0, 1.0));
    const Matrix3d axes = problem.rotation_axes();
    for (int c = 0; c < 3; ++c) {
      fit.rotation_misfit += misfit(c == 0 ? along : across, problem.rotation_series(axes.col(c)).col(0));
    }
  }
  fit.good = fit.covariance.allFinite() && fit.path.p.allFinite() && fit.path.F.allFinite();
  return fit;
}

PoseNoise learn_position_noise(const std::vector<PathBin>& bins, const std::vector<double>& arcs, const PathState& start,
                               const PoseNoise& noise) {
  PathFitConfig config{.noise = noise, .use_rotation = false};
  Problem problem = problem_of(bins, arcs, start, config);
  problem.find_arcs();
  problem.fill_rows();
  PoseNoise best = noise;
  double best_score = INFINITY;
  for (const double length : kLengths) {
    const double unlikely = std::log(length / kLikelyLength) / kLengthSpread;
    for (const double share : kWhiteShares) {
      config.noise.position_white = std::sqrt(share);
      config.noise.position_correlated = std::sqrt(1.0 - share);
      config.noise.correlation_length = length;
      const Restricted found = restricted_likelihood(problem);
      const double score = found.score + unlikely * unlikely;
      if (!(score < best_score)) continue;
      best_score = score;
      best = noise;
      best.position_white = std::max(kLeastNoise, std::sqrt(share * found.scale));
      best.position_correlated = std::max(kLeastNoise, std::sqrt((1.0 - share) * found.scale));
      best.correlation_length = length;
    }
  }
  return best;
}

}  // namespace ajar
