#pragma once

#include "ajar/core/types.hpp"

namespace ajar {

/// Skew-symmetric matrix of a vector: hat(w) a = w × a.
[[nodiscard]] Matrix3d hat(const Vector3d& w);

/// Rotation by the vector w (Rodrigues' formula, series below |w| = 1e-4). (docs/equations.md#so3)
[[nodiscard]] Matrix3d exp_so3(const Vector3d& w);

/// Rotation vector of R, |w| ≤ π; accurate near 0 and near π. (docs/equations.md#so3)
[[nodiscard]] Vector3d log_so3(const Matrix3d& R);

/// Left Jacobian of SO(3): d exp(w) = hat(J_l(w) dw) exp(w). (docs/equations.md#so3)
[[nodiscard]] Matrix3d left_jacobian_so3(const Vector3d& w);

/// Angle wrapped to (-π, π].
[[nodiscard]] double wrap_angle(double angle);

/// Angle folded to (-π/2, π/2].
[[nodiscard]] double wrap_half_turn(double angle);

/// Some unit vector perpendicular to a non-zero vector.
[[nodiscard]] Vector3d any_perpendicular(const Vector3d& v);

}  // namespace ajar
