#include "robust_path.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "ajar/core/random.hpp"
#include "ajar/core/so3.hpp"
#include "path_problem.hpp"

namespace ajar {
namespace {

constexpr int kTriples = 500;        // with a fifth of outliers one in two triples is clean; plenty
constexpr double kThinned = 150.0;   // points along the extent that judge and are fitted
constexpr std::size_t kEnough = 60;  // fewer than this: an outlier stretches the extent, halve the distance
constexpr int kHalvings = 20;
constexpr double kStraightTriple = 0.02;  // a circle of more than 50 m is a line here [1/m]
constexpr double kTightest = 12.0;        // r = 8 cm [1/m]
constexpr int kReweightings = 12;
constexpr double kTukey = 4.685;             // 95 % efficiency for normal errors (Holland and Welsch 1977)
constexpr double kLeastWeight = 1e-4;        // keeps the equations regular
constexpr double kRayleighMedian = 1.17741;  // median of the length of two normal components, √(2 ln 2)
constexpr double kLeastScatter = 1e-7;       // below what any sensor resolves [m]
constexpr double kReach = 0.1;               // largest Newton step of a projection [m]

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Points that keep a distance from one another, so that neither a rest nor a walk back outvotes the rest of the path.
std::vector<Vector3d> thinned(std::span<const Vector3d> points) {
  Vector3d low = points[0];
  Vector3d high = points[0];
  for (const Vector3d& p : points) {
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  double apart = (high - low).norm() / kThinned;
  for (int halvings = 0; halvings < kHalvings; ++halvings, apart *= 0.5) {
    std::vector<Vector3d> kept;
    for (const Vector3d& p : points) {
      const bool crowded =
          std::any_of(kept.begin(), kept.end(), [&](const Vector3d& other) { return (p - other).norm() < apart; });
      if (!crowded) kept.push_back(p);
    }
    if (kept.size() >= std::min(kEnough, points.size())) return kept;
  }
  return {points.begin(),
          points.begin() + static_cast<std::ptrdiff_t>(std::min(points.size(), static_cast<std::size_t>(kThinned)))};
}

void set_frame(PathState& path, const Vector3d& x, const Vector3d& k) {
  path.F.col(0) = x;
  path.F.col(1) = any_perpendicular(x);
  path.F.col(2) = x.cross(path.F.col(1));
  path.kap = path.F.rightCols<2>().transpose() * k;
}

// Circle through three points with its tangent at the second, or the line through the outer two.
bool through(const Vector3d& a, const Vector3d& b, const Vector3d& c, PathState& path) {
  const Vector3d u = b - a, v = c - b, w = c - a;
  const double size = u.norm() * v.norm() * w.norm();
  if (!(size > 0.0)) return false;
  const Vector3d k = 2.0 * u.cross(v) / size;
  path.p = b;
  if (k.norm() > kTightest) return false;
  if (k.norm() < kStraightTriple) {
    set_frame(path, w.normalized(), Vector3d::Zero());
    return true;
  }
  // The tangent at b halves the turn from one chord to the other, weighted by the other's length.
  const Vector3d x = (u * v.squaredNorm() + v * u.squaredNorm()).normalized();
  set_frame(path, x, k);
  return true;
}

double distance_to(const PathState& path, const Vector3d& point) {
  const Vector3d v = path.F.transpose() * (point - path.p);
  const Vector3d kl = local_curvature(path.kap);
  const double kappa = kl.norm();
  if (kappa < kStraightTriple) return v.tail<2>().norm();
  const Vector3d from_centre = v - kl.cross(Vector3d::UnitX()) / (kappa * kappa);
  const double height = from_centre.dot(kl) / kappa;
  const double radial = (from_centre - height * kl / kappa).norm();
  return std::hypot(radial - 1.0 / kappa, height);
}

PathState least_median(const std::vector<Vector3d>& points) {
  Random random(1);
  const int count = static_cast<int>(points.size());
  PathState best;
  double best_score = INFINITY;
  std::vector<double> distances(points.size());
  for (int i = 0; i < kTriples; ++i) {
    std::array<int, 3> at{random.index(count), random.index(count), random.index(count)};
    std::sort(at.begin(), at.end());
    const auto point = [&](std::size_t j) -> const Vector3d& { return points[static_cast<std::size_t>(at[j])]; };
    PathState path;
    if (!through(point(0), point(1), point(2), path)) continue;
    for (std::size_t j = 0; j < points.size(); ++j) distances[j] = distance_to(path, points[j]);
    const double score = median(distances);
    if (score < best_score) {
      best_score = score;
      best = path;
    }
  }
  return best;
}

}  // namespace

PathProjection project_on(const PathState& path, std::span<const Vector3d> points) {
  PathProjection projection;
  // The search starts at the point next to the anchor and goes both ways, for an arc of a circle is only found from near it.
  const auto nearest = std::min_element(points.begin(), points.end(), [&path](const Vector3d& a, const Vector3d& b) {
    return (a - path.p).squaredNorm() < (b - path.p).squaredNorm();
  });
  const auto middle = nearest - points.begin();
  const auto count = static_cast<std::ptrdiff_t>(points.size());
  projection.arc.resize(points.size());
  projection.distance.resize(points.size());
  const auto place = [&](std::ptrdiff_t i, double s) {
    const Vector3d v = path.F.transpose() * (points[static_cast<std::size_t>(i)] - path.p);
    CurvePoint point = curve_at(path.kap, s);
    for (int n = 0; n < 8; ++n) {
      s += std::clamp(point.t.dot(v - point.q), -kReach, kReach);
      point = curve_at(path.kap, s);
    }
    projection.arc[static_cast<std::size_t>(i)] = s;
    projection.distance[static_cast<std::size_t>(i)] = (v - point.q).norm();
    return s;
  };
  double s = place(middle, 0.0);
  for (std::ptrdiff_t i = middle + 1; i < count; ++i) s = place(i, s);
  s = projection.arc[static_cast<std::size_t>(middle)];
  for (std::ptrdiff_t i = middle - 1; i >= 0; --i) s = place(i, s);
  return projection;
}

RobustPath fit_robust_path(std::span<const Vector3d> points) {
  const std::vector<Vector3d> kept = thinned(points);
  RobustPath robust;
  robust.path = least_median(kept);

  std::vector<PathBin> bins(kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) bins[i] = {.count = 1.0, .position = kept[i]};
  PathFitConfig config;
  config.noise = {.position_white = 1.0, .position_correlated = 0.0, .position_walk = 0.0};  // weights carry the scale
  config.use_rotation = false;
  config.curvature_prior = 1e6;
  PathProblem<Eigen::Dynamic> problem(bins, config);
  problem.anchor = robust.path;
  const PathProjection start = project_on(robust.path, kept);
  problem.s = Eigen::Map<const Eigen::VectorXd>(start.arc.data(), problem.size);
  problem.find_arcs();
  Eigen::Matrix<double, 9, 9> H;
  for (int i = 0; i < kReweightings; ++i) {
    problem.fill_rows();
    std::vector<double> distance(kept.size());
    for (Eigen::Index j = 0; j < problem.size; ++j) {
      distance[static_cast<std::size_t>(j)] = std::hypot(problem.position[0](j, 0), problem.position[1](j, 0));
    }
    robust.scatter = std::max(median(distance) / kRayleighMedian, kLeastScatter);
    for (Eigen::Index j = 0; j < problem.size; ++j) {
      const double r = distance[static_cast<std::size_t>(j)] / (kTukey * robust.scatter);
      const double weight = r < 1.0 ? (1.0 - r * r) * (1.0 - r * r) : 0.0;
      problem.white[j] = robust.scatter * robust.scatter / std::max(weight, kLeastWeight);
    }
    if (problem.iterate(H) < 0.0) break;
    problem.find_arcs();
  }
  robust.path = problem.anchor;
  return robust;
}

}  // namespace ajar
