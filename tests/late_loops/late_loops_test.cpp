// Strategy: in rigid-body physics the free hand follows told paths at 50 Hz with up to 150 ms on top of what the drives
// need, at every angle between base and path, as the tables of docs/performance.md say; then with odometry of 40 Hz, and
// with a base that is half as slow again as the robot believes. The path is measured from the truth; the tables are printed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <memory>
#include <numbers>
#include <string>
#include <thread>
#include <vector>

#include "ajar/mujoco/mujoco_plant.hpp"
#include "ajar/thesis/experiment.hpp"

namespace ajar {
namespace {

// Way of the hand after which the base keeps its distance [m]. The runs begin 19 cm off it, which closes with 1/s; what
// holds after 20 cm from the right distance is checked by tests/wbc/base_paths_test.cpp.
constexpr double kTurnedIn = 0.45;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kSteady = 4.0;  // last part of a run [s]
// Commanded turning over the last 4 s, peak to peak: a base that closes a centimetre of distance steers by less.
constexpr double kCalmTurning = 0.02;  // [rad/s]

SimulatedPlant make_plant(const PlantRequest& request) {
  SimulatedPlant out;
  out.truth = *request.mechanism;
  auto plant = std::make_unique<MujocoPlant>(request.model, *request.mechanism, request.scenario.plant,
                                             request.start(*request.mechanism), request.home);
  out.witness = plant.get();
  out.plant = std::move(plant);
  return out;
}

ExperimentPlan line(int angle, int delay, const std::vector<std::string>& more) {
  ExperimentPlan plan{"line, " + std::to_string(angle) + "°", "type_3_physics.toml", Contestant::Ours, {}, false};
  plan.overrides = {"control.delay_ms=" + std::to_string(delay), "follow.parking_yaw_deg=" + std::to_string(angle - 90),
                    "follow.start_yaw_deg=" + std::to_string(angle - 90), "follow.start_m=[-1.0,-1.15]"};
  plan.overrides.insert(plan.overrides.end(), more.begin(), more.end());
  return plan;
}

ExperimentPlan arc(const char* name, const char* file, int delay, const std::vector<std::string>& more) {
  ExperimentPlan plan{name, file, Contestant::Ours, {"control.delay_ms=" + std::to_string(delay)}, false};
  if (plan.file == "type_2_physics.toml") plan.overrides.emplace_back("follow.free_about_axis=true");
  plan.overrides.insert(plan.overrides.end(), more.begin(), more.end());
  return plan;
}

struct Seen {
  double path = 0.0;      // largest error [m]
  double distance = 0.0;  // largest difference from 0.75 m after 45 cm [m]
  double heading = 0.0;   // largest error in the last part [rad]
  double turning = 0.0;   // of the command in the last part, peak to peak [rad/s]
  bool completed = false;
};

Seen look_at(const ExperimentRun& run) {
  Seen seen;
  seen.completed = run.result.reason == "goal_reached";
  double most = -1e9;
  double least = 1e9;
  for (const ExperimentSample& s : run.following) {
    const double way = (s.hand - run.following.front().hand).norm();
    seen.path = std::max(seen.path, s.path_error);
    if (way > kTurnedIn) seen.distance = std::max(seen.distance, std::abs(s.distance - 0.75));
    if (s.time < run.following.back().time - kSteady) continue;
    seen.heading = std::max(seen.heading, std::abs(s.heading_error));
    most = std::max(most, s.w);
    least = std::min(least, s.w);
  }
  seen.turning = most - least;
  return seen;
}

struct Allowed {
  double path;      // [m]
  double distance;  // [m]
};

/// Runs lines at 0-180° and two arcs, prints a row each and checks what the caller allows.
void expect_paths_kept(int delay, const Allowed& allowed, const std::vector<std::string>& more = {}) {
  std::vector<ExperimentPlan> plans;
  for (int angle = 0; angle <= 180; angle += 15) plans.push_back(line(angle, delay, more));
  plans.push_back(arc("door, r 0.8 m", "type_1_physics.toml", delay, more));
  plans.push_back(arc("flap, r 0.5 m", "type_2_physics.toml", delay, more));
  const int threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  const std::vector<ExperimentRun> runs = run_experiments(plans, make_plant, {}, threads);
  double worst = 0.0;
  double restless = 0.0;
  for (const ExperimentRun& run : runs) {
    const Seen seen = look_at(run);
    std::printf("%3.0f Hz + %3d ms, %-15s path %5.2f mm, distance %4.1f cm, heading %.2f°, turning %.3f rad/s\n",
                1.0 / run.period, delay, run.plan.name.c_str(), 1e3 * seen.path, 1e2 * seen.distance, seen.heading / kDegree,
                seen.turning);
    EXPECT_LT(seen.heading, 2.0 * kDegree) << run.plan.name;
    EXPECT_TRUE(seen.completed) << run.plan.name << ": " << run.result.reason;
    EXPECT_LT(seen.distance, allowed.distance) << run.plan.name;
    worst = std::max(worst, seen.path);
    restless = std::max(restless, seen.turning);
  }
  EXPECT_LT(worst, allowed.path);
  EXPECT_LT(restless, kCalmTurning);
}

class LateLoops : public ::testing::TestWithParam<int> {};

// What is promised; what is measured is half of it.
TEST_P(LateLoops, KeepThePathAtAnyAngle) { expect_paths_kept(GetParam(), {0.005, 0.02}); }

TEST_P(LateLoops, KeepThePathWithOdometryOf40Hz) {
  expect_paths_kept(GetParam(), {0.005, 0.02}, {"control.rate_hz=500", "plant.base.odometry_hz=40"});
}

TEST_P(LateLoops, AreCalmWithABaseThatIsSlowerThanBelieved) {
  expect_paths_kept(GetParam(), {0.015, 0.03}, {"plant.base.lag_s=0.15", "plant.base.delay_s=0.075"});
}

INSTANTIATE_TEST_SUITE_P(Delays, LateLoops, ::testing::Values(0, 100, 150));

}  // namespace
}  // namespace ajar
