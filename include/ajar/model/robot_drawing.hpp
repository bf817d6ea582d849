#pragma once

#include <array>
#include <string>
#include <vector>

#include "ajar/core/types.hpp"

namespace ajar {

/// One visible body, fixed to a moving part.
struct DrawnShape {
  enum class Kind { Box, Cylinder, Sphere, Capsule };
  Kind kind = Kind::Box;
  std::string link;                                   ///< URDF link that carries it
  int joint = -1;                                     ///< Index of the arm joint that moves it, -1 = the base
  Pose pose_in_joint = Pose::Identity();              ///< Centre; axis of cylinder and capsule along z
  Vector3d size = Vector3d::Zero();                   ///< Box: full extents; else radius, radius, length of the axis [m]
  std::array<double, 4> rgba = {0.6, 0.6, 0.6, 1.0};  ///< Red, green, blue, opacity, 0 … 1 [-]
};

/// One arm joint as a chain: it hangs on the joint before it, the first on the base.
struct DrawnJoint {
  bool slides = false;                     ///< Prismatic
  Vector3d axis = Vector3d::UnitZ();       ///< Unit, axes of the joint
  Pose pose_in_before = Pose::Identity();  ///< Joint frame at zero, in the frame of the joint before
};

/// What one needs to draw the robot in any posture. A body whose visual is a mesh is drawn by its collision shapes; joints
/// beside the arm stand at zero.
struct RobotDrawing {
  std::vector<DrawnJoint> joints;  ///< shape (n)
  std::vector<DrawnShape> shapes;
  Pose hand_in_last = Pose::Identity();  ///< Hand in the frame of the last joint
};

}  // namespace ajar
