#pragma once

#include <Eigen/Core>

#include "ajar/core/types.hpp"

namespace ajar {

enum class MechanismType { Unknown, Hinge, Slide };

/// What the robot believes of the mechanism, at the present hand position.
struct MechanismEstimate {
  Vector3d direction = Vector3d::UnitX();                    ///< Unit direction of motion for opening, x, world
  Vector3d curvature = Vector3d::Zero();                     ///< k, k·x = 0 [1/m]
  Vector3d point = Vector3d::Zero();                         ///< On the path, nearest to the hand [m]
  Eigen::Matrix4d covariance = Eigen::Matrix4d::Identity();  ///< Of (two turns of x, two components of k) in `frame`
  Matrix3d frame = Matrix3d::Identity();                     ///< Columns x, b1, b2
  double direction_sigma = 1.0;                              ///< sqrt of the trace of the direction block [rad]
  double curvature_sigma = 10.0;  ///< sqrt of the trace of the curvature block, model floor included [1/m]
  MechanismType type = MechanismType::Unknown;
  double arc = 0.0;          ///< Path length travelled, signed along x [m]
  double angle = 0.0;        ///< Turning of the mechanism so far: ∫|k| ds, or the hand's rotation when rigid [rad]
  double angle_sigma = 0.0;  ///< [rad]
  bool fitted = false;       ///< The path filter runs (about 2 cm travelled)
  bool rigid_grasp = true;   ///< Orientation is used; false once the grip is found to pivot
  int alarms = 0;            ///< Model failures noticed so far
};

}  // namespace ajar
