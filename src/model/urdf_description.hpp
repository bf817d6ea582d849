#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "ajar/model/robot_drawing.hpp"
#include "ajar/model/robot_model.hpp"

namespace ajar {

/// What we use of a URDF, as plain values; the kinematics themselves are built from the same file by Pinocchio.
struct UrdfDescription {
  enum class Motion { Fixed, Revolute, Continuous, Prismatic, Other };

  struct Link {
    std::string name;
    int parent = -1;                     ///< Index in `links`, -1 for the root
    std::string joint;                   ///< Joint between parent and this link
    Motion motion = Motion::Fixed;       ///< Of that joint
    Pose X_PL = Pose::Identity();        ///< In the parent, joint at zero
    Vector3d axis = Vector3d::UnitZ();   ///< Of that joint, axes of this link, unit
    double lower = 0.0;                  ///< Joint limits [rad or m]
    double upper = 0.0;                  ///< [rad or m]
    double velocity = 0.0;               ///< [rad/s or m/s]
    double effort = 0.0;                 ///< [N m or N]
    double mass = 0.0;                   ///< [kg]
    Vector3d com = Vector3d::Zero();     ///< Link frame [m]
    std::vector<CollisionShape> shapes;  ///< pose_in_joint holds the pose in the link
    bool has_mesh = false;               ///< A collision body is a mesh
    std::vector<DrawnShape> visuals;     ///< pose_in_joint holds the pose in the link
    bool has_visual_mesh = false;        ///< A visual body is a mesh
    int line = 0;                        ///< Where the link stands in the file, 0 = not found
  };

  std::string file;         ///< Path, for messages
  std::vector<Link> links;  ///< Parents before children

  /// Index of a link or -1.
  [[nodiscard]] int find_link(const std::string& name) const noexcept;
  /// Index of the link that a joint carries, or -1.
  [[nodiscard]] int find_joint(const std::string& name) const noexcept;
  /// True if `link` is `ancestor` or hangs on it.
  [[nodiscard]] bool descends(int link, int ancestor) const noexcept;
  /// "FILE:LINE: link NAME" for messages.
  [[nodiscard]] std::string where(const Link& link) const;
};

/// Reads a URDF. @throws IoError, ModelError
[[nodiscard]] UrdfDescription read_urdf(const std::filesystem::path& path);

}  // namespace ajar
