#pragma once

#include <vector>

#include "ajar/core/types.hpp"
#include "ajar/wbc/whole_body_controller.hpp"

namespace ajar {

/// How the drives answer a command, as far as the robot knows: a transport delay and a first-order lag.
struct DriveConfig {
  double arm_lag = 0.015;    ///< Of the joint servos [s]
  double base_lag = 0.1;     ///< Of the wheels [s]
  double base_delay = 0.05;  ///< Of base commands, beyond the dead time of the loop [s]
  bool operator==(const DriveConfig&) const = default;
  /// @throws ConfigError
  void validate() const;
};

/// The robot when the command of this tick takes effect.
struct PredictedState {
  JointVector q;           ///< Where the arm stands once all commands under way are carried out, shape (n) [rad or m]
  BasePose base;           ///< When the arm begins to follow this tick's command
  BaseMotion base_motion;  ///< Over the tick after that
  BasePose base_end;       ///< Where the base stands once all commands under way are carried out
  double base_lead = 0.0;  ///< The base follows this tick's command that much later than the arm [s]
};

/// Foresees the robot by the commands that it has been sent and that have not taken effect. (docs/equations.md#late)
class StatePredictor {
 public:
  /// @param joints  n  @param period  T [s]  @param dead_time  Of the loop, measuring and commanding together [s]
  /// @throws ConfigError
  StatePredictor(const DriveConfig& config, int joints, double period, double dead_time);

  /// Takes down the command of a tick, once per tick. No allocation, no exception.
  void sent(const Command& command) noexcept;
  /// Brings odometry that is older than the rest of the state up to its time. No allocation, no exception, bounded time.
  void refresh(RobotState& state) const noexcept;
  /// The robot when this tick's command takes effect. No allocation, no exception, bounded time.
  /// @param state  Finite, odometry up to date
  [[nodiscard]] PredictedState predict(const RobotState& state) const noexcept;

 private:
  struct BaseState {
    BasePose pose;
    BaseTwist twist;
  };
  [[nodiscard]] const Command& sent_before(int ticks) const noexcept;
  BaseTwist roll(BaseState& base, double from, double to) const noexcept;

  DriveConfig config_;
  double period_;
  double dead_time_;
  double keep_;  // share of its speed that the base keeps over a tick
  std::vector<Command> commands_;
  std::size_t newest_ = 0;
};

}  // namespace ajar
