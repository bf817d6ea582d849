// Stated uncertainty when the noise is stated three times wrong, and while the base that carries the arm drifts.
#include <fmt/format.h>

#include "ajar/estimation/path_filter.hpp"
#include "cells.hpp"

namespace ajar::bench {
namespace {

constexpr double kFreeTravel = 0.05;               // the base stands during the first centimetres [m]
constexpr double kLever = 0.74;                    // of the hand about the base [m]
constexpr double kWalkPosition = 0.02;             // [m/√m]
constexpr double kWalkTurn = 1.0 * test::kDegree;  // [rad/√m]
constexpr double kFloor = 0.1;                     // of σ_k over |k|: as stated to the mission

struct Wrong {
  double factor = 1.0;  // true noise over stated noise
  bool drift = false;
};

void run_track(double radius, bool rotation, const Wrong& wrong, Random& rng, std::array<Tally, kLengths.size()>& tallies) {
  const test::TruePath path = test::random_path(radius, rng);
  PathFilterConfig config;
  config.noise = robot_noise();
  config.use_rotation = rotation;
  if (wrong.drift) {
    config.noise.position_walk = kWalkPosition * kWalkPosition + std::pow(kLever * kWalkTurn, 2);
    config.noise.rotation_walk = kWalkTurn * kWalkTurn;
  }
  test::Measured measured(path, scaled(robot_noise(), wrong.factor), rng);
  PathFilter filter(config);
  // What odometry says of the hand: every step of the way is turned by the yaw error so far.
  Vector3d drifted = path.origin;
  double yaw = 0.0;
  const double ahead = rng.uniform(-std::numbers::pi, std::numbers::pi);
  std::size_t next = 0;
  for (double s = 0.0; next < kLengths.size(); s += kSpacing) {
    if (radius > 0.0 && kLengths[next] > kMostTurn * radius) break;
    PathSample sample = measured.at(s);
    const Vector3d error = sample.position - path.position(s);
    if (s > 0.0) drifted += exp_so3(Vector3d(0.0, 0.0, yaw)) * (path.position(s) - path.position(s - kSpacing));
    if (wrong.drift && s > kFreeTravel) {
      sample.base_travel = kSpacing;
      const Vector3d step = rng.normal3(kWalkPosition * std::sqrt(kSpacing));
      const double turn = rng.normal(kWalkTurn * std::sqrt(kSpacing));
      // The hand, ahead of the base, swings about it.
      const double bearing = ahead + yaw;
      drifted += Vector3d(step.x(), step.y(), 0.0) + turn * kLever * Vector3d(-std::sin(bearing), std::cos(bearing), 0.0);
      yaw += turn;
    }
    sample.position = drifted + error;
    sample.rotation = exp_so3(Vector3d(0.0, 0.0, yaw)) * sample.rotation;
    (void)filter.add(sample);
    if (s < kLengths[next] - 1e-9) continue;
    Tally& tally = tallies[next++];
    if (!filter.started()) continue;
    // The truth in the drifted odometry frame, in which the estimate is made and used.
    test::TruePath seen = path;
    const Matrix3d turned = exp_so3(Vector3d(0.0, 0.0, yaw));
    seen.origin = drifted - turned * (path.position(s) - path.origin);
    seen.F = turned * path.F;
    const PathOutput out = filter.peek(sample.position);
    Eigen::Matrix4d C = out.covariance.block<4, 4>(2, 2);
    C.bottomRightCorner<2, 2>().diagonal().array() += std::pow(kFloor * out.kap.norm(), 2);
    tally.add(test::own_gauge_error(out, seen, s), C);
  }
}

void judge(const char* name, const Wrong& wrong, const Effort& effort, Table& table) {
  for (const bool rotation : {true, false}) {
    std::array<Tally, kLengths.size()> tallies;
    for (const double radius : {0.4, 0.8, 0.0}) {
      Random rng(effort.seed + 17 + static_cast<std::uint64_t>(1000.0 * radius));
      for (int run = 0; run < effort.runs; ++run) run_track(radius, rotation, wrong, rng, tallies);
    }
    for (std::size_t i = 0; i < kLengths.size(); ++i) {
      const bool asked = kLengths[i] > 0.19;
      const double coverage = tallies[i].coverage();
      table.push_back({fmt::format("{}, {}, {:.0f} cm: within 2 sigma", name, rotation ? "with orientation" : "positions",
                                   100.0 * kLengths[i]),
                       "ajar", coverage, "-", asked ? ">= 0.92" : "", !asked || coverage >= 0.92});
    }
  }
}

}  // namespace

void judge_honesty(const Effort& effort, Table& table) {
  judge("noise three times the stated", {.factor = 3.0}, effort, table);
  judge("noise a third of the stated", {.factor = 1.0 / 3.0}, effort, table);
  judge("odometry walks 2 cm and 1 degree per root metre", {.drift = true}, effort, table);
}

}  // namespace ajar::bench
