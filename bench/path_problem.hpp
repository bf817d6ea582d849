#pragma once

#include <string>
#include <vector>

#include "ajar/model/robot_model.hpp"

namespace ajar::bench {

/// Hand on the handle of a quarter turn of a door, base and arm free: what every contestant has to follow.
///
/// The hinge lies 0.8 m to the right of the hand, the handle moves at 0.1 m/s from the first step on. The base's turning and
/// driving count as two joints ahead of the arm, so that no contestant can move it sideways.
class PathProblem {
 public:
  struct Config {
    std::string name;
    double joint_rate = 0.0;  ///< Limit of every arm joint [rad/s]
    double yaw_rate = 0.0;    ///< Limit of the base [rad/s]
    double speed = 0.0;       ///< Limit of the base, either way [m/s]
  };

  explicit PathProblem(Config config);

  [[nodiscard]] const Config& config() const { return config_; }
  [[nodiscard]] const RobotModel& robot() const { return robot_; }
  [[nodiscard]] const BasePose& start_base() const { return base_; }
  [[nodiscard]] const JointVector& start_q() const { return q_; }
  [[nodiscard]] const Pose& start_hand() const { return hand_; }
  [[nodiscard]] int steps() const;
  [[nodiscard]] Pose target(int step) const;          ///< Hand in the world
  [[nodiscard]] Vector6d path_twist(int step) const;  ///< Of the handle at a step, at the hand
  [[nodiscard]] InputVector limits() const;           ///< Of |u|, shape (8)
  /// What all contestants pursue beside the hand: (q̇, ω, v) towards the first posture, the heading of the motion and
  /// 0.75 m between axle and hand, shape (8).
  [[nodiscard]] InputVector wishes(int step, const BasePose& base, const JointVector& q) const;
  /// Everything that another process needs to pose the same problem, as JSON.
  [[nodiscard]] std::string to_json() const;

  static constexpr double kPeriod = 0.002;  ///< [s]
  static constexpr double kRadius = 0.8;    ///< [m]
  static constexpr double kSpeed = 0.1;     ///< [m/s]

 private:
  Config config_;
  RobotModel robot_ = load_robot("heron");
  BasePose base_;
  JointVector q_;
  Pose hand_ = Pose::Identity();
};

/// The problem with no limit ever active, and with one active most of the time while the path stays feasible.
[[nodiscard]] std::vector<PathProblem::Config> path_problems();

}  // namespace ajar::bench
