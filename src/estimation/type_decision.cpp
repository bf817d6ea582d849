#include "ajar/estimation/type_decision.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace ajar {

TypeDistances type_distances(const Vector2d& kap, const Eigen::Matrix2d& C, const TypeThresholds& thresholds) noexcept {
  const double norm = kap.norm();
  // Below 1e-9 1/m the curvature has no direction; any will do, for the covariance is then far larger.
  const Vector2d u = norm > 1e-9 ? Vector2d(kap / norm) : Vector2d::UnitX();
  const double variance = u.dot(C * u);
  if (!kap.allFinite() || !C.allFinite() || !(variance > 0.0)) return {};
  const double ks2 = thresholds.slide_curvature * thresholds.slide_curvature;
  const Eigen::LLT<Eigen::Matrix2d> factor(C + ks2 * Eigen::Matrix2d::Identity());
  if (factor.info() != Eigen::Success) return {};
  const double lack = std::max(0.0, thresholds.hinge_curvature - norm);
  return {kap.dot(factor.solve(kap)), lack * lack / variance};
}

MechanismType decide_type(const Vector2d& kap, const Eigen::Matrix2d& C, const TypeThresholds& thresholds) noexcept {
  const TypeDistances distance = type_distances(kap, C, thresholds);
  if (distance.slide - distance.hinge > thresholds.threshold) return MechanismType::Hinge;
  if (distance.hinge - distance.slide > thresholds.slide_threshold) return MechanismType::Slide;
  return MechanismType::Unknown;
}

}  // namespace ajar
