#include "track_bins.hpp"

#include <algorithm>

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

constexpr std::size_t kLeastSamples = 8;      // six parameters of a circle in space
constexpr double kLeastExtent = 1e-3;         // samples closer together than this are one point [m]
constexpr double kSlideSagitta = 5e-3;        // [m]
constexpr double kMostSlideCurvature = 0.25;  // [1/m]

}  // namespace

// Measured on recordings: white and correlated part of each kind (docs/equations.md#identify).
PoseNoise noise_of(SensorKind sensor) {
  PoseNoise noise;  // the robot's, with orientation
  noise.position_walk = noise.rotation_walk = 0.0;
  if (sensor == SensorKind::MotionCapture) {
    noise.position_white = 0.2e-3;
    noise.position_correlated = 0.8e-3;
  }
  if (sensor == SensorKind::Vision) {
    noise.position_white = 0.5e-3;
    noise.position_correlated = 2.5e-3;
  }
  return noise;
}

// A robot's hand follows its mechanism closely. What people and cameras record of furniture bends on its own: slides by
// about 5 mm from a line (the measured sliding cabinets by 4-7 mm), which over a length S is a curvature of 8 · 5 mm/S².
TypeThresholds thresholds_of(SensorKind sensor, double length) {
  TypeThresholds thresholds;
  if (sensor == SensorKind::Robot) return thresholds;
  const double bend = 8.0 * kSlideSagitta / std::max(length * length, 1e-9);
  return {.slide_curvature = std::clamp(bend, thresholds.slide_curvature, kMostSlideCurvature),
          .threshold = 20.0,
          .slide_threshold = 20.0};
}

std::vector<Vector3d> handle_positions(const Track& track, double stiffness, const std::string& name) {
  std::vector<Vector3d> positions;
  for (const TrackSample& sample : track.samples) {
    if (!sample.position.allFinite() || !sample.rotation.allFinite() || !sample.force.allFinite()) {
      throw ConfigError(name + ": sample " + std::to_string(positions.size() + 1) + " is not finite");
    }
    positions.push_back(sample.position - sample.force / stiffness);
  }
  if (positions.size() < kLeastSamples) {
    throw ConfigError(name + ": " + std::to_string(positions.size()) + " samples; at least " +
                      std::to_string(kLeastSamples));
  }
  double extent = 0.0;
  for (const Vector3d& p : positions) extent = std::max(extent, (p - positions.front()).norm());
  if (!(extent > kLeastExtent)) throw ConfigError(name + ": all samples are at one point");
  return positions;
}

double median_of(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

BinnedTrack bins_of(const Track& track, const std::vector<Vector3d>& positions, const std::vector<bool>& inlier,
                    const std::vector<double>& arc, double length) {
  BinnedTrack binned;
  Vector3d turn = Vector3d::Zero();
  Matrix3d reference = Matrix3d::Identity();
  const auto close = [&] {
    if (!binned.bins.empty()) binned.bins.back().rotation = exp_so3(turn) * reference;
  };
  for (std::size_t i = 0; i < positions.size(); ++i) {
    if (!inlier[i]) continue;
    const Matrix3d& R = track.samples[i].rotation;
    if (binned.bins.empty() || std::abs(arc[i] - binned.arcs.back()) > length) {
      close();
      binned.bins.push_back({.count = 1.0, .position = positions[i]});
      binned.arcs.push_back(arc[i]);
      turn.setZero();
      reference = R;
      continue;
    }
    PathBin& bin = binned.bins.back();
    bin.count += 1.0;
    bin.position += (positions[i] - bin.position) / bin.count;
    binned.arcs.back() += (arc[i] - binned.arcs.back()) / bin.count;
    turn += (log_so3(R * reference.transpose()) - turn) / bin.count;
  }
  close();
  return binned;
}

}  // namespace ajar
