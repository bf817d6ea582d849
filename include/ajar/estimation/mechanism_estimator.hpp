#pragma once

#include <memory>

#include "ajar/estimation/mechanism_estimate.hpp"
#include "ajar/estimation/pose_noise.hpp"

namespace ajar {

/// Set-up of the estimator: noise of the hand pose, adaptive law of the first centimetres, type decision.
struct EstimatorConfig {
  PoseNoise noise;
  double grasp_stiffness = 1e4;           ///< K_c of the elastic correction p - f/K_c [N/m]
  double bandwidth = 1.5;                 ///< w0 of the adaptive law (A5) [1/s]
  double damping_ratio = 1.0;             ///< ζ of the adaptive law [-]
  double curvature_leak = 2.0;            ///< λ_k: decay of k along x [1/s]
  double still_speed = 0.004;             ///< Below this the hand counts as still [m/s]
  double stuck_turn_rate = 0.15;          ///< Largest rate at which reaction force turns the guess of a stuck handle [rad/s]
  double slide_curvature = 0.05;          ///< k_s of the type decision [1/m]
  double hinge_curvature = 0.6;           ///< k_min of the type decision: hinges up to 1.7 m [1/m]
  double type_threshold = 15.0;           ///< T of the decision for a hinge [-]
  double slide_threshold = 9.0;           ///< T of the decision for a slide [-]
  double relative_curvature_floor = 0.1;  ///< Furniture is no circle: σ_k ≥ this · |k| [-]
  bool use_rotation = true;               ///< False: the grip is known to pivot, positions only
  bool operator==(const EstimatorConfig&) const = default;
  /// @throws ConfigError
  void validate() const;
};

/// What the estimator is told in one tick; nothing of it comes from the plant's truth.
struct EstimatorInput {
  double dt = 0.002;                              ///< [s]
  Pose hand = Pose::Identity();                   ///< Measured hand pose, odometry frame
  Vector3d velocity = Vector3d::Zero();           ///< Measured hand velocity, world axes [m/s]
  Vector3d force = Vector3d::Zero();              ///< Robot on handle, world axes, clean of weight and bias [N]
  Vector3d normal_correction = Vector3d::Zero();  ///< P v_f of the force law, world axes [m/s]
  double base_travel = 0.0;                       ///< Path length (axle) of the base in this tick [m]
  bool learn = true;                              ///< False: hold the estimate (probing, releasing)
};

enum class EstimatorStatus {
  Ok,          ///< Updated
  Held,        ///< Still or told to hold: the estimate keeps its value
  ModelAlarm,  ///< The prediction errors say that the model was wrong; re-learning
  Invalid      ///< An input was not finite or the pose is frozen: the estimate keeps its value, its uncertainty grows
};

/// Direction, curvature and type of a mechanism from hand poses over arc length, fused with the force-side correction.
/// (docs/equations.md#estimator, #adaptive-law)
class MechanismEstimator {
 public:
  /// @throws ConfigError
  explicit MechanismEstimator(const EstimatorConfig& config);
  MechanismEstimator(const MechanismEstimator& other);
  MechanismEstimator& operator=(const MechanismEstimator& other);
  ~MechanismEstimator();

  /// Starts anew at a hand pose with a guess of the direction (unit) and curvature.
  /// @param bar_turns  The grip is known to pivot: positions only
  void reset(const Pose& hand, const Vector3d& direction_guess, const Vector3d& curvature_guess = Vector3d::Zero(),
             bool bar_turns = false) noexcept;

  /// One tick. No allocation, no exception, bounded time.
  [[nodiscard]] EstimatorStatus update(const EstimatorInput& input) noexcept;

  [[nodiscard]] const MechanismEstimate& estimate() const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ajar
