#pragma once

#include "ajar/core/types.hpp"

namespace ajar {

/// One value per input and input, shape (n + 2, n + 2).
using InputMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMaxInputs, kMaxInputs>;
/// Maps a hand twist to inputs, shape (n + 2, 6).
using InverseJacobian = Eigen::Matrix<double, Eigen::Dynamic, 6, 0, kMaxInputs, 6>;

/// Where damping starts and how strong it gets.
struct Damping {
  double onset = 0.05;    ///< ε: σ_min of S J W^(-1/2) below which damping starts [m/s]
  double largest = 0.05;  ///< λ_max, at σ_min = 0 [m/s]
  double length = 0.3;    ///< L: scale of the rotation rows [m]
};

/// Damped inverse and what led to it.
struct PseudoInverse {
  InverseJacobian matrix;
  double sigma_min = 0.0;        ///< Of S J W^(-1/2) [m/s]
  double squared_damping = 0.0;  ///< λ² [m²/s²]
};

/// λ² = 0 for σ ≥ ε, else λ_max² (1 - (σ/ε)²). (docs/equations.md#pinv, 4.19 corrected)
[[nodiscard]] double squared_damping(double sigma_min, const Damping& damping) noexcept;

/// u = W⁻¹ Jᵀ (J W⁻¹ Jᵀ + λ² I)⁻¹ V with rows scaled by S = diag(1,1,1,L,L,L): the minimum of
/// |S(J u - V)|² + λ² uᵀ W u. (docs/equations.md#pinv, 4.15 corrected)
/// @param J       Hand Jacobian, shape (6, n + 2)
/// @param weight  Diagonal of W, > 0, shape (n + 2)
/// No allocation, no exception, bounded time; zero for input that is not finite.
[[nodiscard]] PseudoInverse damped_pseudo_inverse(const HandJacobian& J, const InputVector& weight,
                                                  const Damping& damping) noexcept;

/// N = I - W⁻¹ Jᵀ (J W⁻¹ Jᵀ)⁻¹ J without forming the inverse: J N = 0 to round-off whatever the conditioning.
/// (docs/equations.md#projector, 4.22 corrected)
/// @param J       Hand Jacobian, shape (6, n + 2)
/// @param weight  Diagonal of W, > 0, shape (n + 2)
/// No allocation, no exception, bounded time; zero for input that is not finite.
[[nodiscard]] InputMatrix null_space_projector(const HandJacobian& J, const InputVector& weight) noexcept;

}  // namespace ajar
