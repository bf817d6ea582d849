#pragma once

#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "ajar/model/robot_model.hpp"

namespace ajar::test {

/// A folder that disappears with its owner.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    static std::atomic<int> counter{0};
    path_ = std::filesystem::temp_directory_path() /
            ("ajar_test_" + std::to_string(::getpid()) + "_" + std::to_string(counter++));
    std::filesystem::create_directories(path_);
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  std::filesystem::path write(const std::string& name, const std::string& text) const {
    std::ofstream(path_ / name) << text;
    return path_ / name;
  }
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

inline std::string urdf_joint(const std::string& name, const std::string& type, const std::string& parent,
                              const std::string& child, const std::string& origin, const std::string& axis = "0 0 1") {
  return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child +
         "'/><origin " + origin + "/><axis xyz='" + axis +
         "'/><limit lower='-3.5' upper='3.5' velocity='3' effort='100'/></joint>";
}

/// The UR5e of Universal_Robots_ROS2_Description without tool, on a mount that is only an illustration: 0.15, 0.05, 0.60 m,
/// yaw 0.3 of the frame that the maker calls "Base". Hand and sensor are tool0.
inline std::string ur5e_urdf() {
  std::string text = "<robot name='ur5e'>";
  for (const char* link :
       {"base_link", "Base", "shoulder", "upper_arm", "forearm", "wrist_1", "wrist_2", "wrist_3", "tool0"}) {
    text += "<link name='" + std::string(link) + "'/>";
  }
  const std::string half = "1.5707963267948966", pi = "3.141592653589793";
  text += urdf_joint("mount", "fixed", "base_link", "Base", "xyz='0.15 0.05 0.60' rpy='0 0 0.3'");
  text += urdf_joint("pan", "revolute", "Base", "shoulder", "xyz='0 0 0.1625'");
  text += urdf_joint("lift", "revolute", "shoulder", "upper_arm", "rpy='" + half + " 0 0'");
  text += urdf_joint("elbow", "revolute", "upper_arm", "forearm", "xyz='-0.425 0 0'");
  text += urdf_joint("w1", "revolute", "forearm", "wrist_1", "xyz='-0.3922 0 0.1333'");
  text += urdf_joint("w2", "revolute", "wrist_1", "wrist_2", "xyz='0 -0.0997 0' rpy='" + half + " 0 0'");
  text += urdf_joint("w3", "revolute", "wrist_2", "wrist_3", "xyz='0 0.0996 0' rpy='" + half + " " + pi + " " + pi + "'");
  text += urdf_joint("tool", "fixed", "wrist_3", "tool0", "xyz='0 0 0'");
  return text + "</robot>";
}

/// A robot file for a URDF of n joints with the usual names; `base` is "differential" or "fixed".
inline std::string robot_toml(const std::string& joints, int n, const std::string& hand,
                              const std::string& base = "differential") {
  std::string ones, zeros;
  for (int i = 0; i < n; ++i) {
    ones += i == 0 ? "1.0" : ", 1.0";
    zeros += i == 0 ? "0.0" : ", 0.0";
  }
  return "[robot]\nname = \"toy\"\n[base]\ntype = \"" + base +
         "\"\nframe = \"base_link\"\nwheel_radius = 0.1\nwheel_track = 0.5\nforward_speed = 1.0\nreverse_speed = "
         "1.0\nyaw_rate = 1.0\n"
         "acceleration = 1.0\nyaw_acceleration = 1.0\nwheel_speed = 10.0\n[arm]\njoints = [" +
         joints + "]\nacceleration = [" + ones + "]\nhome = [" + zeros + "]\n[hand]\nframe = \"" + hand +
         "\"\nsensor_frame = \"" + hand + "\"\ngripper_stroke = 0.1\n";
}

/// Joint positions, uniform between the limits but never beyond ±π.
inline JointVector random_posture(const RobotModel& model, std::mt19937_64& rng) {
  JointVector q(model.joints());
  for (int i = 0; i < model.joints(); ++i) {
    const double low = std::max(model.limits().position_lower[i], -3.141592653589793);
    const double high = std::min(model.limits().position_upper[i], 3.141592653589793);
    q[i] = std::uniform_real_distribution<double>(low, high)(rng);
  }
  return q;
}

inline BasePose random_base(std::mt19937_64& rng) {
  std::uniform_real_distribution<double> uniform(-3.0, 3.0);
  return {uniform(rng), uniform(rng), uniform(rng)};
}

}  // namespace ajar::test
