#pragma once

#include "ajar/core/types.hpp"
#include "ajar/wbc/pseudo_inverse.hpp"

namespace ajar {

/// Equations of the thesis as they are printed. They stand here so that a test can show where each of them fails; nothing
/// but `control.thesis.printed` uses them. (docs/errata.md)

/// Turns a geometric arm Jacobian of axes A into world axes by the printed adjoint [R 0; [p]× R'] with R' = I.
/// (docs/equations.md#printed, 4.6, 4.7) @param J_A  Linear rows first, axes A, shape (6, n)  @param X_WA  Pose of A
[[nodiscard]] HandJacobian printed_arm_jacobian(const HandJacobian& J_A, const Pose& X_WA);

/// The hand Jacobian with the printed base column (0, 0, 1, 0, 0, 0): turning the base does not move the hand.
/// (docs/equations.md#printed, 4.10)
[[nodiscard]] HandJacobian printed_base_column(HandJacobian J) noexcept;

/// λ = λ₀/(μ + ε), μ = √det(J Jᵀ): never zero. (docs/equations.md#printed, 4.18, 4.19)
[[nodiscard]] double printed_damping(const HandJacobian& J, double largest, double epsilon) noexcept;

/// W⁻¹ Jᵀ (J W⁻¹ Jᵀ + λ I)⁻¹, rows in mixed units; λ > 0. Zero for input that is not finite. No allocation.
/// (docs/equations.md#printed, 4.15)
[[nodiscard]] InverseJacobian ridge_inverse(const HandJacobian& J, const InputVector& weight, double lambda) noexcept;

/// I - J⁺ J from whatever inverse is given; with a damped one it lets the null-space tasks move the hand.
/// (docs/equations.md#printed, 4.22)
[[nodiscard]] InputMatrix printed_projector(const HandJacobian& J, const InverseJacobian& inverse) noexcept;

/// arccos of the angle between heading and planar hand velocity, never negative; 0 without planar motion.
/// (docs/equations.md#printed, 2.9) @param twist  Linear first, world axes
[[nodiscard]] double printed_heading_error(double yaw, const Vector6d& twist) noexcept;

}  // namespace ajar
