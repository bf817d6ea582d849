#pragma once

#include <string>

#include "ajar/wbc/input_limits.hpp"
#include "ajar/wbc/pseudo_inverse.hpp"
#include "ajar/wbc/whole_body_controller.hpp"

namespace ajar {

struct ThesisConfig {
  double w_base = 100.0;           ///< ρ of the base inputs in W, joints have 1 [-]
  double lambda_max = 0.05;        ///< Damping at a singularity [m/s]
  double epsilon = 0.05;           ///< σ_min of S J W^(-1/2) below which damping starts [m/s]
  double alpha1 = 20.0;            ///< Of the distance task z1 [1/s]
  double alpha2 = 2.0;             ///< Of the heading task z2 [1/s]
  double alpha3 = 0.1;             ///< Of its integral [1/s²]; unused with feed-forward
  double distance = 0.75;          ///< Wanted hand-base distance [m]
  bool feed_forward = true;        ///< ψ̇ instead of the integral
  double integral_max = 0.5;       ///< Bound of the integral of the heading error [rad s]
  std::string heading = "signed";  ///< signed | folded: error modulo π with hysteresis, or folded into ±90°
  std::string limits = "common";   ///< common | each: scaling as a whole, or every input clipped by itself as the thesis did
  double constant_damping = 0.0;   ///< λ added to J W⁻¹ Jᵀ everywhere as in the thesis's code; 0 = adaptive damping
  bool unit_weights = false;       ///< W = I as in the thesis's code
  bool printed = false;            ///< Equations as printed: base column, λ₀/(μ + ε), damped projector, arccos
  bool operator==(const ThesisConfig&) const = default;
  /// @throws ConfigError
  void validate() const;
};

/// Wanted heading of the base: along the commanded planar motion of the hand. (docs/equations.md#null-space)
struct HeadingReference {
  double heading = 0.0;  ///< ψ [rad]
  double rate = 0.0;     ///< ψ̇ [rad/s]
  bool valid = false;    ///< False: too little planar motion to define a heading
};

/// ψ and ψ̇ of a twist whose point velocity turns with it: v̇ = ω × v. (docs/equations.md#null-space, 2.9 corrected)
/// @param twist  Linear first, world axes
[[nodiscard]] HeadingReference heading_reference(const Vector6d& twist) noexcept;

/// z1 = -α1 (d - d_t) J_dᵀ. (docs/equations.md#null-space, 4.35)
[[nodiscard]] InputVector distance_task(const Kinematics& kinematics, double wanted, double alpha) noexcept;

/// The thesis's resolution: weighted pseudo-inverse with adaptive damping, exact W-weighted projector, null-space tasks
/// z1 (distance) and z2 (heading), common scaling at the limits. (docs/equations.md#pinv, #projector, #null-space)
///
/// Common scaling: correction, tangential motion and null-space motion are each scaled as a whole, in this order of
/// priority, into the rate, position and wheel limits; then each changes by one common factor from tick to tick so that
/// the accelerations hold. With limits = each every input is clipped alone at its rate limit and nothing bounds the
/// accelerations, as in the thesis's experiments.
class ThesisController {
 public:
  /// @param limits  The fields of WbcConfig that bound the inputs and L
  /// @throws ConfigError
  ThesisController(const RobotModel& model, const ThesisConfig& config, const WbcConfig& limits, double period);

  /// Forgets the last command, the heading's integral and the driving sense.
  void reset() noexcept;
  void reset(const InputVector& last_command) noexcept;

  /// Uses kinematics, q, tangential, correction and base_fixed of the problem. No allocation, no exception, bounded time.
  [[nodiscard]] WbcStatus solve(const WbcProblem& problem, WbcSolution& out) noexcept;

  /// Brakes to a standstill within the acceleration limits, one tick at a time.
  void brake(WbcSolution& out) noexcept;

 private:
  // What the command is made of: u = correction + factor · tangential + idle.
  struct Parts {
    InputVector correction;
    double factor = 0.0;
    InputVector idle;
  };

  // J⁺, N and what they are made from.
  struct Resolution {
    PseudoInverse inverse;
    InputMatrix projector;
  };

  void forget() noexcept;
  [[nodiscard]] double heading_error(double yaw, const HeadingReference& reference) noexcept;
  [[nodiscard]] double heading_task(double yaw, const Vector6d& twist) noexcept;
  [[nodiscard]] Resolution resolve(const HandJacobian& J) const noexcept;
  [[nodiscard]] InputVector clipped(const InputBounds& bounds, const InputVector& wanted) noexcept;
  [[nodiscard]] InputVector null_space_motion(const WbcProblem& problem) noexcept;
  [[nodiscard]] InputVector scaled(const InputBounds& bounds, const InputVector& tangential, const Parts& wanted) noexcept;

  ThesisConfig config_;
  WbcConfig limits_config_;
  InputLimits limits_;
  InputVector weight_;
  InputVector last_;
  Parts parts_;
  double heading_integral_ = 0.0;
  int drive_sense_ = 0;
  bool saturated_ = false;
};

}  // namespace ajar
