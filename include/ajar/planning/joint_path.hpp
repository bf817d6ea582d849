#pragma once

#include <cstdint>
#include <vector>

#include "ajar/model/clearance.hpp"
#include "ajar/model/robot_model.hpp"

namespace ajar {

/// What a collision-free joint path is looked for with.
struct JointPathConfig {
  double step = 0.15;       ///< Largest joint motion between two checked postures [rad]
  double clearance = 0.03;  ///< Wanted between robot and anything [m]
  int max_nodes = 3000;     ///< Of both trees together
  int shortcuts = 60;       ///< Attempts to straighten the path
};

/// Finds a polyline of postures between two postures with the base standing still (RRT-Connect with shortcuts).
/// The obstacles are those already placed in the checker. Set-up and planning only.
/// @return empty if none was found; else `from`, corner postures, `to`
[[nodiscard]] std::vector<JointVector> plan_joint_path(const RobotModel& model, ClearanceChecker& checker,
                                                       const BasePose& base, const JointVector& from, const JointVector& to,
                                                       std::uint64_t seed, const JointPathConfig& config = {});

}  // namespace ajar
