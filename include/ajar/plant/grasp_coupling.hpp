#pragma once

#include "ajar/mechanism/mechanism.hpp"
#include "ajar/plant/plant.hpp"

namespace ajar {

/// Motion of the one-degree-of-freedom mechanism.
struct MechanismState {
  double q = 0.0;   ///< [rad or m]
  double dq = 0.0;  ///< [rad/s or m/s]
};

/// Force and torque of the robot on the handle, world axes, torque about the hand.
struct GraspWrench {
  Vector3d force = Vector3d::Zero();   ///< [N]
  Vector3d torque = Vector3d::Zero();  ///< [N m]
};

/// How a prescribed hand moves during one step.
struct HandStep {
  Pose from = Pose::Identity();  ///< World
  Pose to = Pose::Identity();    ///< World
  double duration = 0.001;       ///< [s]
};

/// The elastic grip between a hand that goes where it is told and a mechanism with inertia and friction.
///
/// M q̈ = tᵀf + aᵀτ - r(q, q̇) - friction, f = K (p_E - p_A) + B (v_E - v_A), τ = K_r θ + B_r (ω_E - ω_A)
/// (docs/equations.md#grasp), A = the point of the leaf that the hand took hold of, t = dp_A/dq, a = the hinge's axis.
/// Implicit in spring, damper, stops and Coulomb friction: it sticks, and it is stable for any stiffness and mass.
class GraspCoupling {
 public:
  GraspCoupling(const Mechanism& mechanism, const GraspConfig& config);

  /// Takes hold: the hand's pose relative to the leaf becomes the one without force.
  void take(const Pose& X_WE, double q) noexcept;
  void let_go() noexcept;
  [[nodiscard]] bool held() const noexcept { return held_; }

  /// Lets the mechanism move for one step of the hand. No allocation, no exception, bounded time.
  /// @param locked  True: the mechanism cannot move  @param[in,out] state  Stays finite
  void step(const HandStep& hand, bool locked, MechanismState& state) noexcept;

  /// At the end of the last step.
  [[nodiscard]] const GraspWrench& wrench() const noexcept { return wrench_; }
  /// How far the fingers have crept along the handle since they closed [m].
  [[nodiscard]] double slipped() const noexcept { return slipped_; }

 private:
  struct Hand;
  struct Drive;
  [[nodiscard]] Drive drive_of(const Hand& hand, const MechanismState& state, double dt) const noexcept;
  void move(const Drive& drive, double dt, MechanismState& state) const noexcept;
  [[nodiscard]] GraspWrench wrench_at(const Hand& hand, const MechanismState& state) const noexcept;
  void creep(const MechanismState& state, double dt) noexcept;

  Mechanism mechanism_;
  GraspConfig config_;
  double mass_;                ///< Inertia and armature [kg m² or kg]
  double rotational_damping_;  ///< [N m s/rad]
  bool held_ = false;
  Vector3d anchor_ = Vector3d::Zero();        ///< Of the hand on the closed leaf, world [m]
  Matrix3d rotation_ = Matrix3d::Identity();  ///< Of the hand, with the leaf turned back to closed
  double slipped_ = 0.0;
  GraspWrench wrench_;
};

}  // namespace ajar
