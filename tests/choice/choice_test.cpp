// Strategy: a robot that knows nothing but the handle chooses how to take it, and must then open every mechanism for which
// it chose: whole missions on the kinematic plant, one for each hypothesis of the planner that the choice follows to its
// end, with a guess of the direction that says nothing of the hinge. Left out: low flaps, which may be out of reach and so
// cannot rule a choice alone; contact forces, which the scenarios in physics have.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "ajar/core/random.hpp"
#include "ajar/mechanism/builders.hpp"
#include "ajar/mission/mission.hpp"
#include "ajar/plant/kinematic_plant.hpp"

namespace ajar {
namespace {

constexpr int kHandles = 24;
constexpr double kQuarterTurn = 0.5 * std::numbers::pi;

struct Likely {
  std::string name;  // of the planner's hypothesis
  MechanismConfig mechanism;
};

// The mechanisms behind a handle of which the planner thinks, with stops a little beyond the goal.
std::vector<Likely> mechanisms_behind(const MechanismConfig& handle, const PlannerConfig& planner) {
  std::vector<Likely> out;
  for (const double radius : planner.hinge_radii) {
    for (const Side side : {Side::Right, Side::Left}) {
      MechanismConfig hinge = handle;
      hinge.radius = radius;
      hinge.side = side;
      hinge.travel = 1.1 * kQuarterTurn;
      char name[64];
      std::snprintf(name, sizeof(name), "hinge on the %s, %.2f m", side == Side::Right ? "right" : "left", radius);
      out.push_back({name, hinge});
    }
  }
  const auto slide = [&](const Vector3d& direction, double travel, const std::string& name) {
    MechanismConfig config = handle;
    config.type = "slide";
    config.slide_direction = direction;
    config.travel = travel + 0.05;
    out.push_back({name, config});
  };
  slide({0.0, -1.0, 0.0}, planner.drawer_travel, "drawer");
  if (handle.handle == HandleKind::Bar && handle.bar == BarOrientation::Vertical) {
    slide({1.0, 0.0, 0.0}, planner.sliding_travel, "sliding to the right");
    slide({-1.0, 0.0, 0.0}, planner.sliding_travel, "sliding to the left");
  }
  return out;
}

struct Outcome {
  bool opened = false;
  bool taken_anew = false;
  bool promised = true;  // the choice was made for this mechanism
  std::string words;
};

Outcome open(const RobotModel& robot, const Likely& likely, std::uint64_t seed) {
  PlantConfig config;
  config.kind = "kinematic";
  KinematicPlant plant(robot, make_mechanism(likely.mechanism), config, BasePose{0.2, -1.6, 1.4}, robot.home());
  plant.reset(seed);
  MissionConfig settings;
  const bool hinge = likely.mechanism.type == "hinge";
  settings.goal.opening_length = likely.mechanism.travel - 0.05;
  Mission mission(robot, settings, Vector3d(0.0, -1.0, 0.0), seed);
  Outcome out;
  bool holds = false;
  while (!mission.finished()) {
    plant.apply(mission.step(plant.measure()));
    plant.advance(settings.period);
    out.taken_anew = out.taken_anew || mission.phase() == Phase::Regrasp;
    if (holds || mission.phase() != Phase::Open) continue;
    holds = true;
    const std::vector<std::string>& missing = mission.chosen().falls_short;
    out.promised = std::find(missing.begin(), missing.end(), likely.name) == missing.end();
  }
  const double wanted = hinge ? kQuarterTurn : settings.goal.opening_length;
  out.opened = mission.reached_goal() && plant.truth().opening > 0.99 * wanted;
  out.words = mission.explain();
  return out;
}

TEST(Choice, OpensEveryMechanismForWhichItWasMade) {
  const RobotModel robot = load_robot("heron");
  Random random(2041);
  int promised = 0;
  int kept = 0;
  int beyond = 0;
  for (int i = 0; i < kHandles; ++i) {
    MechanismConfig handle;
    handle.handle_height = random.uniform(0.65, 1.15);
    handle.handle = i % 3 == 2 ? HandleKind::Knob : HandleKind::Bar;
    handle.bar = i % 3 == 1 ? BarOrientation::Horizontal : BarOrientation::Vertical;
    for (const Likely& likely : mechanisms_behind(handle, PlannerConfig{})) {
      const Outcome outcome = open(robot, likely, static_cast<std::uint64_t>(i) + 1);
      if (!outcome.promised) {
        ++beyond;
        continue;
      }
      ++promised;
      if (outcome.opened && !outcome.taken_anew) {
        ++kept;
      } else {
        std::printf("handle %d at %.2f m, %s: %s%s\n", i, handle.handle_height, likely.name.c_str(), outcome.words.c_str(),
                    outcome.taken_anew ? "; taken anew" : "");
      }
    }
  }
  std::printf("%d of %d opened as chosen for; %d more were not promised\n", kept, promised, beyond);
  EXPECT_GE(kept, 0.99 * promised);
  EXPECT_GT(promised, 4 * kHandles);
}

}  // namespace
}  // namespace ajar
