// Arc that the type needs, and how often it is wrong: the whole estimator on hinges of 0.2-1.2 m and slides.
#include <fmt/format.h>

#include <limits>

#include "ajar/estimation/mechanism_estimator.hpp"
#include "ajar/estimation/path_filter.hpp"
#include "ajar/estimation/type_decision.hpp"
#include "cells.hpp"

namespace ajar::bench {
namespace {

constexpr double kWatched = 0.5;        // path over which a type may turn out wrong [m]
constexpr double kWatchedTurn = 1.6;    // or angle, whichever is less [rad]
constexpr double kMostArcRadius = 0.8;  // hinges up to this radius are judged by the arc they need [m]

struct Decision {
  double arc = NAN;
  bool wrong = false;
};

Decision run_track(double radius, bool rotation, Random& rng) {
  const test::TruePath path = test::random_path(radius, rng);
  EstimatorConfig config;
  config.noise = robot_noise();
  config.use_rotation = rotation;
  test::Measured measured(path, config.noise, rng);
  MechanismEstimator estimator(config);
  estimator.reset(path.start(), path.F.col(0));
  const MechanismType truth = radius > 0.0 ? MechanismType::Hinge : MechanismType::Slide;
  const double length = radius > 0.0 ? std::min(kWatched, kWatchedTurn * radius) : kWatched;
  Decision decision;
  for (double s = 0.0; s < length; s += kSpacing) {
    const PathSample sample = measured.at(s);
    EstimatorInput input;
    input.dt = 0.02;
    input.hand.translation() = sample.position;
    input.hand.linear() = sample.rotation;
    input.velocity = kSpacing / input.dt * path.direction(s);
    (void)estimator.update(input);
    const MechanismType type = estimator.estimate().type;
    if (type == truth && std::isnan(decision.arc)) decision.arc = s;
    decision.wrong = decision.wrong || (type != truth && type != MechanismType::Unknown);
  }
  return decision;
}

// The filter with orientation alone: what can be known where the grip is known not to turn.
Decision run_known_grip(double radius, Random& rng) {
  const test::TruePath path = test::random_path(radius, rng);
  PathFilterConfig config;
  config.noise = robot_noise();
  test::Measured measured(path, config.noise, rng);
  PathFilter filter(config);
  const EstimatorConfig estimator;
  const MechanismType truth = radius > 0.0 ? MechanismType::Hinge : MechanismType::Slide;
  const double length = radius > 0.0 ? std::min(kWatched, kWatchedTurn * radius) : kWatched;
  Decision decision;
  for (double s = 0.0; s < length; s += kSpacing) {
    (void)filter.add(measured.at(s));
    if (!filter.started()) continue;
    const PathOutput out = filter.output();
    Eigen::Matrix2d C = out.covariance.block<2, 2>(4, 4);
    C.diagonal().array() += std::pow(estimator.relative_curvature_floor * out.kap.norm(), 2);
    const MechanismType type = decide_type(out.kap, C,
                                           {.slide_curvature = estimator.slide_curvature,
                                            .hinge_curvature = estimator.hinge_curvature,
                                            .threshold = estimator.type_threshold,
                                            .slide_threshold = estimator.slide_threshold});
    if (type == truth && std::isnan(decision.arc)) decision.arc = s;
    decision.wrong = decision.wrong || (type != truth && type != MechanismType::Unknown);
  }
  return decision;
}

enum class Evidence { KnownGrip, Orientation, Positions };

}  // namespace

void judge_types(const Effort& effort, Table& table) {
  for (const Evidence evidence : {Evidence::KnownGrip, Evidence::Orientation, Evidence::Positions}) {
    const bool rotation = evidence != Evidence::Positions;
    Random rng(effort.seed + 29);
    const int runs = 25 * effort.runs / 2;
    std::vector<double> hinges, slides;
    int wrong = 0;
    int never = 0;
    for (int run = 0; run < runs; ++run) {
      const double radius = run % 4 == 0 ? 0.0 : rng.uniform(0.2, 1.2);
      const Decision decision =
          evidence == Evidence::KnownGrip ? run_known_grip(radius, rng) : run_track(radius, rotation, rng);
      wrong += decision.wrong ? 1 : 0;
      const double arc = std::isnan(decision.arc) ? std::numeric_limits<double>::infinity() : decision.arc;
      never += std::isnan(decision.arc) ? 1 : 0;
      if (radius == 0.0) slides.push_back(arc);
      if (radius > 0.0 && radius <= kMostArcRadius) hinges.push_back(arc);
    }
    const std::string name = evidence == Evidence::KnownGrip     ? "type, with orientation, grip known"
                             : evidence == Evidence::Orientation ? "type, with orientation"
                                                                 : "type, positions";
    const double hinge = 100.0 * quantile(hinges, 0.9);
    const double slide = 100.0 * quantile(slides, 0.9);
    const double hinge_bar = rotation ? 4.0 : 12.0;
    const double slide_bar = rotation ? 7.0 : 20.0;
    table.push_back(
        {name + ": arc p90, hinges up to 0.8 m", "ajar", hinge, "cm", fmt::format("<= {}", hinge_bar), hinge <= hinge_bar});
    table.push_back({name + ": arc p90, slides", "ajar", slide, "cm", fmt::format("<= {}", slide_bar), slide <= slide_bar});
    table.push_back({fmt::format("{}: ever wrong, of {} runs", name, runs), "ajar", double(wrong) / runs, "-", "<= 0.001",
                     wrong <= 0.001 * runs});
    table.push_back({fmt::format("{}: undecided after {:.1f} m, of {} runs", name, kWatched, runs), "ajar",
                     double(never) / runs, "-", ""});
  }
}

}  // namespace ajar::bench
