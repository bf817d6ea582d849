#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "ajar/campaign/result.hpp"
#include "ajar/mechanism/mechanism.hpp"
#include "ajar/mission/mission.hpp"
#include "ajar/model/robot_model.hpp"

namespace ajar {

/// What a judge must know beforehand.
struct JudgeConfig {
  double period = 0.002;      ///< Control period [s]
  double time_limit = 180.0;  ///< Of the mission; sizes the buffers [s]
  GoalConfig goal;
  JointKind kind = JointKind::Hinge;  ///< The true mechanism
  double travel = 1.9;                ///< Its end stop [rad or m]
  /// Force along the handle's way that a slow opening needs at an opening [N]; none: probing is not compared with it
  std::function<double(double)> force_needed{};
  RobotLimits limits;
  double wheel_radius = 0.1;  ///< [m]
  double wheel_track = 0.5;   ///< [m]
};

/// One tick as judge and log see it: everything at the instant of the measurement, the command that answers it.
struct TickView {
  const RobotState& state;
  const Truth& truth;
  const MissionRecord& record;
  const Command& command;
  double tick_us = 0.0;  ///< Time that the mission's step took [µs]
};

/// How a run ended, by the mission itself.
struct RunEnd {
  bool claimed = false;          ///< The mission says that it reached its goal
  Phase phase = Phase::Stopped;  ///< Phase in which it ended
  EndReason reason = EndReason::Running;
  std::string explanation;
  std::vector<Contact> contacts;
  double duration = 0.0;      ///< [s]
  double wall_seconds = 0.0;  ///< [s]
};

/// Judges a run from the truth. Beliefs are compared in the robot's own frame: the error of its localisation is not the
/// estimator's.
class Judge {
 public:
  explicit Judge(const JudgeConfig& config);
  ~Judge();
  Judge(const Judge&) = delete;
  Judge& operator=(const Judge&) = delete;

  /// One tick. No exception; no allocation up to the time limit.
  void observe(const TickView& tick) noexcept;

  /// The result, without seed, version and notes.
  [[nodiscard]] RunResult finish(const RunEnd& end) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Opening that counts as opened: hinge min(85/90 of the goal, 97 % of the stop), slide 97 % of the lesser of goal and stop.
/// [rad or m]
[[nodiscard]] double opening_needed(const JudgeConfig& config) noexcept;

/// Turns what the robot believes into the world as if its believed hand were the true one: R_true R_believed^T. The frame of
/// the belief (odometry, or what the robot corrected it to by sight) has errors of its own that are not the estimator's.
[[nodiscard]] Matrix3d belief_alignment(const MissionRecord& record, const Truth& truth) noexcept;

}  // namespace ajar
