#include "ajar/estimation/type_decision.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace ajar {

MechanismType decide_type(const Vector2d& kap, const Eigen::Matrix2d& C, const TypeThresholds& thresholds) noexcept {
  const double norm = kap.norm();
  // Below 1e-9 1/m the curvature has no direction; any will do, for the covariance is then far larger.
  const Vector2d u = norm > 1e-9 ? Vector2d(kap / norm) : Vector2d::UnitX();
  const double variance = u.dot(C * u);
  if (!kap.allFinite() || !C.allFinite() || !(variance > 0.0)) return MechanismType::Unknown;
  const double ks2 = thresholds.slide_curvature * thresholds.slide_curvature;
  const Eigen::LLT<Eigen::Matrix2d> factor(C + ks2 * Eigen::Matrix2d::Identity());
  if (factor.info() != Eigen::Success) return MechanismType::Unknown;
  const double slide = kap.dot(factor.solve(kap));
  const double lack = std::max(0.0, thresholds.hinge_curvature - norm);
  const double hinge = lack * lack / variance;
  if (slide - hinge > thresholds.threshold) return MechanismType::Hinge;
  if (hinge - slide > thresholds.threshold) return MechanismType::Slide;
  return MechanismType::Unknown;
}

}  // namespace ajar
