// Other ways to the same figures, on the same tracks: the adaptive laws of the thesis and of the force loop, two circle
// fits, a choice of line or circle by an information criterion; beside the recursive filter and the bound.
#include <fmt/format.h>

#include <functional>

#include "ajar/estimation/direction_law.hpp"
#include "ajar/estimation/path_filter.hpp"
#include "cells.hpp"
#include "circle_fits.hpp"

namespace ajar::bench {
namespace {

constexpr double kGuessError = 30.0 * test::kDegree;  // of the adaptive laws, which cannot start from nothing
constexpr double kSpeed = 0.1;                        // [m/s]
constexpr double kSubstep = 0.002;                    // [s]
constexpr double kLowPass = 2.0;                      // of the differentiated positions [Hz]
constexpr double kBandwidth = 1.5;                    // w0 [1/s]
constexpr double kStiffness = 1e4;                    // of the grasp in the force loop [N/m]
constexpr double kForceGain = 2e-3;                   // α_f [m/(N s)]
constexpr double kForceIntegral = 0.7e-3;             // β [m/(N s²)]
constexpr double kForceNoise = 0.4;                   // [N]

struct Estimate {
  Vector3d x, k, p;
};

using Estimates = std::array<Estimate, kLengths.size()>;

Vector3d wrong_guess(const test::TruePath& path, Random& rng) {
  Vector3d axis = rng.direction();
  axis -= path.F.col(0) * path.F.col(0).dot(axis);
  return exp_so3(kGuessError * axis.normalized()) * path.F.col(0);
}

// Fed with the measured velocity of the hand, low-passed; the direction belongs to the point where the low pass is.
void run_thesis_law(const std::vector<PathSample>& samples, const test::TruePath& path, Random& rng, Estimates& out) {
  DirectionState law{wrong_guess(path, rng), Vector3d::Zero()};
  const double dt = kSpacing / kSpeed;
  const double share = 1.0 - std::exp(-2.0 * std::numbers::pi * kLowPass * dt);
  Vector3d velocity = kSpeed * law.x;
  std::size_t next = 0;
  for (std::size_t i = 1; i < samples.size() && next < kLengths.size(); ++i) {
    velocity += share * ((samples[i].position - samples[i - 1].position) / dt - velocity);
    const double speed = law.x.dot(velocity);
    AdaptiveGains gains = adaptive_gains(kBandwidth, 1.0, speed);
    for (double t = 0.0; t < dt - 1e-9; t += kSubstep) law = step_adaptive_law(law, velocity, speed, gains, kSubstep);
    if (static_cast<double>(i) * kSpacing > kLengths[next] - 1e-9) out[next++] = {law.x, law.k, samples[i].position};
  }
}

// Fed with the normal force that its own wrong direction makes in an elastic grasp, as in the force loop.
void run_force_law(const test::TruePath& path, Random& rng, Estimates& out) {
  DirectionState law{wrong_guess(path, rng), Vector3d::Zero()};
  Vector3d hand = path.origin;
  Vector3d integral = Vector3d::Zero();
  double s = 0.0;
  std::size_t next = 0;
  for (int tick = 0; tick < 20000 && next < kLengths.size(); ++tick) {
    const Vector3d t = path.direction(s);
    s += t.dot(hand - path.position(s));
    const Vector3d force = kStiffness * (hand - path.position(s)) + rng.normal3(kForceNoise);
    const Vector3d normal = force - law.x * law.x.dot(force);
    integral += kSubstep * normal;
    integral -= law.x * law.x.dot(integral);
    const Vector3d correction = kForceGain * normal + kForceIntegral * integral;
    const Vector3d velocity = kSpeed * law.x - correction;
    law = step_adaptive_law(law, velocity, kSpeed, adaptive_gains(kBandwidth, 1.0, kSpeed), kSubstep);
    hand += kSubstep * velocity;
    if (s > kLengths[next]) out[next++] = {law.x, law.k, path.position(s)};
  }
}

void run_fit(const std::vector<PathSample>& samples, const std::function<PointFit(std::span<const Vector3d>)>& fit,
             Estimates& out) {
  std::vector<Vector3d> points;
  for (const PathSample& sample : samples) points.push_back(sample.position);
  for (std::size_t i = 0; i < kLengths.size(); ++i) {
    const auto count = std::min(points.size(), static_cast<std::size_t>(kLengths[i] / kSpacing + 1.5));
    const PointFit found = fit(std::span<const Vector3d>(points).first(count));
    out[i] = {found.direction, found.curvature, found.point};
  }
}

void run_filter(const std::vector<PathSample>& samples, bool rotation, Estimates& out) {
  PathFilterConfig config;
  config.noise = robot_noise();
  config.use_rotation = rotation;
  PathFilter filter(config);
  std::size_t next = 0;
  for (std::size_t i = 0; i < samples.size() && next < kLengths.size(); ++i) {
    (void)filter.add(samples[i]);
    if (static_cast<double>(i) * kSpacing < kLengths[next] - 1e-9) continue;
    const PathOutput found = filter.peek(samples[i].position);
    out[next++] = {found.F.col(0), found.curvature(), found.point};
  }
}

struct Contestant {
  std::string name;
  std::function<void(const std::vector<PathSample>&, const test::TruePath&, Random&, Estimates&)> run;
};

std::vector<Contestant> contestants() {
  using Samples = std::vector<PathSample>;
  const auto fit = [](const std::function<PointFit(std::span<const Vector3d>)>& method) {
    return
        [method](const Samples& samples, const test::TruePath&, Random&, Estimates& out) { run_fit(samples, method, out); };
  };
  return {{"ajar", [](const Samples& s, const test::TruePath&, Random&, Estimates& out) { run_filter(s, true, out); }},
          {"ajar, positions",
           [](const Samples& s, const test::TruePath&, Random&, Estimates& out) { run_filter(s, false, out); }},
          {"adaptive law, velocity", [](const Samples& s, const test::TruePath& path, Random& rng,
                                        Estimates& out) { run_thesis_law(s, path, rng, out); }},
          {"adaptive law, force",
           [](const Samples&, const test::TruePath& path, Random& rng, Estimates& out) { run_force_law(path, rng, out); }},
          {"circle fit, algebraic", fit(fit_circle_algebraic)},
          {"circle fit, geometric", fit([](std::span<const Vector3d> points) { return fit_circle_geometric(points); })},
          {"line or circle by BIC", fit(fit_by_bic)}};
}

// The error at the point of the path next to the estimate, in the plane across the estimated direction.
Vector4d error_of(const Estimate& estimate, const test::TruePath& path, double s) {
  PathOutput out;
  out.F.col(0) = estimate.x.normalized();
  out.F.col(1) = any_perpendicular(estimate.x).normalized();
  out.F.col(2) = out.F.col(0).cross(out.F.col(1));
  out.kap = out.F.rightCols<2>().transpose() * estimate.k;
  out.point = estimate.p;
  return test::own_gauge_error(out, path, s);
}

}  // namespace

void judge_peers(const Effort& effort, Table& table) {
  for (const double radius : {0.8, 0.0}) {
    for (const Contestant& contestant : contestants()) {
      Random rng(effort.seed + 61);
      std::array<std::vector<double>, kLengths.size()> direction, curvature;
      for (int run = 0; run < effort.runs / 4; ++run) {
        const test::TruePath path = test::random_path(radius, rng);
        test::Measured measured(path, robot_noise(), rng);
        std::vector<PathSample> samples;
        for (double s = 0.0; s < kLengths.back() + 0.5 * kSpacing; s += kSpacing) samples.push_back(measured.at(s));
        Random own(effort.seed + static_cast<std::uint64_t>(run));
        Estimates estimates;
        contestant.run(samples, path, own, estimates);
        for (std::size_t i = 0; i < kLengths.size(); ++i) {
          const Vector4d error = error_of(estimates[i], path, kLengths[i]);
          direction[i].push_back(error.head<2>().squaredNorm());
          curvature[i].push_back(error.tail<2>().squaredNorm());
        }
      }
      const auto rms = [](const std::vector<double>& squares) {
        double sum = 0.0;
        for (const double s : squares) sum += s;
        return std::sqrt(sum / static_cast<double>(squares.size()));
      };
      for (std::size_t i = 0; i < kLengths.size(); ++i) {
        const std::string cell = fmt::format("{}, {:.0f} cm", radius > 0.0 ? "r 0.8 m" : "slide", 100.0 * kLengths[i]);
        table.push_back({cell + ": direction, RMS", contestant.name, rms(direction[i]) / test::kDegree, "deg", ""});
        table.push_back({cell + ": curvature, RMS", contestant.name, rms(curvature[i]), "1/m", ""});
      }
    }
    for (std::size_t i = 0; i < kLengths.size(); ++i) {
      const Vector2d kap(radius > 0.0 ? 1.0 / radius : 0.0, 0.0);
      for (const bool rotation : {true, false}) {
        const Matrix9d C = test::cramer_rao(kap, kLengths[i], kSpacing, robot_noise(), rotation, kPrior);
        const std::string cell = fmt::format("{}, {:.0f} cm", radius > 0.0 ? "r 0.8 m" : "slide", 100.0 * kLengths[i]);
        const std::string name = rotation ? "bound" : "bound, positions";
        table.push_back({cell + ": direction, RMS", name, std::sqrt(C(2, 2) + C(3, 3)) / test::kDegree, "deg", ""});
        table.push_back({cell + ": curvature, RMS", name, std::sqrt(C(4, 4) + C(5, 5)), "1/m", ""});
      }
    }
  }
}

}  // namespace ajar::bench
