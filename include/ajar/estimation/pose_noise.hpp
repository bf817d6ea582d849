#pragma once

namespace ajar {

/// Measurement noise of one kind of pose source, and how fast the model may drift. (docs/equations.md#estimator)
///
/// The defaults are those of an arm with a rigid grasp on a differential base: 0.3 mm white and 0.5 mm correlated, 0.1° and
/// 0.2°; the walks cover a base whose two wheel radii are each known to 1 % (docs/equations.md#estimator, "drift").
struct PoseNoise {
  double position_white = 0.3e-3;       ///< Per sample [m]
  double position_correlated = 0.5e-3;  ///< [m]
  double rotation_white = 0.0017;       ///< Per sample [rad]
  double rotation_correlated = 0.0035;  ///< [rad]
  double correlation_length = 0.05;     ///< Of arc [m]
  double position_walk = 4e-5;          ///< Variance per metre of base travel [m²/m]
  double rotation_walk = 3e-5;          ///< Variance per metre of base travel [rad²/m]
  bool operator==(const PoseNoise&) const = default;
};

}  // namespace ajar
