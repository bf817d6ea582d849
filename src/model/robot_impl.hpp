#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "ajar/model/robot_drawing.hpp"
#include "ajar/model/robot_model.hpp"
#include "arm_chain.hpp"

namespace ajar {

/// Everything that a robot description says, put together from URDF and TOML.
struct RobotParts {
  std::string name;
  std::filesystem::path urdf;
  BaseType base_type = BaseType::Differential;
  double wheel_radius = 0.0;  ///< [m]
  double wheel_track = 0.0;   ///< [m]
  RobotLimits limits;
  std::vector<CollisionShape> shapes;
  std::vector<std::array<int, 2>> unchecked_pairs;  ///< Indices in shapes
  std::vector<bool> free_turning;                   ///< Per joint: may be wrapped by whole turns, shape (n)
  double tool_mass = 0.0;                           ///< [kg]
  Vector3d tool_com = Vector3d::Zero();             ///< Sensor axes and origin [m]
  JointVector home;                                 ///< shape (n) [rad or m]
  double gripper_stroke = 0.0;                      ///< [m]
  RobotDrawing drawing;
  ArmChainNames names;
};

/// Reads and cross-checks URDF and TOML. @throws ModelError, IoError
[[nodiscard]] RobotParts assemble_robot(const std::filesystem::path& urdf, const std::filesystem::path& toml);

struct RobotModel::Impl {
  RobotParts parts;
  ArmChain chain;
  bool evaluated = false;  ///< The last compute() had finite inputs

  explicit Impl(RobotParts p) : parts(std::move(p)), chain(parts.urdf, parts.names) {}
};

}  // namespace ajar
