// Worlds from MJCF files. Truth is what the test wrote into the file: where the axis is, which way the leaf faces, what the
// handle looks like. A small cabinet with a door and a drawer stands for models that others wrote.
#include <filesystem>
#include <fstream>
#include <numbers>

#include <gtest/gtest.h>

#include "bench_rig.hpp"

#include "ajar/core/error.hpp"

namespace ajar::test {
namespace {

// The door hangs on its right edge (x = 0.3) and opens by negative joint angles; the drawer slides to -y.
constexpr const char* kCabinet = R"(
<mujoco>
  <compiler angle="degree"/>
  <worldbody>
    <geom name="back wall" type="box" pos="0 0.6 1" size="2 0.05 1"/>
    <body name="cabinet" pos="0 0.25 0">
      <geom name="carcass" type="box" pos="0 0.02 0.7" size="0.3 0.2 0.7"/>
      <body name="door" pos="0.3 -0.21 1.1">
        <joint name="door_hinge" type="hinge" axis="0 0 -1" range="-110 0" damping="0.3" frictionloss="0.4"/>
        <geom name="door panel" type="box" pos="-0.3 0 0" size="0.29 0.01 0.22" mass="4"/>
        <geom name="door bar" type="capsule" pos="-0.52 -0.06 0" size="0.01 0.06" mass="0.1"/>
        <geom type="box" pos="-0.52 -0.035 0.05" size="0.008 0.025 0.008" mass="0.02"/>
        <site name="door_grip" pos="-0.52 -0.06 0"/>
      </body>
      <body pos="0 -0.21 0.3">
        <joint name="drawer_slide" type="slide" axis="0 -1 0" range="0 0.35" damping="4" frictionloss="2"/>
        <geom name="drawer front" type="box" size="0.29 0.01 0.12" mass="3"/>
        <geom name="drawer bar" type="box" pos="0 -0.05 0" size="0.08 0.01 0.01" mass="0.1"/>
        <site name="drawer_grip" pos="0 -0.05 0"/>
      </body>
    </body>
  </worldbody>
</mujoco>)";

class MjcfTest : public testing::Test {
 protected:
  void SetUp() override {
    const auto* test = testing::UnitTest::GetInstance()->current_test_info();
    path = std::filesystem::temp_directory_path() / (std::string("ajar_cabinet_") + test->name() + ".xml");
    std::ofstream(path) << kCabinet;
  }
  void TearDown() override { std::filesystem::remove(path); }
  [[nodiscard]] MjcfWorld door_world() const { return {path, "door_hinge", "door_grip", {}, {}}; }
  [[nodiscard]] MjcfWorld drawer_world() const { return {path, "drawer_slide", "drawer_grip", {}, {}}; }

  RobotModel robot = load_robot("heron");
  std::filesystem::path path;
};

TEST_F(MjcfTest, DoorIsReadAsItIsWritten) {
  const Mechanism mechanism = load_mjcf_mechanism(door_world());
  EXPECT_EQ(mechanism.kind, JointKind::Hinge);
  EXPECT_LT((mechanism.axis - Vector3d::UnitZ()).norm(), 1e-9);  // opens by negative angles about -z
  EXPECT_LT((mechanism.point - Vector3d(0.3, 0.04, 1.1)).norm(), 1e-9);
  EXPECT_NEAR(mechanism.travel, 110.0 * std::numbers::pi / 180.0, 1e-9);
  EXPECT_NEAR(mechanism.mass, 4.12, 1e-9);
  EXPECT_NEAR(mechanism.coulomb, 0.4, 1e-12);
  EXPECT_NEAR(mechanism.viscous, 0.3, 1e-12);
  EXPECT_LT((mechanism.handle.position - Vector3d(-0.22, -0.02, 1.1)).norm(), 1e-9);
  EXPECT_LT((mechanism.handle.normal + Vector3d::UnitY()).norm(), 1e-6);
  EXPECT_NEAR(std::abs(mechanism.handle.bar.z()), 1.0, 1e-6);
  EXPECT_NEAR(mechanism.handle.thickness, 0.02, 1e-6);
  EXPECT_NEAR(mechanism.handle.standoff, 0.05, 1e-6);
  // Panel about its edge: m (4 a² / 3 + t² / 3), handle as point masses.
  const double panel = 4.0 * (0.3 * 0.3 + (0.29 * 0.29 + 0.01 * 0.01) / 3.0);
  EXPECT_NEAR(mechanism.inertia, panel + 0.12 * (0.52 * 0.52 + 0.06 * 0.06), 0.002);
}

TEST_F(MjcfTest, DrawerIsReadAsItIsWritten) {
  const Mechanism mechanism = load_mjcf_mechanism(drawer_world());
  EXPECT_EQ(mechanism.kind, JointKind::Slide);
  EXPECT_LT((mechanism.axis + Vector3d::UnitY()).norm(), 1e-9);
  EXPECT_NEAR(mechanism.travel, 0.35, 1e-9);
  EXPECT_NEAR(mechanism.inertia, 3.1, 1e-6);
  EXPECT_LT((mechanism.handle.normal + Vector3d::UnitY()).norm(), 1e-6);
  EXPECT_NEAR(std::abs(mechanism.handle.bar.x()), 1.0, 1e-6);
  EXPECT_NEAR(mechanism.handle.standoff, 0.04, 1e-6);
}

TEST_F(MjcfTest, GivenNormalAndBarWin) {
  MjcfWorld world = door_world();
  world.normal = Vector3d(0.0, -2.0, 0.0);
  world.bar = Vector3d::UnitX();
  const Mechanism mechanism = load_mjcf_mechanism(world);
  EXPECT_LT((mechanism.handle.normal + Vector3d::UnitY()).norm(), 1e-12);
  EXPECT_LT((mechanism.handle.bar - Vector3d::UnitX()).norm(), 1e-12);
}

TEST_F(MjcfTest, MissingNamesAreToldTogetherWithThoseThatExist) {
  MjcfWorld world = door_world();
  world.joint = "hatch";
  try {
    (void)load_mjcf_mechanism(world);
    FAIL();
  } catch (const ModelError& error) {
    const std::string text = error.what();
    EXPECT_NE(text.find("hatch"), std::string::npos);
    EXPECT_NE(text.find("door_hinge"), std::string::npos);
    EXPECT_NE(text.find("drawer_slide"), std::string::npos);
  }
  world = door_world();
  world.handle_site = "knob";
  try {
    (void)load_mjcf_mechanism(world);
    FAIL();
  } catch (const ModelError& error) {
    EXPECT_NE(std::string(error.what()).find("drawer_grip"), std::string::npos);
  }
  world.path = "/nowhere/cabinet.xml";
  EXPECT_THROW((void)load_mjcf_mechanism(world), IoError);
  std::ofstream(path) << "<mujoco><worldbody><body></worldbody></mujoco>";
  EXPECT_THROW((void)load_mjcf_mechanism(door_world()), ModelError);
}

TEST_F(MjcfTest, DoorOpensByAForce) {
  MujocoPlant plant(robot, door_world(), quiet(), {-0.2, -2.0, 1.5708}, robot.home());
  plant.push_handle(10.0 * plant.truth().direction);
  hold(plant, still(robot), 0.5);
  EXPECT_GT(plant.truth().opening, 0.1);
  EXPECT_LT(plant.truth().handle.y(), -0.05);  // towards the robot
  EXPECT_TRUE(plant.contacts().empty());
  plant.reset(2);
  EXPECT_NEAR(plant.truth().opening, 0.0, 1e-6);
}

TEST_F(MjcfTest, RobotStandsOnTheFloorThatWasMissing) {
  MujocoPlant plant(robot, drawer_world(), quiet(), {-0.2, -2.0, 1.5708}, robot.home());
  Command command = still(robot);
  command.base_v = -0.2;
  hold(plant, command, 2.0);
  EXPECT_NEAR(plant.truth().base.y, -2.35, 0.04);
  EXPECT_NEAR(
      plant.truth().hand.translation().z(),
      [&] {
        Kinematics kinematics;
        robot.compute(plant.truth().base, plant.truth().q, kinematics);
        return kinematics.X_WE.translation().z();
      }(),
      2e-3);
}

TEST_F(MjcfTest, RobotPullsTheDoorOfAForeignCabinet) {
  const Mechanism mechanism = load_mjcf_mechanism(door_world());
  const Stance stance = stand_at(robot, mechanism.handle);
  MujocoPlant plant(robot, door_world(), quiet(), stance.base, stance.q);
  hold(plant, still(robot, true), 1.2);
  ASSERT_TRUE(plant.truth().grasped);
  Command pull = still(robot, true);
  pull.dq = arm_rates(robot, plant.measure(), 0.05 * mechanism.handle.normal);
  hold(plant, pull, 0.8);
  EXPECT_TRUE(plant.truth().grasped);
  EXPECT_GT(plant.truth().opening, 0.04);
}

TEST_F(MjcfTest, RobotTouchesForeignFurniture) {
  MujocoPlant plant(robot, door_world(), quiet(), {-0.1, -0.9, 1.5708}, robot.home());
  Command command = still(robot);
  command.base_v = 0.2;
  hold(plant, command, 3.0);
  ASSERT_FALSE(plant.contacts().empty());
  EXPECT_GT(plant.contacts().front().force, 1.0);
}

}  // namespace
}  // namespace ajar::test
