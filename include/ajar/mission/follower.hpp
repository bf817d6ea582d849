#pragma once

#include <memory>
#include <string>
#include <vector>

#include "ajar/mission/mission.hpp"

namespace ajar {

/// A path that the hand is told to follow, in its own axes at the beginning: a circle, or a line for zero curvature.
struct HandPath {
  Vector3d direction = -Vector3d::UnitZ();  ///< x, unit, hand axes
  Vector3d curvature = Vector3d::Zero();    ///< k, perpendicular to x, hand axes [1/m]
  double length = 1.0;                      ///< [m]
};

/// Hand pose after an arc: the rigid motion by the constant body twist (x, k). (docs/equations.md#follow)
/// @param start  Hand at arc 0, world
[[nodiscard]] Pose pose_on_path(const HandPath& path, const Pose& start, double arc) noexcept;

/// Drives to a parking pose with the arm in its posture, then moves the free hand along a told path: the task of the
/// thesis's experiments. No handle, no force, no estimate; phases Approach, Open, Done.
///
/// Controller qp: pose feedback, bounded QP, base law. Controller thesis: the pseudo-inverse law; with feedback = 0 its
/// reference is the constant twist in hand axes alone. (docs/equations.md#follow)
class Follower {
 public:
  /// @throws ConfigError
  Follower(const RobotModel& model, const MissionConfig& config, const HandPath& path);
  ~Follower();
  Follower(const Follower&) = delete;
  Follower& operator=(const Follower&) = delete;

  /// One tick. Output always finite; measurements that are not finite stop it.
  [[nodiscard]] Command step(const RobotState& state) noexcept;
  /// Asks for a safe stop.
  void interrupt() noexcept;

  [[nodiscard]] bool finished() const noexcept;
  /// The path was commanded to its end; how well the hand followed is for others to judge.
  [[nodiscard]] bool reached_goal() const noexcept;
  [[nodiscard]] Phase phase() const noexcept;
  [[nodiscard]] Phase end_phase() const noexcept;
  [[nodiscard]] EndReason reason() const noexcept;
  [[nodiscard]] std::string explain() const;
  [[nodiscard]] const MissionRecord& record() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ajar
