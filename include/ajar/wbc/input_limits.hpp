#pragma once

#include <array>

#include "ajar/wbc/whole_body_controller.hpp"

namespace ajar {

/// Limits of the inputs as the controllers use them: the robot's own, tightened by the configuration.
struct InputLimits {
  int joints = 0;              ///< n
  bool base_moves = false;     ///< False: a robot bolted to the floor
  JointVector position_lower;  ///< Margin taken off, shape (n) [rad or m]
  JointVector position_upper;  ///< Margin taken off, shape (n) [rad or m]
  InputVector speed_lower;     ///< shape (n + 2) [rad/s or m/s]
  InputVector speed_upper;     ///< shape (n + 2) [rad/s or m/s]
  InputVector acceleration;    ///< Away from zero, shape (n + 2) [rad/s² or m/s²]
  InputVector deceleration;    ///< Towards zero in need, shape (n + 2) [rad/s² or m/s²]
  double wheel_reach = 0.0;    ///< Rim speed at the wheel-speed limit [m/s]
  double half_track = 0.0;     ///< Half the distance of the driven wheels [m]
  double period = 0.002;       ///< [s]
};

/// What the inputs may be in this tick, and which limit each bound comes from. lower ≤ upper always.
struct InputBounds {
  InputVector rate_lower;  ///< Without the acceleration limits: ≤ 0, shape (n + 2)
  InputVector rate_upper;  ///< Without the acceleration limits: ≥ 0, shape (n + 2)
  InputVector lower;       ///< shape (n + 2) [rad/s, m/s]
  InputVector upper;       ///< shape (n + 2) [rad/s, m/s]
  std::array<BindingLimit, kMaxInputs> lower_limit{};
  std::array<BindingLimit, kMaxInputs> upper_limit{};
};

/// Joins the robot's limits with the configuration.
/// @throws ConfigError  if the period is not in (0, 0.1]
[[nodiscard]] InputLimits make_input_limits(const RobotModel& model, const WbcConfig& config, double period);

/// Fastest rate from which constant deceleration A, in steps of T, stops within a distance.
/// d/(nT) + AT(n - 1)/2 with n = max(1, ⌈(√(1 + 8d/(AT²)) - 1)/2⌉), at most d/T and √(2Ad); 0 for d ≤ 0.
/// (docs/equations.md#qp)
/// @param distance      d, to the position limit [rad]
/// @param deceleration  A [rad/s²]
/// @param period        T [s]
[[nodiscard]] double stopping_rate(double distance, double deceleration, double period) noexcept;

/// Bounds of this tick: rate before position before acceleration, wheel speeds before base acceleration.
/// Acceleration yields when it contradicts the others, so the bounds are never empty. (docs/equations.md#qp)
/// @param q           Measured positions, finite, shape (n)
/// @param last        Last command, finite, shape (n + 2)
/// @param base_fixed  The base brakes to zero and stays
/// @param need        0 … 1: how much of the deceleration beyond the acceleration the base may brake with. Granted always,
///                    it would make noise slow the base: down fast, up slowly
[[nodiscard]] InputBounds input_bounds(const InputLimits& limits, const JointVector& q, const InputVector& last,
                                       bool base_fixed, double need = 0.0) noexcept;

/// Every input one step of its deceleration nearer to zero, inside the speed limits.
[[nodiscard]] InputVector braked_input(const InputLimits& limits, const InputVector& last) noexcept;

/// Scales ω and v by one factor so that no wheel exceeds its limit: the base keeps its path.
void limit_wheels(const InputLimits& limits, InputVector& u) noexcept;

}  // namespace ajar
