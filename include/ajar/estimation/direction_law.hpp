#pragma once

#include "ajar/core/types.hpp"

namespace ajar {

/// Gains of the adaptive law at one speed. (docs/equations.md#adaptive-law)
struct AdaptiveGains {
  double gamma = 0.0;           ///< γ: turn of x̂ per normal velocity [s/m²]
  double Gamma = 0.0;           ///< Γ: change of k̂ per normal velocity [1/m²]
  double curvature_leak = 2.0;  ///< λ_k: decay of k̂ along x̂ [1/s]
};

/// Direction and curvature as the adaptive law carries them.
struct DirectionState {
  Vector3d x = Vector3d::UnitX();  ///< x̂, unit, world axes [-]
  Vector3d k = Vector3d::Zero();   ///< k̂, world axes [1/m]
};

/// Places both poles of the linearised estimation error at the same bandwidth whatever the speed.
///
/// γ = 2 ζ w0/v², Γ = w0²/v², v² = max(speed², v_min²), from the error equation s² + γ v² s + Γ v² = 0
/// (docs/equations.md#adaptive-law)
///
/// @param bandwidth      w0 [1/s]
/// @param damping_ratio  ζ [-]
/// @param speed          Handle speed [m/s]; below 0.02 m/s the gains grow no further
[[nodiscard]] AdaptiveGains adaptive_gains(double bandwidth, double damping_ratio, double speed) noexcept;

/// Integrates the adaptive law over one tick, on the sphere.
///
/// x̂' = γ s P v_ref - s x̂ × k̂, k̂' = Γ x̂ × v_ref - λ_k x̂ (x̂·k̂), P v_ref = -P v_f
/// (docs/equations.md#adaptive-law, Eq. 5.1, 5.2 corrected, 5.4 with its sign corrected)
///
/// @param state   Present estimate
/// @param v_ref   s x̂ - P v_f, or the measured handle velocity [m/s]
/// @param speed   s, signed handle speed along x̂ [m/s]
/// @param gains   γ, Γ, λ_k
/// @param dt      [s]
/// @return the new estimate; the old one when a value is not finite
[[nodiscard]] DirectionState step_adaptive_law(const DirectionState& state, const Vector3d& v_ref, double speed,
                                               const AdaptiveGains& gains, double dt) noexcept;

/// Share of a force across the way that a pull along a doubtful direction cannot explain: max(0, 1 - |x̂·f| sin δ_0/|P f|).
/// (docs/equations.md#adaptive-law)
///
/// @param pull    x̂·f [N]
/// @param normal  |P f| [N]
/// @param doubt   sin δ_0, δ_0 the largest error of the direction [-]
[[nodiscard]] double unexplained_share(double pull, double normal, double doubt) noexcept;

/// Turns a direction away from the reaction of a handle that does not move: x̂' = -ρ P f/max(|P f|, 5 N).
/// (docs/equations.md#adaptive-law)
///
/// @param x      Direction, unit, world axes [-]
/// @param force  Robot on handle, world axes [N]; normal parts up to 2 N are taken for sensor bias
/// @param rate   ρ: largest turning rate [rad/s]
/// @param dt     [s]
[[nodiscard]] Vector3d turn_from_reaction(const Vector3d& x, const Vector3d& force, double rate, double dt) noexcept;

/// Turns a direction towards another by at most a stated angle.
[[nodiscard]] Vector3d turn_towards(const Vector3d& x, const Vector3d& target, double max_angle) noexcept;

}  // namespace ajar
