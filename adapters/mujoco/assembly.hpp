#pragma once

#include <array>
#include <string>

#include "scene.hpp"

/// The finished scene and where its parts are.
namespace ajar::scene {

/// Where the parts of the robot and the mechanism are in the state vectors.
struct Addresses {
  std::array<int, kMaxJoints> joint_q{};
  std::array<int, kMaxJoints> joint_v{};
  std::array<int, kMaxJoints> joint_servo{};
  std::array<int, 2> wheel_q{};
  std::array<int, 2> wheel_v{};
  std::array<int, 2> wheel_servo{};
  std::array<int, 2> wheel_lock{};
  int base_q = -1;
  int mechanism_q = -1;
  int mechanism_v = -1;
  int mechanism_lock = -1;
  int hand_site = -1;
  int force_sensor = -1;
  int torque_sensor = -1;
};

/// A compiled scene and what the plant must know about it.
struct Built {
  scene::ModelPtr model;
  std::string joint;             // the mechanism's
  Pose X_RB = Pose::Identity();  // base frame in the robot's root link
  bool described = true;         // false: the model's own forces act on the mechanism
};

/// Robot and described mechanism. @throws ConfigError, ModelError, PlantError
[[nodiscard]] Built build(const RobotModel& robot, const Mechanism& mechanism, const PlantConfig& config,
                          const BasePose& start);
/// Robot in a world that we did not write. @throws IoError, ModelError, PlantError
[[nodiscard]] Built build(const RobotModel& robot, const MjcfWorld& world, const Mechanism& mechanism,
                          const PlantConfig& config, const BasePose& start);

/// Number of a named part. @throws PlantError
[[nodiscard]] int find(const mjModel& model, mjtObj type, const std::string& name);
/// @throws PlantError
[[nodiscard]] Addresses find_addresses(const mjModel& model, const RobotModel& robot, const std::string& mechanism_joint);

}  // namespace ajar::scene
