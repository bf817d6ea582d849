// Strategy: flaps at knee height on the kinematic plant. The grasp that suits everything that a level bar may belong to
// does not suit them, so the mission must feel the way, lead the leaf back, take the bar anew and open it wholly; a
// drawer with the same bar must be opened at the first go.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "ajar/mechanism/builders.hpp"
#include "ajar/mission/mission.hpp"
#include "ajar/plant/kinematic_plant.hpp"

namespace ajar {
namespace {

struct Story {
  bool reached_goal = false;
  int grasps = 0;
  double opening_when_let_go = -1.0;  // the first time [rad or m]
  double opening = 0.0;               // at the end of the last phase Open [rad or m]
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
    if (phase == Phase::Open) story.opening = plant.truth().opening;
    if (phase != last && phase == Phase::Open) ++story.grasps;
    if (phase != last && last == Phase::Regrasp) story.opening_when_let_go = plant.truth().opening;
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

TEST(Regrasp, ALowFlapIsLedBackAndTakenAnewOnceItsWayIsFelt) {
  MissionConfig mission;
  mission.goal.opening_angle = 1.48;  // 85 degrees
  const Story story = tell(flap(0.78), mission);
  EXPECT_TRUE(story.reached_goal) << story.words;
  EXPECT_EQ(story.grasps, 2);
  EXPECT_NEAR(story.opening_when_let_go, 0.0, 0.02);  // 8 mm at the handle
  EXPECT_GT(story.opening, mission.goal.opening_angle);
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
