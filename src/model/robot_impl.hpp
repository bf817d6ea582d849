#pragma once

#include <array>
#include <cmath>
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

/// A turn about the vertical, for the few products that need no full matrix.
struct Heading {
  double yaw = 0.0;  ///< [rad]
  double c = 1.0;
  double s = 0.0;

  [[nodiscard]] Vector3d turn(const Vector3d& v) const { return {c * v.x() - s * v.y(), s * v.x() + c * v.y(), v.z()}; }
  [[nodiscard]] Vector3d turn_back(const Vector3d& v) const { return {c * v.x() + s * v.y(), c * v.y() - s * v.x(), v.z()}; }
  [[nodiscard]] Matrix3d matrix() const {
    Matrix3d R;
    R << c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0;
    return R;
  }
};

struct RobotModel::Impl {
  RobotParts parts;
  ArmChain chain;
  Heading heading;         ///< The last that was asked for: a tick asks for the same one some dozen times
  bool evaluated = false;  ///< The last compute() had finite inputs

  explicit Impl(RobotParts p) : parts(std::move(p)), chain(parts.urdf, parts.names) {}

  const Heading& face(double yaw) {
    if (!(yaw == heading.yaw)) {
      heading = {yaw, std::cos(yaw), std::sin(yaw)};
    }
    return heading;
  }
};

}  // namespace ajar
