// The recursive filter against the Cramér-Rao bound computed for the same samples, in the filter's own gauge.
#include <fmt/format.h>

#include "ajar/estimation/path_filter.hpp"
#include "cells.hpp"

namespace ajar::bench {
namespace {

struct Kind {
  const char* name;
  PoseNoise noise;
  bool rotation;
  double bar;  // of RMS over bound
};

constexpr int kMoreRuns = 4;  // 192 cells are judged by 2 % of their mean: 1600 runs tell that

using Tallies = std::array<Tally, kLengths.size()>;

void run_track(double radius, const Kind& kind, Random& rng, Tallies& tallies) {
  const test::TruePath path = test::random_path(radius, rng);
  test::Measured measured(path, kind.noise, rng);
  PathFilterConfig config;
  config.noise = kind.noise;
  config.use_rotation = kind.rotation;
  config.curvature_prior = kPrior;
  PathFilter filter(config);
  std::size_t next = 0;
  for (double s = 0.0; next < kLengths.size(); s += kSpacing) {
    if (radius > 0.0 && kLengths[next] > kMostTurn * radius) break;
    const PathSample sample = measured.at(s);
    (void)filter.add(sample);
    if (s < kLengths[next] - 1e-9) continue;
    Tally& tally = tallies[next++];
    if (!filter.started()) continue;
    const PathOutput out = filter.peek(sample.position);
    tally.add(test::own_gauge_error(out, path, s), out.covariance.block<4, 4>(2, 2));
    tally.alarms = std::max(tally.alarms, 0) + (filter.alarms() > 0 ? 1 : 0);
  }
}

}  // namespace

void judge_bound(const Effort& effort, Table& table) {
  const std::array kinds{Kind{"white, with orientation", white_noise(), true, 1.1},
                         Kind{"white, positions", white_noise(), false, 1.1},
                         Kind{"correlated, with orientation", robot_noise(), true, 1.15},
                         Kind{"correlated, positions", robot_noise(), false, 1.15}};
  for (const Kind& kind : kinds) {
    for (const double radius : {0.2, 0.4, 0.8, 1.5, 0.0}) {
      Random rng(effort.seed + static_cast<std::uint64_t>(1000.0 * radius));
      Tallies tallies;
      for (int run = 0; run < kMoreRuns * effort.runs; ++run) run_track(radius, kind, rng, tallies);
      for (std::size_t i = 0; i < kLengths.size(); ++i) {
        const Tally& tally = tallies[i];
        if (tally.runs == 0) continue;
        const Vector2d kap(radius > 0.0 ? 1.0 / radius : 0.0, 0.0);
        const Matrix9d bound = test::cramer_rao(kap, kLengths[i], kSpacing, kind.noise, kind.rotation, kPrior);
        const std::string cell = fmt::format(
            "{}, {}, {:.0f} cm", kind.name, radius > 0.0 ? fmt::format("r {:.1f} m", radius) : "slide", 100.0 * kLengths[i]);
        const double direction = tally.direction() / std::sqrt(bound(2, 2) + bound(3, 3));
        const double curvature = tally.curvature() / std::sqrt(bound(4, 4) + bound(5, 5));
        const std::string bar = fmt::format("<= {}", kind.bar);
        table.push_back({cell + ": direction, RMS over bound", "ajar", direction, "-", bar, direction <= kind.bar});
        table.push_back({cell + ": curvature, RMS over bound", "ajar", curvature, "-", bar, curvature <= kind.bar});
        const double coverage = tally.coverage();
        table.push_back(
            {cell + ": within 2 sigma", "ajar", coverage, "-", "0.94-0.97", coverage >= 0.94 && coverage <= 0.97});
        const double nees = tally.nees_mean();
        table.push_back({cell + ": error squared over its mean", "ajar", nees, "-", "0.9-1.1", nees >= 0.9 && nees <= 1.1});
        table.push_back({cell + ": runs with a false alarm", "ajar", double(tally.alarms) / tally.runs, "-", "<= 0.001",
                         tally.alarms <= 0.001 * tally.runs});
      }
    }
  }
}

}  // namespace ajar::bench
