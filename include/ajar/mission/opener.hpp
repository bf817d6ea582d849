#pragma once

#include <optional>

#include "ajar/mission/end_detector.hpp"
#include "ajar/mission/mission.hpp"
#include "ajar/mission/scene_belief.hpp"

namespace ajar {

/// The robot when this tick's command takes effect.
struct Foreseen {
  PredictedState robot;
  Kinematics kinematics;
};

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

  /// What one tick works on.
  struct Tick {
    const RobotState& state;
    const Kinematics& kin;  ///< As measured: what is learnt
    const Foreseen& ahead;  ///< What is acted on
    const HandWrench& wrench;
    WholeBodyController& controller;
    ClearanceChecker& clearance;
    MissionRecord& record;  ///< Its estimate, reference, base and solution are filled
  };

  /// One tick of opening. The thesis's law acts on what is measured; the controller then only learns what was commanded, so
  /// that it can go on from there. No allocation, no exception, bounded time.
  [[nodiscard]] EndDetector::Verdict step(const Tick& tick) noexcept;

  /// Starts where the fingers have met the inner face of a flap. @param belief  With `press`
  void start_pressing(const RobotState& state, const Kinematics& kinematics, const HandleBelief& belief) noexcept;

  /// One tick of pressing a flap down along the way that was felt; nothing is learnt. (docs/equations.md#press)
  /// No allocation, no exception, bounded time.
  [[nodiscard]] EndDetector::Verdict step_pressing(const Tick& tick) noexcept;

  /// One tick of leading the handle back along the way that was felt, by the same laws; nothing is learnt.
  /// @return true once it is where it was taken, or stands still. No allocation, no exception, bounded time.
  [[nodiscard]] bool step_back(const Tick& tick) noexcept;

  /// Distances of the last tick.
  [[nodiscard]] const ClearanceResult& clearances() const noexcept { return clearances_; }

  /// The mechanism, once its type and way are known well enough to judge a grasp by. No exception.
  [[nodiscard]] std::optional<FeltMechanism> felt() const noexcept;

  /// Force that the motion needed so far [N].
  [[nodiscard]] double running_force() const noexcept { return speed_law().running_force(); }
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
  /// Wanted hand speed. @param along  Measured hand speed along the way [m/s]  @param speed_cap  [m/s]
  [[nodiscard]] double wanted_speed(const MechanismEstimate& estimate, const ForceCorrection& correction, double along,
                                    double speed_cap) noexcept;
  /// Motion of the base when it answers to this tick's command. @param hand  Foreseen, linear part along the way
  /// @param along  Measured hand speed along the way [m/s]  @param speed  Wanted [m/s]
  [[nodiscard]] BaseLawOutput drive(const PredictedState& robot, const MechanismEstimate& estimate, const Pose& hand,
                                    double along, double speed) noexcept;
  void move(const Tick& tick, const MechanismEstimate& estimate, const ForceCorrection& correction, double speed) noexcept;
  [[nodiscard]] static Vector3d hand_velocity(const Tick& tick) noexcept;
  /// What was felt, as it is at another place of the way. @param hand  [m]
  [[nodiscard]] MechanismEstimate estimate_at(const Vector3d& hand) const noexcept;
  /// The way of a hand that presses on a flap. @param hand  [m]
  [[nodiscard]] MechanismEstimate pressing_at(const Vector3d& hand) const noexcept;
  /// Whether the bar turns in the fingers, as far as is known. (docs/equations.md#free-grip)
  /// @param bar  Its direction now, unit; zero = no bar
  [[nodiscard]] bool bar_turns(const Vector3d& bar, const HandWrench& wrench) noexcept;
  /// Lets the hand turn about the bar that it holds. @param axis  Of the bar, unit, world axes
  /// @param leaf_turn  Of the leaf about it since the grasp [rad]  @param R  Hand to world
  void pivot_about(const Vector3d& axis, double leaf_turn, const Vector3d& correcting_turn, const Matrix3d& R,
                   WbcProblem& problem) const noexcept;
  void solve(const WbcProblem& problem, WholeBodyController& controller, WbcSolution& out) noexcept;

  const RobotModel& model_;
  MissionConfig config_;
  MechanismEstimator estimator_;
  [[nodiscard]] ForceLaw& force_law() noexcept { return press_ ? bare_force_law_ : force_law_; }
  [[nodiscard]] SpeedLaw& speed_law() noexcept { return press_ ? bare_speed_law_ : speed_law_; }
  [[nodiscard]] const SpeedLaw& speed_law() const noexcept { return press_ ? bare_speed_law_ : speed_law_; }

  ForceLaw force_law_;
  SpeedLaw speed_law_;
  ForceLaw bare_force_law_;  // of fingers on a bare leaf
  SpeedLaw bare_speed_law_;
  BaseLaw base_law_;
  std::optional<ThesisController> thesis_;  // instead of the QP; the base law is then only recorded
  EndDetector ends_;
  double blow_rate_;  // speed per newton of the blow of an end stop [m/(N s)]
  SceneBelief scene_;
  ClearanceResult clearances_;
  Matrix3d R_grasp_ = Matrix3d::Identity();
  Vector3d bar_in_hand_ = Vector3d::Zero();
  double base_lag_ = 0.0;
  Vector3d taken_at_ = Vector3d::Zero();  // where the hand took hold [m]
  FeltMechanism felt_;                    // what was known of the mechanism then
  std::optional<FlapPress> press_;        // a flap that is pressed down
  double back_still_ = 0.0;               // standing on the way back [s]
  bool straight_ = false;                 // the base keeps to a line
  bool held_fast_ = false;                // the grip resisted a turn about the bar
  double opened_ = 0.0;                   // how far the leaf stood open when it was taken hold of
  double start_force_ = 0.0;
  double direction_doubt_ = 0.0;  // sine of the largest error of a direction that was probed, else 0
};

}  // namespace ajar
