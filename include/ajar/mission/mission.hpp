#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "ajar/estimation/mechanism_estimator.hpp"
#include "ajar/interaction/force_law.hpp"
#include "ajar/mission/follow_config.hpp"
#include "ajar/model/clearance.hpp"
#include "ajar/model/robot_model.hpp"
#include "ajar/navigation/navigator.hpp"
#include "ajar/planning/grasp_planner.hpp"
#include "ajar/wbc/base_law.hpp"
#include "ajar/wbc/state_predictor.hpp"
#include "ajar/wbc/thesis_controller.hpp"
#include "ajar/wbc/whole_body_controller.hpp"

namespace ajar {

/// Where a mission stands.
enum class Phase { Choose, Approach, Reach, Zero, Grasp, Probe, Open, Regrasp, Release, Retreat, Done, Stopped };

/// Why a mission ended, or that it has not.
enum class EndReason {
  Running,
  GoalReached,  ///< The wanted opening by the robot's own estimate
  StopFelt,     ///< An end stop after enough travel; or a flap that came down by itself as far as it goes
  HandleUnseen,
  NothingToGrip,
  Unreachable,
  ApproachBlocked,
  GraspMissed,
  GraspLost,
  Locked,          ///< Nothing moves at the force limit
  OpensAway,       ///< Gives away from the robot, and no doorway is seen to push it through
  NeedsMoreForce,  ///< Moved, then needed more than the limit
  Stalled,         ///< Standstill without force
  ClearanceStop,   ///< A clearance limit stops it
  SensorInvalid,   ///< Not finite
  SensorSilent,
  BaseBlocked,
  ForceLimit,
  TimeLimit,
  Interrupted
};

[[nodiscard]] const char* to_string(Phase phase) noexcept;
[[nodiscard]] const char* to_string(EndReason reason) noexcept;

/// What the robot is told before it touches.
struct BeliefConfig {
  std::optional<double> direction_error;  ///< Error of the direction guess about a random axis; none = no guess at all [rad]
  bool operator==(const BeliefConfig&) const = default;
};

struct GoalConfig {
  double opening_angle = 1.5708;  ///< Hinge [rad]
  double opening_length = 0.4;    ///< Slide [m]
  bool to_the_stop = false;       ///< Go on until an end stop is felt
  bool operator==(const GoalConfig&) const = default;
};

struct MissionLimits {
  double force = 70.0;           ///< Pull force at which opening is given up [N]
  double abort_force = 150.0;    ///< Any force: stop at once [N]
  double abort_torque = 25.0;    ///< Any torque at the hand: stop at once [N m]
  double time = 180.0;           ///< Of the whole mission [s]
  double sensor_timeout = 0.05;  ///< Age of a wrist reading that stops the robot [s]
  bool operator==(const MissionLimits&) const = default;
};

/// Everything a mission is made of.
struct MissionConfig {
  NavigationConfig navigation;
  PlannerConfig planner;
  WbcConfig wbc;
  ThesisConfig thesis;  ///< Used by controller = thesis only
  BaseLawConfig base_law;
  ForceLawConfig force;
  EstimatorConfig estimator;
  ClearanceConfig clearance;
  GoalConfig goal;
  MissionLimits limits;
  std::string task = "open";  ///< open | follow: a mission, or a Follower with the settings of `follow`
  FollowConfig follow;
  double period = 0.002;   ///< Control period [s]
  double dead_time = 0.0;  ///< Transport delay that the robot knows of [s]
  DriveConfig drives;
  std::string controller = "qp";  ///< qp | thesis; the law while the handle is moved, the rest is the QP's
  /// @throws ConfigError
  void validate() const;
};

/// What one tick was about; a plain value for the log.
struct MissionRecord {
  Phase phase = Phase::Choose;
  EndReason reason = EndReason::Running;
  Kinematics kinematics;
  HandWrench wrench;
  MechanismEstimate estimate;
  Vector6d reference = Vector6d::Zero();  ///< Wanted hand twist
  WbcSolution solution;
  BaseLawOutput base;
  double wanted_speed = 0.0;
  double clearance_min = 0.0;  ///< Smallest believed distance [m]
};

/// The phases from approach to retreat, what ends or aborts each, and the command of every tick.
/// It sees RobotState and nothing else.
class Mission {
 public:
  /// @param direction_guess  Unit vector in the odometry frame, or none
  /// @throws ConfigError, ModelError
  Mission(const RobotModel& model, const MissionConfig& config, std::optional<Vector3d> direction_guess, std::uint64_t seed);
  ~Mission();
  Mission(const Mission&) = delete;
  Mission& operator=(const Mission&) = delete;

  /// One tick. Output always finite and inside the limits.
  [[nodiscard]] Command step(const RobotState& state) noexcept;

  /// Asks for a safe stop; the mission ends as Interrupted.
  void interrupt() noexcept;

  [[nodiscard]] bool finished() const noexcept;
  [[nodiscard]] bool reached_goal() const noexcept;
  [[nodiscard]] Phase phase() const noexcept;
  /// Phase in which it ended.
  [[nodiscard]] Phase end_phase() const noexcept;
  [[nodiscard]] EndReason reason() const noexcept;
  /// The reason in words with the numbers that decided.
  [[nodiscard]] std::string explain() const;
  [[nodiscard]] const MissionRecord& record() const noexcept;
  /// How the handle is taken; its value is below 0 and its postures empty until that is chosen.
  [[nodiscard]] const GraspCandidate& chosen() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ajar
