#pragma once

#include <span>

#include "ajar/estimation/mechanism_estimate.hpp"

namespace ajar::bench {

/// What a fit of points says at the last of them.
struct PointFit {
  Vector3d direction = Vector3d::UnitX();  ///< Along the order of the points [-]
  Vector3d curvature = Vector3d::Zero();   ///< [1/m]
  Vector3d point = Vector3d::Zero();       ///< Of the path next to the last point [m]
  MechanismType type = MechanismType::Unknown;
};

/// Plane by principal components, circle in it by Taubin's algebraic fit (G. Taubin, IEEE PAMI 13(11), 1991).
[[nodiscard]] PointFit fit_circle_algebraic(std::span<const Vector3d> points);

/// Least squares of the distances to a circle in space, errors taken for white, from the algebraic fit.
/// @param huber  Distance beyond which a residual counts linearly; infinite: plain least squares [m]
[[nodiscard]] PointFit fit_circle_geometric(std::span<const Vector3d> points, double huber = INFINITY);

/// Line or circle, whichever has the lower Bayesian information criterion, as Sturm, Stachniss and Burgard (JAIR 41, 2011)
/// choose: -2 ln L + K ln n, 5 mm of noise, K = 6 for a prismatic and 9 for a rotational joint.
[[nodiscard]] PointFit fit_by_bic(std::span<const Vector3d> points);

/// Root mean square distance to the best line of the points [m].
[[nodiscard]] double line_rms(std::span<const Vector3d> points);

}  // namespace ajar::bench
