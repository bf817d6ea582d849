#pragma once

#include <optional>

#include "ajar/mission/end_detector.hpp"
#include "ajar/mission/mission.hpp"
#include "ajar/mission/scene_belief.hpp"

namespace ajar {

/// The closed loop while the hand holds the handle: wrench → estimate → hand twist and base motion → whole body.
class Opener {
 public:
  /// @throws ConfigError
  Opener(const RobotModel& model, const MissionConfig& config);

  /// Starts at the grasp. @param direction  Believed direction of opening, unit, odometry frame
  /// @param force  Pull that the first centimetres may take where that is known already, else 0 [N]
  void start(const RobotState& state, const Kinematics& kinematics, const HandleBelief& belief, const Vector3d& direction,
             double force = 0.0) noexcept;

  /// Goes on after probing with the direction that it found; wall and base offset stay.
  /// @param force  Pull that the first centimetres may take: what probing needed, 0 = the start force [N]
  void redirect(const Kinematics& kinematics, const Vector3d& direction, double force = 0.0) noexcept;

  /// One tick of opening: fills estimate, reference, base and solution of the record. With the thesis's law the controller
  /// only learns what was commanded, so that it can go on from there.
  /// No allocation, no exception, bounded time.
  [[nodiscard]] EndDetector::Verdict step(const RobotState& state, const Kinematics& kinematics, const HandWrench& wrench,
                                          WholeBodyController& controller, ClearanceChecker& clearance,
                                          MissionRecord& record) noexcept;

  /// Force that the motion needed so far [N].
  [[nodiscard]] double running_force() const noexcept { return speed_law_.running_force(); }
  [[nodiscard]] const MechanismEstimate& estimate() const noexcept { return estimator_.estimate(); }
  [[nodiscard]] const SceneBelief& scene() const noexcept { return scene_; }
  [[nodiscard]] SceneBelief& scene() noexcept { return scene_; }

 private:
  [[nodiscard]] double confidence(const MechanismEstimate& estimate) const noexcept;
  [[nodiscard]] double speed_cap(const MechanismEstimate& estimate) const noexcept;
  [[nodiscard]] double force_cap(const MechanismEstimate& estimate) const noexcept;
  /// Tells the estimator what the hand did and felt in this tick. @param velocity  Of the hand, world axes [m/s]
  void learn(const RobotState& state, const Kinematics& kinematics, const HandWrench& wrench,
             const ForceCorrection& correction, const Vector3d& velocity) noexcept;
  /// Runs the laws of speed and base for the present estimate. @param along  Measured hand speed along it [m/s]
  /// @return wanted hand speed [m/s]
  double drive(const RobotState& state, const Kinematics& kinematics, const ForceCorrection& correction, double along,
               BaseLawOutput& base) noexcept;
  /// Lets the hand turn about the bar that it holds. @param axis  Of the bar, unit, world axes
  /// @param leaf_turn  Of the leaf about it since the grasp [rad]  @param R  Hand to world
  void pivot_about(const Vector3d& axis, double leaf_turn, const Vector3d& correcting_turn, const Matrix3d& R,
                   WbcProblem& problem) const noexcept;
  void solve(const WbcProblem& problem, WholeBodyController& controller, WbcSolution& out) noexcept;

  const RobotModel& model_;
  MissionConfig config_;
  MechanismEstimator estimator_;
  ForceLaw force_law_;
  SpeedLaw speed_law_;
  BaseLaw base_law_;
  std::optional<ThesisController> thesis_;  // instead of the QP; the base law is then only recorded
  EndDetector ends_;
  double slow_speed_;  // where an end stop is possible [m/s]
  SceneBelief scene_;
  ClearanceResult clearances_;
  Matrix3d R_grasp_ = Matrix3d::Identity();
  Vector3d bar_in_hand_ = Vector3d::Zero();
  double base_lag_ = 0.0;
  bool straight_ = false;  // the base keeps to a line
  double opened_ = 0.0;    // how far the leaf stood open when it was taken hold of
  double start_force_ = 0.0;
};

}  // namespace ajar
