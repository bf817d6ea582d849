#pragma once

#include <array>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "ajar/model/robot_model.hpp"

namespace ajar {

/// What a robot's TOML file says, before it is compared with the URDF.
struct RobotConfig {
  std::string file;                  ///< Path, for messages
  std::map<std::string, int> lines;  ///< Line of every key that was given, by its path ("arm.home")
  std::string name;
  BaseType base_type = BaseType::Differential;
  std::string base_frame;
  double wheel_radius = 0.0;         ///< [m]
  double wheel_track = 0.0;          ///< [m]
  RobotLimits limits;                ///< Base limits; joint limits where the file gives them
  std::vector<std::string> joints;   ///< From the base to the hand
  std::vector<double> velocity;      ///< Empty: as in the URDF [rad/s or m/s]
  std::vector<double> acceleration;  ///< [rad/s² or m/s²]
  std::vector<double> home;          ///< [rad or m]
  std::string hand_frame;
  std::string sensor_frame;
  double gripper_stroke = 0.0;                            ///< [m]
  bool ignore_meshes = false;                             ///< Collision meshes of the URDF are left out instead of refused
  std::vector<std::array<std::string, 2>> never_checked;  ///< Pairs of links

  /// "FILE:LINE: KEY" of a key, without the line if the key was not given.
  [[nodiscard]] std::string where(const std::string& key) const;
};

/// Reads a robot's TOML file. Unknown, missing, mistyped and out-of-range keys are errors.
/// @throws IoError, ModelError
[[nodiscard]] RobotConfig read_robot_config(const std::filesystem::path& path);

/// The whole text of a file. @throws IoError  if it is missing, a directory or unreadable
[[nodiscard]] std::string read_text(const std::filesystem::path& path);

/// "a, b, c" for messages; at most `most` names, then "…".
[[nodiscard]] std::string join_names(const std::vector<std::string>& names, std::size_t most = 40);

}  // namespace ajar
