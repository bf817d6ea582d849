// Strategy: Monte Carlo on paths that are exactly circles or lines, with errors drawn from the stated noise model, against
// the Cramér-Rao bound of the same model (computed in tracks.hpp with dense matrices): the filter must neither be worse than
// the bound nor claim more than it knows. Faults (rest, slip, outliers, wrong noise level, NaN) are injected one at a time.
// Left out: real tracks, and noise whose correlation length is wrong (it cannot be learnt on line).
#include "ajar/estimation/path_filter.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cstdio>

#include "ajar/core/error.hpp"
#include "tracks.hpp"

namespace ajar {
namespace {

using test::kDegree;
using test::Measured;
using test::TruePath;

constexpr double kSpacing = 0.002;  // 0.1 m/s at 50 Hz
constexpr std::array<double, 5> kLengths = {0.05, 0.1, 0.2, 0.4, 0.8};

PoseNoise robot_noise() {
  PoseNoise noise;
  noise.rotation_white = 0.1 * kDegree;
  noise.rotation_correlated = 0.2 * kDegree;
  noise.position_walk = noise.rotation_walk = 0.0;
  return noise;
}

struct Cell {
  double direction2 = 0.0, curvature2 = 0.0;  // sums of squares over the bound
  int inside = 0, total = 0, runs = 0, alarms = 0;
};

// Runs one path and compares at each length.
void run_track(double radius, bool rotation, Random& rng, const std::array<Matrix9d, 5>& bounds,
               std::array<Cell, 5>& cells) {
  const PoseNoise noise = robot_noise();
  const TruePath path = test::random_path(radius, rng);
  Measured measured(path, noise, rng);
  PathFilterConfig config;
  config.noise = noise;
  config.use_rotation = rotation;
  PathFilter filter(config);
  std::size_t next = 0;
  for (double s = 0.0; s < kLengths.back() + 1e-9 && next < kLengths.size(); s += kSpacing) {
    const PathSample sample = measured.at(s);
    (void)filter.add(sample);
    if (s < kLengths[next] - 1e-9) continue;
    Cell& cell = cells[next];
    const Matrix9d& bound = bounds[next];
    ++next;
    if (!filter.started()) continue;
    const PathOutput out = filter.peek(sample.position);
    const Vector4d e = test::own_gauge_error(out, path, s);
    cell.direction2 += e.head<2>().squaredNorm() / (bound(2, 2) + bound(3, 3));
    cell.curvature2 += e.tail<2>().squaredNorm() / (bound(4, 4) + bound(5, 5));
    for (int i = 0; i < 4; ++i) cell.inside += std::abs(e[i]) < 2.0 * std::sqrt(out.covariance(2 + i, 2 + i)) ? 1 : 0;
    cell.total += 4;
    cell.runs += 1;
    cell.alarms += filter.alarms();
  }
}

void check_bound(bool rotation) {
  constexpr int kRuns = 60;
  for (const double radius : {0.3, 0.6, 0.9, 0.0}) {
    Random rng(radius > 0.0 ? static_cast<std::uint64_t>(1000.0 * radius) : 7U);
    std::array<Matrix9d, 5> bounds;
    const Vector2d kap(radius > 0.0 ? 1.0 / radius : 0.0, 0.0);
    for (std::size_t i = 0; i < kLengths.size(); ++i) {
      bounds[i] = test::cramer_rao(kap, kLengths[i], kSpacing, robot_noise(), rotation, 3.0);
    }
    std::array<Cell, 5> cells;
    for (int run = 0; run < kRuns; ++run) run_track(radius, rotation, rng, bounds, cells);
    int alarms = 0;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const Cell& cell = cells[i];
      const double direction = std::sqrt(cell.direction2 / cell.runs);
      const double curvature = std::sqrt(cell.curvature2 / cell.runs);
      const double coverage = static_cast<double>(cell.inside) / cell.total;
      std::printf("r %.1f, %.2f m: direction %.2f, curvature %.2f of the bound, coverage %.3f\n", radius, kLengths[i],
                  direction, curvature, coverage);
      EXPECT_EQ(cell.runs, kRuns);
      // 60 runs of two components scatter by 9 %; below 1 at the start because the prior is right by construction.
      EXPECT_LT(direction, 1.3);
      EXPECT_LT(curvature, 1.3);
      EXPECT_GT(direction, rotation || kLengths[i] > 0.06 ? 0.75 : 0.5);
      EXPECT_GT(curvature, rotation || kLengths[i] > 0.06 ? 0.75 : 0.5);
      EXPECT_GE(coverage, 0.88);
      alarms = cell.alarms;
    }
    EXPECT_EQ(alarms, 0) << "false alarms";
  }
}

TEST(PathFilter, ReachesTheCramerRaoBoundWithOrientation) { check_bound(true); }
TEST(PathFilter, ReachesTheCramerRaoBoundWithPositionsOnly) { check_bound(false); }

TEST(PathFilter, RestAtTheStartOpensNoBins) {
  Random rng(3);
  PathFilterConfig config;
  config.noise = robot_noise();
  int starts = 0;
  double worst = 0.0;
  for (int run = 0; run < 20; ++run) {
    const TruePath path = test::random_path(0.6, rng);
    Measured measured(path, config.noise, rng);
    PathFilter filter(config);
    int closed = 0;
    for (int i = 0; i < 1000; ++i) closed += filter.add(measured.at(0.0)) == PathEvent::BinClosed ? 1 : 0;
    EXPECT_EQ(closed, 0);
    for (double s = 0.0; s < 0.1; s += 0.0002) starts += filter.add(measured.at(s)) == PathEvent::Started ? 1 : 0;
    worst = std::max(worst, test::own_gauge_error(filter.output(), path, 0.1).head<2>().norm());
  }
  EXPECT_EQ(starts, 20);
  EXPECT_LT(worst, 2.5 * kDegree);  // four sigma of the 0.6° of the bound at 10 cm
}

TEST(PathFilter, NoiseStatedThreeTimesTooSmallIsLearnt) {
  Random rng(5);
  PathFilterConfig config;
  config.noise = robot_noise();
  PoseNoise real = config.noise;
  real.position_white *= 3.0;
  real.position_correlated *= 3.0;
  real.rotation_white *= 3.0;
  real.rotation_correlated *= 3.0;
  int inside = 0;
  constexpr int kRuns = 60;
  for (int run = 0; run < kRuns; ++run) {
    const TruePath path = test::random_path(0.6, rng);
    Measured measured(path, real, rng);
    PathFilter filter(config);
    for (double s = 0.0; s < 0.4; s += kSpacing) (void)filter.add(measured.at(s));
    const PathOutput out = filter.output();
    const Vector4d e = test::own_gauge_error(out, path, 0.4);
    for (int i = 0; i < 4; ++i) inside += std::abs(e[i]) < 2.0 * std::sqrt(out.covariance(2 + i, 2 + i)) ? 1 : 0;
    EXPECT_GT(filter.noise_scale(), 3.0);
  }
  EXPECT_GE(inside, static_cast<int>(0.85 * 4 * kRuns));
}

TEST(PathFilter, SlipAcrossTheMotionRaisesAnAlarmAndIsForgotten) {
  Random rng(9);
  PathFilterConfig config;
  config.noise = robot_noise();
  int found = 0;
  int good = 0;
  constexpr int kRuns = 30;
  for (int run = 0; run < kRuns; ++run) {
    const TruePath path = test::random_path(0.6, rng);
    Measured measured(path, config.noise, rng);
    PathFilter filter(config);
    Vector3d slip = rng.direction();
    slip = 0.01 * (slip - path.direction(0.25) * path.direction(0.25).dot(slip)).normalized();
    int alarmed_at = 0;
    for (double s = 0.0; s < 0.35; s += kSpacing) {
      PathSample sample = measured.at(s);
      if (s > 0.25) sample.position += path.turn(s - 0.25) * slip;
      if (filter.add(sample) == PathEvent::Alarm && alarmed_at == 0) alarmed_at = static_cast<int>(1000.0 * (s - 0.25));
    }
    found += alarmed_at > 0 && alarmed_at < 30 ? 1 : 0;
    good += test::own_gauge_error(filter.output(), path, 0.35).head<2>().norm() < 2.0 * kDegree ? 1 : 0;
  }
  EXPECT_GE(found, 27);  // 1 cm within 3 cm of arc in 90 %
  EXPECT_GE(good, 27);
}

TEST(PathFilter, SlipThatGoesOnAfterTheAlarmIsNotTakenForATurnOfThePath) {
  Random rng(10);
  PathFilterConfig config;
  config.noise = robot_noise();
  int good = 0;
  for (int run = 0; run < 30; ++run) {
    const TruePath path = test::random_path(0.6, rng);
    Measured measured(path, config.noise, rng);
    PathFilter filter(config);
    const Vector3d across = path.F.col(1 + run % 2);
    for (double s = 0.0; s < 0.37; s += kSpacing) {
      PathSample sample = measured.at(s);
      sample.position += 0.01 * std::clamp((s - 0.25) / 0.02, 0.0, 1.0) * (path.turn(s) * across);
      (void)filter.add(sample);
    }
    // Across the axis by 1 cm the mechanism's own direction changes by up to 1/60 rad, 0.95°.
    good += test::own_gauge_error(filter.output(), path, 0.37).head<2>().norm() < 2.0 * kDegree ? 1 : 0;
  }
  EXPECT_GE(good, 27);
}

TEST(PathFilter, DriftOfTheBaseAlongThePathDoesNotMakeTheDirectionSurer) {
  // 2 cm/√m: 0.9 mm in each 2 mm of way, along the path as well as across it. Errors of the stated size are 2σ in 95 %.
  Random rng(11);
  PathFilterConfig config;
  config.noise = robot_noise();
  config.noise.position_walk = 4e-4;
  config.use_rotation = false;
  int inside = 0;
  constexpr int kRuns = 100;
  for (int run = 0; run < kRuns; ++run) {
    TruePath path = test::random_path(0.0, rng);
    Measured measured(path, config.noise, rng);
    PathFilter filter(config);
    Vector3d drift = Vector3d::Zero();
    for (double s = 0.0; s < 0.8; s += kSpacing) {
      PathSample sample = measured.at(s);
      drift += rng.normal3(0.02 * std::sqrt(kSpacing));
      sample.position += drift;
      sample.base_travel = kSpacing;
      (void)filter.add(sample);
    }
    path.origin += drift;
    const PathOutput out = filter.output();
    const Vector4d error = test::own_gauge_error(out, path, 0.8);
    for (int i = 0; i < 2; ++i) inside += std::abs(error[i]) < 2.0 * std::sqrt(out.covariance(2 + i, 2 + i)) ? 1 : 0;
  }
  EXPECT_GE(inside, 172);  // of 200, 3 standard deviations below 0.92
}

TEST(PathFilter, RestartsWhenTheMechanismItselfChanges) {
  // A lever of 10 cm for 6 cm of arc, then a door 30° to 80° off.
  Random rng(12);
  PathFilterConfig config;
  config.noise = robot_noise();
  int good = 0;
  for (int run = 0; run < 20; ++run) {
    const TruePath lever = test::random_path(0.1, rng);
    TruePath door = test::random_path(0.7, rng);
    Vector3d axis = rng.direction().cross(lever.direction(0.06)).normalized();
    const Vector3d x = exp_so3(rng.uniform(30.0, 80.0) * kDegree * axis) * lever.direction(0.06);
    axis = door.F.col(0).cross(x);
    door.F = exp_so3(axis.normalized() * std::atan2(axis.norm(), door.F.col(0).dot(x))) * door.F;
    door.origin = lever.position(0.06);
    door.grasp = lever.turn(0.06) * lever.grasp;
    Measured first(lever, config.noise, rng);
    Measured second(door, config.noise, rng);
    PathFilter filter(config);
    for (double s = 0.0; s < 0.06; s += kSpacing) (void)filter.add(first.at(s));
    for (double s = 0.0; s < 0.15; s += kSpacing) (void)filter.add(second.at(s));
    EXPECT_GE(filter.alarms(), 1);
    good += test::own_gauge_error(filter.output(), door, 0.15).head<2>().norm() < 3.0 * kDegree ? 1 : 0;
  }
  EXPECT_GE(good, 18);
}

TEST(PathFilter, SingleOutliersAreLeftOut) {
  Random rng(15);
  PathFilterConfig config;
  config.noise = robot_noise();
  const TruePath path = test::random_path(0.6, rng);
  Measured measured(path, config.noise, rng);
  PathFilter filter(config);
  int rejected = 0;
  int i = 0;
  for (double s = 0.0; s < 0.4; s += kSpacing) {
    PathSample sample = measured.at(s);
    if (s > 0.1 && ++i % 20 == 0) sample.position += 0.05 * path.F.col(1);
    rejected += filter.add(sample) == PathEvent::Rejected ? 1 : 0;
  }
  EXPECT_GE(rejected, 7);
  EXPECT_EQ(filter.alarms(), 0);
  EXPECT_LT(test::own_gauge_error(filter.output(), path, 0.4).head<2>().norm(), 1.0 * kDegree);
}

TEST(PathFilter, IgnoresNumbersThatAreNotFinite) {
  Random rng(16);
  PathFilterConfig config;
  config.noise = robot_noise();
  const TruePath path = test::random_path(0.6, rng);
  Measured measured(path, config.noise, rng);
  PathFilter filter(config);
  for (double s = 0.0; s < 0.1; s += kSpacing) (void)filter.add(measured.at(s));
  const PathOutput before = filter.output();
  PathSample bad = measured.at(0.1);
  bad.position.x() = std::nan("");
  EXPECT_EQ(filter.add(bad), PathEvent::Invalid);
  bad = measured.at(0.1);
  bad.rotation(1, 1) = INFINITY;
  EXPECT_EQ(filter.add(bad), PathEvent::Invalid);
  EXPECT_EQ(filter.output().F, before.F);
  EXPECT_EQ(filter.output().covariance, before.covariance);
}

TEST(PathFilter, RefusesNoiseThatIsNotPositive) {
  PathFilterConfig config;
  config.noise.position_white = 0.0;
  EXPECT_THROW(PathFilter{config}, ConfigError);
  config = PathFilterConfig();
  config.noise.correlation_length = std::nan("");
  EXPECT_THROW(PathFilter{config}, ConfigError);
}

}  // namespace
}  // namespace ajar
