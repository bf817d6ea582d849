#pragma once

#include <vector>

#include "ajar/estimation/path_fit.hpp"

namespace ajar {

/// A path fitted to all bins of a track, with the covariance of its parameters at the anchor.
struct TrackFit {
  PathState path;                              ///< Only F, kap, p, R are used
  Matrix9d covariance = Matrix9d::Identity();  ///< Of (a, w, dkap, φ), shape (9, 9)
  double position_misfit = 0.0;                ///< Whitened squares of the position rows [-]
  double rotation_misfit = 0.0;                ///< Of the rotation rows [-]
  int rows = 0;                                ///< Position rows [-]
  bool good = false;
};

/// Generalised least squares on all bins, started from a path and the bins' arcs on it.
[[nodiscard]] TrackFit fit_track(const std::vector<PathBin>& bins, const std::vector<double>& arcs, const PathState& start,
                                 const PathFitConfig& config);

/// Learns level, white share and correlation length of position errors from the residuals of a fit, by restricted maximum
/// likelihood on a grid. (docs/equations.md#identify)
/// @return the noise with its position terms replaced; the given one when there is nothing to learn from
[[nodiscard]] PoseNoise learn_position_noise(const std::vector<PathBin>& bins, const std::vector<double>& arcs,
                                             const PathState& start, const PoseNoise& noise);

}  // namespace ajar
