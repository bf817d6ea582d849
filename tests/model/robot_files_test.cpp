// Strategy: each way a robot description can be wrong is tried once; the message must be one line that names the file, the
// key or link, and what is allowed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>

#include "ajar/core/error.hpp"
#include "model_fixtures.hpp"

namespace ajar {
namespace {

const char* const kJoints = "\"pan\", \"lift\", \"elbow\", \"w1\", \"w2\", \"w3\"";

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

// Loads and gives back what the error says; empty if there was none.
template <typename Expected>
std::string complaint(const std::string& urdf, const std::string& toml) {
  const test::TemporaryFolder folder;
  try {
    (void)RobotModel::load(folder.write("robot.urdf", urdf), folder.write("robot.toml", toml));
  } catch (const Expected& error) {
    return error.what();
  }
  return {};
}

void expect_parts(const std::string& message, std::initializer_list<const char*> parts) {
  EXPECT_EQ(std::count(message.begin(), message.end(), '\n'), 0) << message;
  for (const char* part : parts) {
    EXPECT_NE(message.find(part), std::string::npos) << "no \"" << part << "\" in: " << message;
  }
}

std::string good_toml() { return test::robot_toml(kJoints, 6, "tool0"); }

TEST(RobotFiles, GoodOnesLoad) { EXPECT_EQ(complaint<Error>(test::ur5e_urdf(), good_toml()), ""); }

TEST(RobotFiles, MissingHandFrameIsNamedWithItsLine) {
  const std::string toml = replaced(good_toml(), "frame = \"tool0\"", "frame = \"hnd\"");
  expect_parts(complaint<ModelError>(test::ur5e_urdf(), toml), {"robot.toml:19: hand.frame: hnd", "allowed", "tool0"});
}

TEST(RobotFiles, MissingKeyIsNamed) {
  expect_parts(complaint<ModelError>(test::ur5e_urdf(), replaced(good_toml(), "gripper_stroke = 0.1\n", "")),
               {"robot.toml:18: hand.gripper_stroke: missing", "allowed"});
  expect_parts(complaint<ModelError>(test::ur5e_urdf(), replaced(good_toml(), "[robot]\nname = \"toy\"\n", "")),
               {"[robot]: missing"});
}

TEST(RobotFiles, WrongTypeIsNamedWithItsValue) {
  expect_parts(
      complaint<ModelError>(test::ur5e_urdf(), replaced(good_toml(), "wheel_radius = 0.1", "wheel_radius = \"big\"")),
      {"robot.toml:6: base.wheel_radius: 'big'", "allowed: a finite number > 0"});
  expect_parts(complaint<ModelError>(test::ur5e_urdf(), replaced(good_toml(), "type = \"differential\"", "type = \"omni\"")),
               {"base.type", "omni", "differential, fixed"});
}

TEST(RobotFiles, UnknownKeyIsNamedWithTheKnownOnes) {
  expect_parts(complaint<ModelError>(test::ur5e_urdf(), replaced(good_toml(), "yaw_rate", "yawrate")),
               {"robot.toml:10: base.yawrate: unknown key", "yaw_rate"});
  expect_parts(complaint<ModelError>(test::ur5e_urdf(), "colour = 3\n" + good_toml()),
               {"robot.toml:1: colour: unknown key"});
}

TEST(RobotFiles, NonFiniteAndNegativeLimitsAreRefused) {
  expect_parts(complaint<ModelError>(test::ur5e_urdf(), replaced(good_toml(), "wheel_track = 0.5", "wheel_track = nan")),
               {"base.wheel_track: nan", "allowed: a finite number > 0"});
  expect_parts(complaint<ModelError>(test::ur5e_urdf(), replaced(good_toml(), "acceleration = [1.0", "acceleration = [inf")),
               {"arm.acceleration: inf"});
  expect_parts(complaint<ModelError>(test::ur5e_urdf(), replaced(good_toml(), "wheel_speed = 10.0", "wheel_speed = -1")),
               {"base.wheel_speed: -1"});
}

TEST(RobotFiles, WrongNumberOfValuesIsRefused) {
  expect_parts(complaint<ModelError>(test::ur5e_urdf(), replaced(good_toml(), "home = [0.0, ", "home = [")),
               {"arm.home: 5 values", "one per joint"});
}

TEST(RobotFiles, JointsMustLeadFromBaseToHandInOrder) {
  expect_parts(complaint<ModelError>(test::ur5e_urdf(), replaced(good_toml(), "\"pan\", \"lift\"", "\"lift\", \"pan\"")),
               {"arm.joints: pan", "from the base to the hand"});
  expect_parts(complaint<ModelError>(test::ur5e_urdf(), replaced(good_toml(), "\"pan\"", "\"pam\"")),
               {"arm.joints: pam", "pan, lift"});
}

TEST(RobotFiles, HomeMustLieInsideTheLimits) {
  expect_parts(complaint<ModelError>(test::ur5e_urdf(), replaced(good_toml(), "home = [0.0", "home = [9.0")),
               {"arm.home", "9.0", "pan", "3.5"});
}

TEST(RobotFiles, BrokenUrdfIsRefusedInOneLine) {
  expect_parts(complaint<ModelError>("<robot name='x'><link name='a'>", good_toml()), {"robot.urdf: not a URDF"});
  expect_parts(complaint<ModelError>("", good_toml()), {"robot.urdf: not a URDF"});
  expect_parts(
      complaint<Error>(replaced(test::ur5e_urdf(), "<link name='wrist_3'/>",
                                "<link name='wrist_3'><inertial><mass value='-1'/><inertia ixx='1' ixy='0' ixz='0' iyy='1' "
                                "iyz='0' izz='1'/></inertial></link>"),
                       good_toml()),
      {"robot.urdf:1: link wrist_3: mass: -1", "allowed"});
  expect_parts(complaint<ModelError>(replaced(test::ur5e_urdf(), "lower='-3.5'", "lower='nan'"), good_toml()),
               {"robot.urdf"});
}

TEST(RobotFiles, CollisionMeshesAreRefusedUnlessIgnored) {
  const std::string urdf =
      replaced(test::ur5e_urdf(), "<link name='wrist_3'/>",
               "<link name='wrist_3'><collision><geometry><mesh filename='a.stl'/></geometry></collision></link>");
  expect_parts(complaint<ModelError>(urdf, good_toml()), {"link wrist_3: collision: a mesh", "collision.meshes"});
  EXPECT_EQ(complaint<Error>(urdf, good_toml() + "[collision]\nmeshes = \"ignore\"\n"), "");
}

TEST(RobotFiles, MissingFileAndDirectoryAreNamed) {
  const test::TemporaryFolder folder;
  const auto toml = folder.write("robot.toml", good_toml());
  const auto message = [&](const std::filesystem::path& urdf) -> std::string {
    try {
      (void)RobotModel::load(urdf, toml);
    } catch (const IoError& error) {
      return error.what();
    }
    return {};
  };
  expect_parts(message(folder.path() / "none.urdf"), {"none.urdf: no such file"});
  expect_parts(message(folder.path()), {"is a directory"});
}

TEST(RobotFiles, UnknownNameListsTheKnownOnes) {
  try {
    (void)load_robot("hern");
    FAIL() << "loaded";
  } catch (const IoError& error) {
    expect_parts(error.what(), {"hern", "heron"});
  }
}

TEST(RobotFiles, FolderOfTheUserComesFirst) {
  const test::TemporaryFolder folder;
  std::filesystem::create_directories(folder.path() / "mine");
  folder.write("mine/mine.urdf", test::ur5e_urdf());
  folder.write("mine/mine.toml", good_toml());
  ::setenv("AJAR_ROBOTS", folder.path().c_str(), 1);
  EXPECT_EQ(load_robot("mine").joints(), 6);
  ::unsetenv("AJAR_ROBOTS");
  EXPECT_EQ(load_robot((folder.path() / "mine" / "mine.urdf").string()).joints(), 6);
  EXPECT_THROW((void)load_robot("mine"), IoError);
}

}  // namespace
}  // namespace ajar
