#pragma once

#include "ajar/core/types.hpp"
#include "ajar/estimation/mechanism_estimate.hpp"

namespace ajar {

/// Thresholds of the type decision. (docs/equations.md#estimator)
struct TypeThresholds {
  double slide_curvature = 0.05;  ///< k_s: what a slide may curve [1/m]
  double hinge_curvature = 0.6;   ///< k_min: what a hinge curves at least [1/m]
  double threshold = 15.0;        ///< T: difference of the squared distances that decides for a hinge [-]
  double slide_threshold = 15.0;  ///< The same for a slide [-]
};

/// Squared distances of a curvature from a slide and from a hinge.
struct TypeDistances {
  double slide = 0.0;  ///< D_s [-]
  double hinge = 0.0;  ///< D_h [-]
};

/// D_s = kapᵀ (C + k_s² I)⁻¹ kap, D_h = max(0, k_min - |kap|)²/(uᵀ C u), u = kap/|kap| (docs/equations.md#estimator)
///
/// @param kap  Curvature across the motion, shape (2) [1/m]
/// @param C    Its covariance, model floor included, shape (2, 2) [1/m²]
/// @return zeros for values that are not finite or a covariance that is not positive
[[nodiscard]] TypeDistances type_distances(const Vector2d& kap, const Eigen::Matrix2d& C,
                                           const TypeThresholds& thresholds) noexcept;

/// Decides between hinge and slide: hinge if D_s - D_h > T, slide if D_h - D_s > T_s, otherwise unknown.
/// (docs/equations.md#estimator)
[[nodiscard]] MechanismType decide_type(const Vector2d& kap, const Eigen::Matrix2d& C,
                                        const TypeThresholds& thresholds) noexcept;

}  // namespace ajar
