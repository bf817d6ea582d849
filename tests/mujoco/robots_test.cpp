// Robots other than the default: a base that does not move, and a base frame that is not the root of the URDF. Truth is the
// kinematic model: physics must put the hand where it says. Built from Heron's files, so that only the base differs.
#include <filesystem>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "bench_rig.hpp"

namespace ajar::test {
namespace {

/// Heron's description with another [base] section.
RobotModel heron_with_base(const std::string& section, const std::string& name) {
  const std::filesystem::path folder = std::filesystem::path(AJAR_SOURCE_DIR) / "robots" / "heron";
  std::stringstream text;
  text << std::ifstream(folder / "heron.toml").rdbuf();
  std::string toml = text.str();
  const std::size_t begin = toml.find("[base]");
  toml.replace(begin, toml.find("[arm]") - begin, section);
  const std::filesystem::path path = std::filesystem::temp_directory_path() / (name + ".toml");
  std::ofstream(path) << toml;
  const RobotModel robot = RobotModel::load(folder / "heron.urdf", path);
  std::filesystem::remove(path);
  return robot;
}

void expect_hand_where_the_model_says(const RobotModel& robot, const MujocoPlant& plant, double tolerance) {
  Kinematics kinematics;
  robot.compute(plant.truth().base, plant.truth().q, kinematics);
  EXPECT_LT((plant.truth().hand.translation() - kinematics.X_WE.translation()).norm(), tolerance);
}

TEST(MujocoRobots, FixedBaseStaysAndItsArmMoves) {
  const RobotModel robot = heron_with_base("[base]\ntype = \"fixed\"\nframe = \"base_link\"\n", "ajar_fixed_heron");
  const BasePose start{0.5, -3.0, 0.7};
  MujocoPlant plant(robot, door(), quiet(), start, robot.home());
  plant.reset(1);
  expect_hand_where_the_model_says(robot, plant, 1e-5);
  Command command = still(robot);
  command.base_v = 0.5;
  command.dq(0) = 0.2;
  hold(plant, command, 1.0);
  EXPECT_EQ(plant.truth().base.x, start.x);
  EXPECT_EQ(plant.measure().base.yaw, start.yaw);
  EXPECT_GT(plant.truth().q(0) - robot.home()(0), 0.15);
  expect_hand_where_the_model_says(robot, plant, 1e-5);
}

TEST(MujocoRobots, FixedBaseFrameMayBeTheArmsOwn) {
  const RobotModel robot = heron_with_base("[base]\ntype = \"fixed\"\nframe = \"arm_base_link\"\n", "ajar_arm_heron");
  MujocoPlant plant(robot, door(), quiet(), {0.5, -3.0, 0.7}, robot.home());
  plant.reset(1);
  expect_hand_where_the_model_says(robot, plant, 1e-5);
}

TEST(MujocoRobots, WheelsTurnFastEnoughForTheWholeSpeed) {
  const RobotModel robot = load_robot("heron");
  MujocoPlant plant(robot, door(), quiet(), {0.0, -6.0, 0.0}, robot.home());
  Command command = still(robot);
  command.base_v = robot.limits().base_forward;
  hold(plant, command, 2.0);
  const double before = plant.truth().base.x;
  hold(plant, command, 1.0);
  EXPECT_NEAR(plant.truth().base.x - before, robot.limits().base_forward, 0.02);
  EXPECT_NEAR(plant.measure().base_v, robot.limits().base_forward, 0.02);
}

}  // namespace
}  // namespace ajar::test
