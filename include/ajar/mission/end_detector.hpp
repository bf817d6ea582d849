#pragma once

#include "ajar/estimation/mechanism_estimate.hpp"
#include "ajar/mission/mission.hpp"

namespace ajar {

struct EndConfig {
  double still_speed = 0.006;  ///< Hand slower than this stands still [m/s]
  double stop_time = 0.5;      ///< Still this long with risen force: an end stop [s]
  double stop_force = 12.0;    ///< Rise over the running force that an end stop shows [N]
  double stop_arc = 0.10;      ///< An end stop is believed after this travel [m]
  double leaning_time = 2.0;   ///< The same while the controller holds the hand back, so that only the arm's give pulls [s]
  double blocked_time = 2.0;   ///< Still this long near the start: blocked [s]
  double blocked_pull_time = 0.5;  ///< The same while pulling with what is allowed [s]
  double blocked_arc = 0.03;       ///< [m]
  double stalled_time = 6.0;       ///< Still this long anywhere: stalled [s]
  double reserve = 8.0;            ///< Below the force limit the pull counts as being at it [N]
  double goal_margin = 0.0175;     ///< The wanted angle is passed by this much [rad]
  bool operator==(const EndConfig&) const = default;
};

/// What the end detector is told in one tick; all of it measured or believed by the robot.
struct EndInput {
  double dt = 0.002;           ///< [s]
  double speed = 0.0;          ///< x̂·V measured [m/s]
  double wanted_speed = 0.0;   ///< [m/s]
  double pull_force = 0.0;     ///< x̂·f [N]
  double running_force = 0.0;  ///< Of the motion so far [N]
  double force_cap = 1e3;      ///< Pull allowed now [N]
  double speed_factor = 1.0;   ///< s of the controller [-]
  BindingLimit binding = BindingLimit::None;
};

/// Tells goal, end stop, blocked start, too heavy, stalled and held by a clearance from one another.
/// (docs/equations.md#ends)
class EndDetector {
 public:
  enum class Verdict { Going, Goal, Stop, Blocked, TooHeavy, Stalled, ClearanceStop };

  EndDetector(const EndConfig& config, const GoalConfig& goal, double force_limit);
  void reset() noexcept;
  /// No allocation, no exception.
  [[nodiscard]] Verdict step(const EndInput& input, const MechanismEstimate& estimate) noexcept;

 private:
  // Brings the times of standing, leaning and pressing up to date.
  void watch(const EndInput& input) noexcept;

  EndConfig config_;
  GoalConfig goal_;
  double force_limit_;
  double speed_ = 0.0;
  double drift_ = 0.0;
  double force_ = 0.0;
  double still_ = 0.0;
  double stuck_ = 0.0;  // without gain
  double held_ = 0.0;   // of that with a clearance as the limit
  double pressed_ = 0.0;
  double leaning_ = 0.0;
};

}  // namespace ajar
