#pragma once

#include <memory>
#include <optional>

#include "ajar/model/clearance.hpp"
#include "ajar/model/robot_model.hpp"
#include "ajar/navigation/base_motion.hpp"

namespace ajar {

struct WbcConfig {
  double hand_weight =
      1e4;  ///< Hand twist rows; 1e8 is exact, 1e4 lets noise of the twist pass by (docs/equations.md#qp) [-]
  double speed_weight = 1.0;           ///< Tangential speed factor towards 1, below the hand and above the rest [-]
  double base_speed_weight = 20.0;     ///< (v - v_ref)² [s²/m²]
  double base_turn_weight = 1.8;       ///< (ω - ω_ref)² [s²/rad²]
  double rate_weight = 1e-2;           ///< ((q̇_i - wanted) / q̇_max)² [-]
  double slack_weight = 1e6;           ///< Of the one common slack of the clearance rows [-]
  double length = 0.3;                 ///< L: scale of the rotation rows [m]
  double singular_onset = 0.08;        ///< σ_min below which joint rates are damped [-]
  double singular_damping = 3.0;       ///< At σ_min = 0 [-]
  double free_axis_weight = 1.0;       ///< Of the weak turn about a free grip axis [-]
  double rate_scale = 0.32;            ///< Joint rates used, share of the limit [-]
  double joint_acceleration = 8.0;     ///< Upper bound on the model's own limit [rad/s²]
  double base_forward = 0.5;           ///< [m/s]
  double base_reverse = 0.3;           ///< [m/s]
  double base_yaw_rate = 0.6;          ///< [rad/s]
  double base_acceleration = 0.3;      ///< [m/s²]
  double base_yaw_acceleration = 0.8;  ///< [rad/s²]
  double base_braking = 5.0;           ///< How many times faster than it speeds up the base may brake [-]
  double position_margin = 0.02;       ///< Kept from each joint limit [rad]
  bool operator==(const WbcConfig&) const = default;
  /// @throws ConfigError
  void validate() const;
};

/// How the base moves while the joint rates of this tick act: it answers later than the arm. (docs/equations.md#late)
struct BaseMotion {
  BaseTwist twist;     ///< If the last command goes on
  double share = 0.0;  ///< Part of a change of the command that shows by then, 0 … 1 [-]
};

/// One tick's problem. Twists are linear first, world axes, at the hand.
struct WbcProblem {
  const Kinematics* kinematics = nullptr;      ///< At the measured state
  const JointVector* q = nullptr;              ///< Measured positions
  std::optional<BaseMotion> base_motion;       ///< None: the base follows its command at once
  Vector6d tangential = Vector6d::Zero();      ///< Scaled by the speed factor s
  Vector6d correction = Vector6d::Zero();      ///< Never scaled
  Vector3d free_axis = Vector3d::Zero();       ///< Grip turns freely about it: that row becomes weak; zero = none
  double free_axis_rate = 0.0;                 ///< Weakly wanted turn about it, replaces that part of both twists [rad/s]
  BaseTwist base;                              ///< Wanted base motion
  JointVector rates;                           ///< Joint rates wanted beside the hand, e.g. towards a posture; empty = 0
  bool base_fixed = false;                     ///< Base must stand
  bool keep_heading = false;                   ///< Base turns as wanted, whatever is near: it keeps to a straight way
  const ClearanceResult* clearance = nullptr;  ///< nullptr = no rows
  ClearanceConfig clearance_config;            ///< Distances and rates that turn the distances into rows
  Vector3d leaf_velocity_at_hand = Vector3d::Zero();  ///< Of the believed leaf at the hand for s = 1 [m/s]
  Vector3d leaf_turn = Vector3d::Zero();              ///< Of the believed leaf for s = 1 [rad/s]
  int leaf_obstacle = -1;                             ///< Which obstacle index moves with the leaf
};

enum class WbcStatus {
  Ok,       ///< Hand task met
  Slowed,   ///< s < 1: some limit binds
  Limited,  ///< The hand task itself is not met
  Damped,   ///< Near a singular arm
  Stopped,  ///< The solver was cut short: the command meets all limits, but is not the best
  Invalid   ///< Input not finite or the solver failed; the command brakes within the limits
};

/// Which limit binds most.
enum class BindingLimit {
  None,
  JointPosition,
  JointRate,
  JointAcceleration,
  BaseSpeed,
  WheelSpeed,
  BaseAcceleration,
  Clearance
};

struct WbcSolution {
  InputVector u;              ///< (q̇, ω, v), always finite and inside the limits
  double speed_factor = 0.0;  ///< s in [0, 1]
  double residual = 0.0;      ///< Of the hand's linear rows [m/s]
  double sigma_min = 0.0;     ///< Of the arm (docs/equations.md#sigma)
  double slack = 0.0;         ///< Of the clearance rows [m/s]
  WbcStatus status = WbcStatus::Invalid;
  BindingLimit binding = BindingLimit::None;
};

/// Bounded QP over joint rates, base turning and driving, tangential speed factor and one slack. Where the base moves
/// otherwise than it is told now, a second one finds the joint rates against that motion. (docs/equations.md#qp)
class WholeBodyController {
 public:
  /// @throws ConfigError
  WholeBodyController(const RobotModel& model, const WbcConfig& config, double period);
  ~WholeBodyController();
  WholeBodyController(const WholeBodyController&) = delete;
  WholeBodyController& operator=(const WholeBodyController&) = delete;

  /// Forgets the last command (it enters the acceleration limits).
  void reset() noexcept;
  void reset(const InputVector& last_command) noexcept;

  /// No allocation, no exception, bounded time.
  [[nodiscard]] WbcStatus solve(const WbcProblem& problem, WbcSolution& out) noexcept;

  /// Brakes to a standstill within the acceleration limits, one tick at a time.
  void brake(WbcSolution& out) noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ajar
