#pragma once

#include "ajar/core/types.hpp"

namespace ajar {

using Matrix32d = Eigen::Matrix<double, 3, 2>;
using Matrix9d = Eigen::Matrix<double, 9, 9>;

/// A point of a circle or line that starts at the origin along the first axis, with its derivative.
struct CurvePoint {
  Vector3d q = Vector3d::Zero();    ///< Position, local axes [m]
  Vector3d t = Vector3d::UnitX();   ///< Tangent, unit, local axes [-]
  Matrix32d D = Matrix32d::Zero();  ///< dq/dkap, shape (3, 2), local axes [m²]
};

/// Curvature vector in local axes, k = (0, kap1, kap2), so that k·x = 0 holds exactly.
[[nodiscard]] inline Vector3d local_curvature(const Vector2d& kap) { return {0.0, kap.x(), kap.y()}; }

/// Evaluates the local curve at arc s.
///
/// q = (c1, c2 kap2, -c2 kap1), t = (cos θs, c1 kap2, -c1 kap1), c1 = sin(θs)/θ, c2 = (1 - cos θs)/θ², θ = |kap|
/// (docs/equations.md#estimator)
///
/// @param kap  Curvature along the second and third axis, shape (2) [1/m]
/// @param s    Arc from the anchor [m]
[[nodiscard]] CurvePoint curve_at(const Vector2d& kap, double s) noexcept;

/// Derivative of the nine curve parameters when their anchor moves by ds along the curve.
///
/// Parameters (a1, a2 offset across x; w1, w2 turn of the frame; dkap1, dkap2; φ1…φ3 turn of the grasp), all in the moving
/// frame; the new anchor stays in the plane across the new x, and roll about x is dropped. (docs/equations.md#estimator)
///
/// @param kap  Curvature, shape (2) [1/m]
/// @param ds   Arc [m]
/// @return shape (9, 9)
[[nodiscard]] Matrix9d curve_transport(const Vector2d& kap, double ds) noexcept;

}  // namespace ajar
