#pragma once

#include <vector>

#include "ajar/core/types.hpp"

namespace ajar {

/// The task "follow": where the robot starts and parks, and how the free hand moves.
struct FollowConfig {
  Vector2d start{0.0, 0.0};           ///< Of the base, world [m]
  double start_yaw = 0.0;             ///< [rad]
  Vector2d parking{-1.5, -1.15};      ///< Base while the hand is at the handle, world [m]
  double parking_yaw = 0.0;           ///< [rad]
  double speed = 0.0785398163397448;  ///< Of the hand along its path, π/40 [m/s]
  double feedback = 2.0;              ///< Pose feedback; 0 = the constant hand twist alone [1/s]
  /// The hand may turn about the mechanism's axis, as fingers do round the bar of a flap; controller qp only.
  bool free_about_axis = false;
  /// Seed of the inverse kinematics for the posture at the handle, shape (n) [rad or m]
  std::vector<double> posture{1.5403, -1.9570, 1.4613, -1.0732, -1.6119, -0.0017};
  bool operator==(const FollowConfig&) const = default;
  /// @throws ConfigError
  void validate() const;
};

}  // namespace ajar
