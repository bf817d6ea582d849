#pragma once

#include <string>
#include <vector>

#include "ajar/estimation/identify.hpp"
#include "ajar/estimation/path_state.hpp"
#include "ajar/estimation/type_decision.hpp"

namespace ajar {

/// Noise that a kind of sensor is taken to have before the track says more. (docs/equations.md#identify)
[[nodiscard]] PoseNoise noise_of(SensorKind sensor);

/// Thresholds of the type decision for a kind of sensor and a path of that length [m].
[[nodiscard]] TypeThresholds thresholds_of(SensorKind sensor, double length);

/// Positions of the handle: those of the hand less the stretch of the grasp, stiffness [N/m].
/// @throws ConfigError when there are too few, one is not finite or all are at one point; it begins with `name`
[[nodiscard]] std::vector<Vector3d> handle_positions(const Track& track, double stiffness, const std::string& name);

[[nodiscard]] double median_of(std::vector<double> values);

/// Means of the inliers of each stretch of path, in order of recording, and where along the path they are.
struct BinnedTrack {
  std::vector<PathBin> bins;
  std::vector<double> arcs;  ///< [m]
};
[[nodiscard]] BinnedTrack bins_of(const Track& track, const std::vector<Vector3d>& positions,
                                  const std::vector<bool>& inlier, const std::vector<double>& arc, double length);

}  // namespace ajar
