// Strategy: flaps at knee height on the kinematic plant. The grasp that suits everything that a level bar may belong to
// does not suit them, so the mission must feel the way, lead the leaf back, take the bar anew and let go half way to press
// on; a drawer with the same bar must be opened at the first go.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "ajar/mechanism/builders.hpp"
#include "ajar/mission/mission.hpp"
#include "ajar/plant/kinematic_plant.hpp"

namespace ajar {
namespace {

struct Story {
  bool reached_goal = false;
  int grasps = 0;
  std::vector<double> let_go;  // opening each time it was let go [rad or m]
  std::string words;
};

Story tell(const MechanismConfig& config, const MissionConfig& mission_config) {
  const RobotModel robot = load_robot("heron");
  PlantConfig plant_config;
  plant_config.kind = "kinematic";
  plant_config.grasp.pivots = true;
  KinematicPlant plant(robot, make_mechanism(config), plant_config, BasePose{0.2, -1.6, 1.4}, robot.home());
  plant.reset(1);
  Mission mission(robot, mission_config, Vector3d(0.2, -0.95, 0.2).normalized(), 1);
  Story story;
  Phase last = Phase::Choose;
  for (int tick = 0; tick < 90000 && !mission.finished(); ++tick) {
    plant.apply(mission.step(plant.measure()));
    plant.advance(0.002);
    const Phase phase = mission.phase();
    if (phase != last && phase == Phase::Open) ++story.grasps;
    if (phase != last && last == Phase::Regrasp) story.let_go.push_back(plant.truth().opening);
    last = phase;
  }
  story.reached_goal = mission.reached_goal();
  story.words = mission.explain();
  return story;
}

MechanismConfig flap(double height) {
  MechanismConfig config;
  config.type = "hinge";
  config.tilt = std::numbers::pi / 2.0;
  config.bar = BarOrientation::Horizontal;
  config.side = Side::Right;
  config.radius = 0.4;
  config.handle_height = height;
  config.mass = 6.0;
  config.gravity_share = 0.1;
  config.travel = 1.6;
  return config;
}

TEST(Regrasp, ALowFlapIsTakenAnewOnceItsWayIsFeltAndLetGoHalfOpen) {
  const Story story = tell(flap(0.72), MissionConfig{});
  ASSERT_EQ(story.let_go.size(), 2U) << story.words;
  EXPECT_NEAR(story.let_go[0], 0.0, 0.02);  // led back: 8 mm at the handle
  EXPECT_NEAR(story.let_go[1], 0.8,
              0.15);  // no hand follows it to the end: the rest is pressed, which this plant cannot feel
  EXPECT_EQ(story.grasps, 3);
}

TEST(Regrasp, WhatTheFirstGraspCanOpenIsNotLetGo) {
  MechanismConfig drawer;
  drawer.type = "slide";
  drawer.bar = BarOrientation::Horizontal;
  drawer.handle_height = 0.9;
  drawer.travel = 0.45;
  const Story story = tell(drawer, MissionConfig{});
  EXPECT_TRUE(story.reached_goal) << story.words;
  EXPECT_EQ(story.grasps, 1);
}

}  // namespace
}  // namespace ajar
