#pragma once

#include <span>

#include "ajar/estimation/path_state.hpp"

namespace ajar {

/// Largest number of bins of one batch fit; sizes its fixed matrices.
inline constexpr int kMaxFitBins = 24;

/// What a batch fit assumes beside the bins.
struct PathFitConfig {
  PoseNoise noise;               ///< Noise model
  bool use_rotation = true;      ///< False: positions only
  double curvature_prior = 3.0;  ///< Standard deviation of each component of k before any data [1/m]
};

/// Fits a circle or line with a grasp rotation to bins by Gauss-Newton, each bin's arc position eliminated.
///
/// Residuals are whitened by diag(σ²/n) + σ_c² exp(-|Δs|/L) + walk; the result is the joint posterior of the path and of the
/// correlated pose error at the newest bin. (docs/equations.md#estimator)
///
/// @param bins        4 to kMaxFitBins bins, oldest first; the first and the last must differ
/// @param config      Noise and prior
/// @param[out] state  Path at the newest bin, tangent along the order of the bins; untouched when the fit fails
/// @return false when the bins have no extent or the normal equations are not positive
///
/// Real time: no allocation, no exception, bounded time (at most 15 iterations).
[[nodiscard]] bool fit_path(std::span<const PathBin> bins, const PathFitConfig& config, PathState& state) noexcept;

}  // namespace ajar
