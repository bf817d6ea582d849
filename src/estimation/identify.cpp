#include "ajar/estimation/identify.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"
#include "ajar/estimation/type_decision.hpp"
#include "robust_path.hpp"
#include "track_bins.hpp"
#include "track_fit.hpp"

namespace ajar {
namespace {

constexpr std::size_t kMaxBins = 300;        // of one fit: the work grows with their cube
constexpr double kBinLength = 0.002;         // as in the recursive filter [m]
constexpr double kOutlier = 4.0;             // standard deviations of the robust fit
constexpr double kRayleighMedian = 1.17741;  // median of the length of two normal components, √(2 ln 2)
constexpr double kAstray = 0.01;             // so far off a sample is not of this path, even if furniture is uneven [m]
constexpr int kRun = 5;                      // so many in a row are no glitch
constexpr double kLeastExplained = 0.55;
constexpr double kOneCurveLimit = 13.8;  // tail of 1e-3 of χ² with 2 degrees of freedom
constexpr double kPrior = 3.0;           // of each component of k, as in the recursive filter [1/m]
constexpr double kStraightPrior = 1e-6;  // a prior that allows no curvature [1/m]
constexpr double kNoisePrior = 20.0;     // rows of prior data that say "the assumed noise is right"
constexpr double kGripLimit = 23.0;      // as in the recursive grip test (docs/equations.md#estimator, 8)
constexpr double kGripMargin = 0.2;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kCurved = 1e-6;  // below this k has no direction [1/m]

void scale_position(PoseNoise& noise, double factor) {
  noise.position_white *= factor;
  noise.position_correlated *= factor;
}

void scale_rotation(PoseNoise& noise, double factor) {
  noise.rotation_white *= factor;
  noise.rotation_correlated *= factor;
}

// Scale of the noise by the misfit, the assumed noise counting as much as kNoisePrior rows.
double learnt_scale(double misfit, int rows, int parameters) {
  return std::sqrt((kNoisePrior + misfit) / (kNoisePrior + rows - parameters));
}

// Whether orientation and positions tell the same curvature (docs/equations.md#estimator, 8).
bool grip_is_rigid(const TrackFit& with, const TrackFit& without) {
  const Vector4d d = path_difference(with.path.F, with.path.kap, without.path.F.col(0), without.path.curvature());
  const Eigen::Matrix2d roll = with.path.F.rightCols<2>().transpose() * without.path.F.rightCols<2>();
  const Eigen::Matrix2d free = roll * without.covariance.block<2, 2>(4, 4) * roll.transpose();
  Eigen::LLT<Eigen::Matrix2d> factor((1.0 + kGripMargin) * free - with.covariance.block<2, 2>(4, 4));
  if (factor.info() != Eigen::Success) factor.compute(free);
  return d.tail<2>().dot(factor.solve(d.tail<2>())) < kGripLimit;
}

class Identifier {
 public:
  Identifier(const Track& track, const IdentifyConfig& config, const std::string& name)
      : track_(track), config_(config), name_(name), positions_(handle_positions(track, config.grasp_stiffness, name)) {}

  Identification run() {
    find_outliers();
    fit();
    judge_line();
    judge_halves();
    decide();
    describe();
    return std::move(result_);
  }

 private:
  void find_outliers() {
    const RobustPath robust = fit_robust_path(positions_);
    place_on(robust.path);
    // A walk back on a path of its own belongs to the track: most of the samples set the scale, not only the best half.
    const double limit = kOutlier * std::max(robust.scatter, median_of(result_.distance) / kRayleighMedian);
    result_.samples = static_cast<int>(positions_.size());
    result_.inlier.resize(positions_.size());
    sort_out(limit);
    result_.outliers = static_cast<int>(std::count(result_.inlier.begin(), result_.inlier.end(), false));
    result_.explained = explained_share();
    start_ = robust.path;
    double length = std::max(kBinLength, 3.0 * noise_of(config_.sensor).position_white);
    binned_ = bins_of(track_, positions_, result_.inlier, result_.arc, length);
    while (binned_.bins.size() > kMaxBins) {
      length *= 1.3;
      binned_ = bins_of(track_, positions_, result_.inlier, result_.arc, length);
    }
    if (binned_.bins.size() < 4) throw ConfigError(name_ + ": fewer than 4 places along the path are left without outliers");
  }

  // Samples beyond the limit are glitches, unless they go on for longer than errors are correlated: then the furniture or
  // the hand on it is uneven, up to kAstray.
  void sort_out(double limit) {
    const double correlated = noise_of(config_.sensor).correlation_length;
    for (std::size_t i = 0; i < positions_.size();) {
      std::size_t end = i;
      double way = 0.0;
      for (; end < positions_.size() && result_.distance[end] > limit; ++end) {
        if (end > i) way += (positions_[end] - positions_[end - 1]).norm();
      }
      for (; i < end; ++i) result_.inlier[i] = way > correlated && result_.distance[i] < kAstray;
      if (i < positions_.size()) result_.inlier[i++] = true;
    }
  }

  // Share of the way that belongs to the path: apart from it go runs of samples that are far off one after the other.
  [[nodiscard]] double explained_share() const {
    double astray = 0.0;
    double run = 0.0;
    int in_run = 0;
    double low = 0.0;
    double high = 0.0;
    for (std::size_t i = 0; i < positions_.size(); ++i) {
      if (result_.inlier[i]) {
        low = std::min(low, result_.arc[i]);
        high = std::max(high, result_.arc[i]);
      }
      if (result_.inlier[i] || result_.distance[i] < kAstray) {
        in_run = 0;
        continue;
      }
      run = in_run == 0 ? 0.0 : run + (positions_[i] - positions_[i - 1]).norm();
      if (++in_run >= kRun) {
        astray += run;
        run = 0.0;
      }
    }
    return (high - low) / std::max(high - low + astray, 1e-9);
  }

  void place_on(const PathState& path) {
    PathProjection projection = project_on(path, positions_);
    result_.arc = std::move(projection.arc);
    result_.distance = std::move(projection.distance);
  }

  [[nodiscard]] TrackFit fit_with(const PoseNoise& noise, bool use_rotation) const {
    return fit_track(binned_.bins, binned_.arcs, start_, {noise, use_rotation, kPrior});
  }

  void fit() {
    noise_ = noise_of(config_.sensor);
    if (config_.sensor == SensorKind::Auto) noise_ = learn_position_noise(binned_.bins, binned_.arcs, start_, noise_);
    best_ = fit_with(noise_, false);
    if (!best_.good) throw ConfigError(name_ + ": no circle or line can be fitted");
    scale_position(noise_, learnt_scale(best_.position_misfit, best_.rows, 6));
    best_ = fit_with(noise_, false);
    start_ = best_.path;
    const bool may_turn = config_.sensor == SensorKind::Robot || config_.sensor == SensorKind::Auto;
    if (!track_.has_rotation || !may_turn) return;
    PoseNoise noise = noise_;
    TrackFit with = fit_with(noise, true);
    if (!with.good) return;
    scale_rotation(noise, learnt_scale(with.rotation_misfit, 3 * best_.rows / 2, 3));
    with = fit_with(noise, true);
    if (!with.good || !grip_is_rigid(with, best_)) return;
    best_ = with;
    noise_ = noise;
    result_.uses_rotation = true;
  }

  // How well the best line through the same bins would do.
  void judge_line() {
    const TrackFit line = fit_track(binned_.bins, binned_.arcs, start_, {noise_, false, kStraightPrior});
    const PathProjection on_line = project_on(line.path, positions_);
    place_on(best_.path);
    result_.rms = rms(result_.distance);
    result_.rms_line = rms(on_line.distance);
  }

  // Squared distance of the curvatures of both halves: beyond the limit the path is neither circle nor line.
  void judge_halves() {
    const auto [low, high] = std::minmax_element(binned_.arcs.begin(), binned_.arcs.end());
    const double middle = 0.5 * (*low + *high);
    const double floor = config_.relative_curvature_floor * best_.path.kap.norm();
    Vector2d change = Vector2d::Zero();
    Eigen::Matrix2d C = 2.0 * floor * floor * Eigen::Matrix2d::Identity();
    double kappa[2] = {0.0, 0.0};
    for (const int half : {0, 1}) {
      BinnedTrack part;
      for (std::size_t i = 0; i < binned_.bins.size(); ++i) {
        if ((binned_.arcs[i] > middle) != (half == 1)) continue;
        part.bins.push_back(binned_.bins[i]);
        part.arcs.push_back(binned_.arcs[i]);
      }
      if (part.bins.size() < 4) return;
      const TrackFit fit = fit_track(part.bins, part.arcs, best_.path, {noise_, false, kPrior});
      if (!fit.good) return;
      kappa[half] = fit.path.kap.norm();
      change += (half == 0 ? -1.0 : 1.0) * (best_.path.F.transpose() * fit.path.curvature()).tail<2>();
      const Eigen::Matrix2d roll = best_.path.F.rightCols<2>().transpose() * fit.path.F.rightCols<2>();
      // What the whole path's misfit added to the noise is not the halves' own.
      const double scale = learnt_scale(fit.position_misfit, fit.rows, 6);
      C += scale * scale * (roll * fit.covariance.block<2, 2>(4, 4) * roll.transpose());
    }
    result_.half_curvature = {kappa[0], kappa[1]};
    result_.against_one_curve = change.dot(C.llt().solve(change));
  }

  [[nodiscard]] double rms(const std::vector<double>& distance) const {
    double sum = 0.0;
    int count = 0;
    for (std::size_t i = 0; i < distance.size(); ++i) {
      if (!result_.inlier[i]) continue;
      sum += distance[i] * distance[i];
      ++count;
    }
    return std::sqrt(sum / std::max(count, 1));
  }

  void decide() {
    const Vector2d& kap = best_.path.kap;
    const auto [low, high] = std::minmax_element(result_.arc.begin(), result_.arc.end());
    const TypeThresholds thresholds = thresholds_of(config_.sensor, *high - *low);
    Eigen::Matrix2d C = best_.covariance.block<2, 2>(4, 4);
    const double floor = config_.relative_curvature_floor * kap.norm();
    result_.curvature_noise_sigma = std::sqrt(C.trace());
    result_.curvature_sigma = std::hypot(result_.curvature_noise_sigma, floor);
    C.diagonal().array() += floor * floor;
    const TypeDistances distances = type_distances(kap, C, thresholds);
    result_.against_slide = distances.slide;
    result_.against_hinge = distances.hinge;
    result_.type = decide_type(kap, C, thresholds);
    if (result_.against_one_curve > kOneCurveLimit || result_.explained < kLeastExplained)
      result_.type = MechanismType::Unknown;
    result_.threshold = thresholds.threshold;
    result_.type_confidence = 1.0 / (1.0 + std::exp(-0.5 * std::abs(distances.slide - distances.hinge)));
  }

  void describe();

  const Track& track_;
  IdentifyConfig config_;
  std::string name_;
  std::vector<Vector3d> positions_;
  Identification result_;
  BinnedTrack binned_;
  PathState start_;
  PoseNoise noise_;
  TrackFit best_;
};

// What the parameters of a path say to people, of the six (a, w, dkap).
struct Description {
  Vector3d direction, axis, point, start;
};

Description describe_path(const PathState& path, double first) {
  Description d;
  PathState moved = path;
  move_along(moved, first);
  d.direction = moved.F.col(0);
  d.start = moved.p;
  const Vector3d k = path.curvature();
  const double kappa = k.norm();
  const bool curved = kappa > kCurved;
  d.axis = curved ? Vector3d(k / kappa) : Vector3d(Vector3d::Zero());
  d.point = curved ? Vector3d(moved.p + k.cross(moved.F.col(0)) / (kappa * kappa)) : moved.p;
  return d;
}

void Identifier::describe() {
  const PathState& path = best_.path;
  const double first = result_.arc.front();
  const Description mean = describe_path(path, first);
  // Derivatives by central differences: the parameters enter smoothly, steps of 1e-6 of metre, radian and 1/m.
  Eigen::Matrix<double, 12, 6> J;
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 6; ++i) {
    Description side[2];
    for (int j = 0; j < 2; ++j) {
      Vector6d d = Vector6d::Zero();
      d[i] = j == 0 ? -kStep : kStep;
      PathState other = path;
      other.p += other.F.rightCols<2>() * d.head<2>();
      other.kap += d.tail<2>();
      other.F = other.F * exp_so3(Vector3d(0.0, d[2], d[3]));
      side[j] = describe_path(other, first);
    }
    J.col(i) << side[1].direction - side[0].direction, side[1].axis - side[0].axis, side[1].point - side[0].point,
        side[1].start - side[0].start;
  }
  J /= 2.0 * kStep;
  Eigen::Matrix<double, 6, 6> C = best_.covariance.topLeftCorner<6, 6>();
  // Furniture's own unevenness changes how much a path curves, not about which axis.
  const Vector2d u = path.kap / std::max(path.kap.norm(), kCurved);
  const double floor2 = std::pow(result_.curvature_sigma, 2) - std::pow(result_.curvature_noise_sigma, 2);
  C.bottomRightCorner<2, 2>() += floor2 * u * u.transpose();
  const Eigen::Matrix<double, 12, 12> S = J * C * J.transpose();
  result_.direction = mean.direction;
  result_.direction_sigma = std::sqrt(S.diagonal().head<3>().sum());
  result_.axis = mean.axis;
  result_.axis_sigma = std::sqrt(S.diagonal().segment<3>(3).sum());
  result_.point = mean.point;
  result_.point_sigma = std::sqrt(S.diagonal().segment<3>(6).sum());
  result_.curvature = path.curvature();
  const double kappa = path.kap.norm();
  result_.radius = kappa > kCurved ? 1.0 / kappa : kInfinity;
  result_.radius_sigma = kappa > kCurved ? result_.curvature_sigma / (kappa * kappa) : kInfinity;
  result_.radius_min = 1.0 / (kappa + 2.0 * result_.curvature_sigma);
  result_.start = mean.start;
  result_.start_sigma = std::sqrt(S.diagonal().tail<3>().sum());
  const auto [low, high] = std::minmax_element(result_.arc.begin(), result_.arc.end());
  result_.length = *high - *low;
  result_.angle = kappa * result_.length;
  for (double& s : result_.arc) s -= first;
  result_.noise = noise_;
}

}  // namespace

void IdentifyConfig::validate() const {
  if (!(grasp_stiffness > 0.0)) throw ConfigError("identify: grasp_stiffness must be > 0 N/m");
  if (!(relative_curvature_floor >= 0.0)) throw ConfigError("identify: relative_curvature_floor must be >= 0");
}

Vector3d Identification::at(double s) const {
  PathState path;
  path.F.col(0) = direction;
  path.F.col(1) = any_perpendicular(direction);
  path.F.col(2) = direction.cross(path.F.col(1));
  path.kap = path.F.rightCols<2>().transpose() * curvature;
  return start + path.F * curve_at(path.kap, s).q;
}

Identification identify(const Track& track, const IdentifyConfig& config, const std::string& name) {
  config.validate();
  return Identifier(track, config, name).run();
}

}  // namespace ajar
