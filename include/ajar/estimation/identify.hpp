#pragma once

#include <array>
#include <string>
#include <vector>

#include "ajar/estimation/mechanism_estimate.hpp"
#include "ajar/estimation/pose_noise.hpp"
#include "ajar/estimation/track.hpp"

namespace ajar {

/// What recorded a track: it decides the noise that is assumed, and whether the orientation may belong to a rigid grasp.
enum class SensorKind {
  Auto,           ///< Noise is learnt from the track; orientation is used where it agrees with the positions
  Robot,          ///< Forward kinematics of an arm with a grasp
  MotionCapture,  ///< Markers; positions only
  Vision          ///< Camera; positions only
};

struct IdentifyConfig {
  SensorKind sensor = SensorKind::Auto;
  double grasp_stiffness = 1e4;           ///< K_c of p - f/K_c where forces are recorded, > 0 [N/m]
  double relative_curvature_floor = 0.1;  ///< Furniture is no circle: part of σ_k in proportion to |k|, >= 0 [-]
  /// @throws ConfigError
  void validate() const;
};

/// The mechanism behind a track. Standard deviations of vectors are square roots of traces of their covariance.
struct Identification {
  MechanismType type = MechanismType::Unknown;
  double type_confidence = 0.5;  ///< Share of the likelier of hinge and slide, both thought as likely before, 0.5 to 1 [-]
  double against_slide = 0.0;    ///< D_s: squared distance of the curvature from a slide [-]
  double against_hinge = 0.0;    ///< D_h: squared distance of the curvature from a hinge [-]
  double threshold = 0.0;        ///< T: difference of the two that decides [-]

  Vector3d direction = Vector3d::UnitX();  ///< Of motion at the first sample, unit [-]
  double direction_sigma = 0.0;            ///< [rad]
  Vector3d curvature = Vector3d::Zero();   ///< k = axis/radius [1/m]
  double curvature_sigma = 0.0;            ///< Model floor included [1/m]
  double curvature_noise_sigma = 0.0;      ///< Of measuring alone [1/m]

  Vector3d axis = Vector3d::Zero();   ///< Unit axis of the hinge, right-handed with the motion [-]; zero without curvature
  double axis_sigma = 0.0;            ///< [rad]
  Vector3d point = Vector3d::Zero();  ///< On the hinge's axis, nearest to the path; `start` without curvature [m]
  double point_sigma = 0.0;           ///< [m]
  double radius = 0.0;                ///< 1/|k|; infinite without curvature [m]
  double radius_sigma = 0.0;          ///< [m]
  double radius_min = 0.0;            ///< 1/(|k| + 2σ): what the radius exceeds at 2σ, also for a slide [m]

  int samples = 0;
  int outliers = 0;
  double explained = 1.0;  ///< Share of the way that belongs to the path; below 0.55 the type is unknown [-]
  double length = 0.0;     ///< Extent of the path along itself [m]
  double angle = 0.0;      ///< |k| times that [rad]
  double rms = 0.0;        ///< Of the distance of the inliers from the path [m]
  double rms_line = 0.0;   ///< Of their distance from the best straight line [m]
  std::array<double, 2> half_curvature{0.0, 0.0};  ///< |k| of the first and the second half of the path [1/m]
  double against_one_curve = 0.0;  ///< Squared distance of the two halves' curvatures; beyond 13.8 the type is unknown [-]
  bool uses_rotation = false;      ///< Orientation took part: the grasp turns with the mechanism
  PoseNoise noise;                 ///< Noise that the ± are made of, as assumed or learnt

  std::vector<bool> inlier;           ///< Of each sample
  std::vector<double> arc;            ///< Position of each sample along the path, from the first one [m]
  std::vector<double> distance;       ///< Of each sample from the path [m]
  Vector3d start = Vector3d::Zero();  ///< Point of the path next to the first sample [m]
  double start_sigma = 0.0;           ///< Across the path [m]

  /// Point of the path at an arc from `start` [m].
  [[nodiscard]] Vector3d at(double s) const;
};

/// Fits one hinge or slide to a whole track: robust start, noise, generalised least squares, comparison of the types.
/// (docs/equations.md#identify)
///
/// @param name  What messages call the track
/// @throws ConfigError for fewer than 8 samples, samples that are not finite or all at one point
/// Set-up only.
[[nodiscard]] Identification identify(const Track& track, const IdentifyConfig& config = {},
                                      const std::string& name = "track");

}  // namespace ajar
