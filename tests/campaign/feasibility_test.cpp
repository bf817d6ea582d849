// Strategy: each thing that can be in the way is built alone, with the numbers that the sentence must name; the same world
// without it must pass. A flap so low that no arm over its own cabinet follows it must be told from one at worktop height.
#include "ajar/campaign/feasibility.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <numbers>
#include <regex>

#include "ajar/mechanism/builders.hpp"

namespace ajar {
namespace {

namespace fs = std::filesystem;

const BasePose kBefore{0.0, -1.6, std::numbers::pi / 2.0};  // of a door at the origin that is seen from -y

MechanismConfig door(Sense sense, double radius) {
  MechanismConfig config;
  config.type = "hinge";
  config.sense = sense;
  config.radius = radius;
  return config;
}

MechanismConfig flap(double height) {
  MechanismConfig config = door(Sense::Pull, 0.45);
  config.tilt = std::numbers::pi / 2.0;
  config.bar = BarOrientation::Horizontal;
  config.handle_height = height;
  config.travel = 1.57;
  return config;
}

TEST(Obstruction, ADoorWithRoomBeforeItHasNone) {
  const RobotModel robot = load_robot("heron");
  EXPECT_EQ(obstruction(robot, make_mechanism(door(Sense::Pull, 0.8)), kBefore), "");
  EXPECT_EQ(obstruction(robot, make_mechanism(door(Sense::Push, 0.8)), kBefore), "");
}

TEST(Obstruction, NamesHowMuchADoorwayIsTooNarrow) {
  const RobotModel robot = load_robot("heron");
  // 3 cm and 9 cm beside axis and handle, 7 cm for the open leaf: 0.52 m for a base of 0.58 m.
  EXPECT_EQ(obstruction(robot, make_mechanism(door(Sense::Push, 0.47)), kBefore),
            "the doorway is too narrow: base 0.58 m wide, opening 0.52 m: -0.03 m each side");
  EXPECT_EQ(obstruction(robot, make_mechanism(door(Sense::Pull, 0.47)), kBefore), "");  // pulled, it need not go through
}

TEST(Obstruction, NamesTheBodyThatStandsInTheWall) {
  const RobotModel robot = load_robot("heron");
  // The front of the base is 0.487 m before its axle.
  const BasePose near{0.0, -0.40, kBefore.yaw};
  const std::string why = obstruction(robot, make_mechanism(door(Sense::Pull, 0.8)), near);
  EXPECT_EQ(why.find("the robot starts in collision: base_link 0."), 0U) << why;
}

TEST(Obstruction, AHandleBehindAWallIsNamedWithItsPlace) {
  const RobotModel robot = load_robot("heron");
  Mechanism mechanism = make_mechanism(door(Sense::Pull, 0.8));
  Box screen;  // 2 cm thick, 8 to 12 cm before the handle
  screen.pose.translation() = mechanism.handle.position + 0.10 * mechanism.handle.normal;
  screen.half_extents = Vector3d(0.4, 0.02, 0.4);
  mechanism.world.push_back(screen);
  const std::string why = obstruction(robot, mechanism, kBefore);
  EXPECT_EQ(why.find("the handle at (0.00, "), 0U) << why;
  EXPECT_NE(why.find("behind wall 3: 0.10 m before it is solid"), std::string::npos) << why;
}

TEST(Obstruction, ARobotWithoutCollisionShapesIsRefused) {
  const RobotModel heron = load_robot("heron");
  std::ifstream in(heron.urdf_path());
  const std::string urdf(std::istreambuf_iterator<char>(in), {});
  const fs::path folder = fs::temp_directory_path() / ("ajar_bare_" + std::to_string(::getpid()));
  fs::create_directory(folder);
  std::ofstream(folder / "bare.urdf") << std::regex_replace(urdf, std::regex("<collision[^]*?</collision>"), "");
  fs::path toml = heron.urdf_path();
  fs::copy_file(toml.replace_extension(".toml"), folder / "bare.toml");
  const RobotModel bare = RobotModel::load(folder / "bare.urdf", folder / "bare.toml");
  fs::remove_all(folder);
  EXPECT_EQ(obstruction(bare, make_mechanism(door(Sense::Pull, 0.8)), kBefore),
            "robot heron has no collision shapes: nothing would keep it clear");
}

TEST(Shortfall, AFlapAtWorktopHeightHasNoneAndOneNearTheFloorHas) {
  const RobotModel robot = load_robot("heron");
  MissionConfig config;
  EXPECT_EQ(shortfall(robot, make_mechanism(flap(0.95)), config, true), "");
  // It ends 0.17 m above the floor: below the base's own deck, over which the arm must reach.
  const std::string why = shortfall(robot, make_mechanism(flap(0.62)), config, true);
  EXPECT_NE(why.find("no posture"), std::string::npos) << why;
  EXPECT_NE(why.find("0.62 m"), std::string::npos) << why;
  EXPECT_NE(why.find(" % of the way "), std::string::npos) << why;
  EXPECT_NE(shortfall(robot, make_mechanism(flap(0.05)), config, true).find("0.05 m"), std::string::npos);
}

TEST(Shortfall, WhatIsWantedCountsNotWhatTheMechanismCan) {
  MissionConfig config;
  config.goal.opening_angle = 0.5;
  EXPECT_EQ(shortfall(load_robot("heron"), make_mechanism(flap(0.62)), config, true), "");
}

}  // namespace
}  // namespace ajar
