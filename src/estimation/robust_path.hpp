#pragma once

#include <span>
#include <vector>

#include "ajar/estimation/path_state.hpp"

namespace ajar {

/// A path through most of a set of points, and how far they scatter about it.
struct RobustPath {
  PathState path;        ///< Only F, kap, p are used
  double scatter = 0.0;  ///< Standard deviation of one component across the path, by the median [m]
};

/// Fits a circle or line that half of the points may contradict: least median over circles through three points, then
/// reweighted least squares. (docs/equations.md#identify)
///
/// @param points  In order of travel, at least 8, not all in one place
[[nodiscard]] RobustPath fit_robust_path(std::span<const Vector3d> points);

/// Position and distance of points in order of travel along a path, each search starting from the point before.
struct PathProjection {
  std::vector<double> arc;       ///< [m]
  std::vector<double> distance;  ///< [m]
};
[[nodiscard]] PathProjection project_on(const PathState& path, std::span<const Vector3d> points);

}  // namespace ajar
