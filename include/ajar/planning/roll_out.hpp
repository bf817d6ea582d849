#pragma once

#include "ajar/planning/hypotheses.hpp"

namespace ajar {

/// How a rolled-out opening went.
struct RollOutResult {
  double sigma = 9.0;      ///< Smallest σ_min of the arm [-]
  double own = 9.0;        ///< Smallest distance of the robot to itself; 9 = never near [m]
  double arm = 9.0;        ///< Of the arm to wall and leaf [m]
  double own_room = 0.02;  ///< Distance of the robot to itself below which it loses value [m]
  double arm_room = 0.03;  ///< Distance of the arm below which it loses value [m]
  double base = 9.0;       ///< Of the base to wall and leaf [m]
  double fraction = 0.0;   ///< Part of the travel that was reached, 0 … 1
  double error = 0.0;      ///< Largest distance of the hand from the path [m]
  double duration = 0.0;   ///< Of the opening [s]
  double value = -1.0;     ///< One number of all that (docs/equations.md#choice)
};

/// Value of a roll-out: min(σ, 0.12) less what clearances, travel and tracking fall short, and less the time.
/// (docs/equations.md#choice)
[[nodiscard]] double roll_out_value(const RollOutResult& result, bool soft) noexcept;

/// Rolls an opening out on the model with the controller that will do it. Planning only; one object per thread.
class RollOut {
 public:
  /// @throws ConfigError
  RollOut(const RobotModel& model, const PlannerConfig& config, const WbcConfig& wbc, const BaseLawConfig& base_law,
          const ClearanceConfig& clearance);

  /// With the whole-body QP, its clearance rows and the base law.
  /// @param enough  Stops as soon as the value is sure to stay below this
  [[nodiscard]] RollOutResult run(const HandleBelief& belief, const MechanismHypothesis& hypothesis, const BasePose& base,
                                  const JointVector& q, double enough);

  /// Distances of one posture to itself, to the believed wall and to the sides of a reveal; `own`, `arm` and `base` are
  /// filled.
  [[nodiscard]] RollOutResult look(const HandleBelief& belief, const BasePose& base, const JointVector& q);

  /// Distance of the open hand to the leaf as it stands. [m]
  [[nodiscard]] double hand_to_leaf(const HandleBelief& belief, const BasePose& base, const JointVector& q);

  [[nodiscard]] const Kinematics& kinematics() const noexcept { return kinematics_; }

 private:
  struct Motion;

  [[nodiscard]] Motion begin(const HandleBelief& belief, const BasePose& base, const JointVector& q);
  void pose_problem(const MechanismHypothesis& hypothesis, const Motion& motion, const HypothesisPoint& point,
                    WbcProblem& problem) const;
  void place_leaf(const HandleBelief& belief, const MechanismHypothesis& hypothesis, const HypothesisPoint& point,
                  double arc);
  void place_walls(const HandleBelief& belief);
  void note_clearances(RollOutResult& result) const noexcept;
  [[nodiscard]] BaseTwist base_twist(BaseLaw& law, const MechanismHypothesis& hypothesis, Motion& motion, double dt) const;
  [[nodiscard]] Vector6d pose_error(const MechanismHypothesis& hypothesis, const Motion& motion,
                                    const HypothesisPoint& point) const;

  const RobotModel& model_;
  PlannerConfig config_;
  WbcConfig wbc_;
  BaseLawConfig base_law_;
  WholeBodyController controller_;
  ClearanceChecker clearance_;
  Kinematics kinematics_;
  ClearanceResult clearances_;
};

}  // namespace ajar
