#pragma once

#include <string>
#include <vector>

#include "ajar/planning/grasp_planner.hpp"

namespace ajar {

/// One mechanism that may stand behind the handle, as motion of the grip from its closed position.
struct MechanismHypothesis {
  std::string name;                        ///< For messages
  Vector3d direction = Vector3d::UnitX();  ///< x₀: unit direction in which the grip starts [-]
  Vector3d curvature = Vector3d::Zero();   ///< k₀ = axis / radius, perpendicular to x₀; zero for a slide [1/m]
  double travel = 0.5;                     ///< Arc that the roll-out must reach [m]
  Vector3d free_axis = Vector3d::Zero();   ///< Grip turns freely about it (fixed to the hand); zero = held fast [-]
  double own_room = 0.02;                  ///< Distance of the robot to itself that is wanted along the way [m]
  bool hand_stays = false;                 ///< About the free axis the hand keeps its direction
  bool soft = false;                       ///< Its value is softened, so that it cannot rule the choice alone
};

/// Pose of a grip that has moved by an arc along a hypothesis: translation from the start and turning of the leaf.
/// (docs/equations.md#choice)
struct HypothesisPoint {
  Vector3d shift = Vector3d::Zero();       ///< [m]
  Vector3d turned = Vector3d::Zero();      ///< Rotation vector of the leaf [rad]
  Vector3d direction = Vector3d::UnitX();  ///< x(s) [-]
};
[[nodiscard]] HypothesisPoint point_at(const MechanismHypothesis& hypothesis, double arc) noexcept;

/// Turn about a bar in the fingers that a hand should have made when the leaf has turned: with an upright bar that of the
/// leaf, with a level one part of it, or it would end up under the bar. (docs/equations.md#free-grip)
/// @param bar        Unit, world axes
/// @param leaf_turn  Of the leaf about it since the grasp [rad]
[[nodiscard]] double free_grip_turn(const Vector3d& bar, double leaf_turn) noexcept;

/// Its derivative by the leaf's turn. [-]
[[nodiscard]] double free_grip_share(const Vector3d& bar, double leaf_turn) noexcept;

/// Whether a mechanism is a flap that comes down: a level axis along a level bar, below the closed handle.
[[nodiscard]] bool comes_down(const HandleBelief& belief, const FeltMechanism& felt) noexcept;

/// What is known of a flap that stands half open. @param grip  Where the closed handle was held [m]
[[nodiscard]] FlapPress make_press(const FeltMechanism& felt, const Vector3d& grip, double opened) noexcept;

/// Where the fingertips press on the inner face of a flap that stands open by `angle`. (docs/equations.md#press) [m]
[[nodiscard]] Vector3d press_point(const HandleBelief& belief, const FlapPress& press, double angle) noexcept;

/// The inverse: opening at which the fingertips press there. @param tip  [m] @return  [rad]
[[nodiscard]] double pressed_opening(const HandleBelief& belief, const FlapPress& press, const Vector3d& tip) noexcept;

/// How far a flap reaches out at most, from the wall that it closes. @param belief  With `press` [m]
[[nodiscard]] double flap_reach(const HandleBelief& belief) noexcept;

/// Opening of a flap by the direction in which its outer face looks. @param normal  As seen now, unit [rad]
[[nodiscard]] double seen_opening(const FlapPress& press, const Vector3d& normal) noexcept;

/// The mechanism that was felt, as the only hypothesis. @param felt  belief.felt
[[nodiscard]] MechanismHypothesis felt_hypothesis(const HandleBelief& belief, const FeltMechanism& felt,
                                                  const PlannerConfig& config);

/// Everything that a handle like this may belong to: hinges on both sides, a drawer, and by the bar's direction sliding
/// doors or a flap; hardest first. With a passage only the leaf that is to be pushed, once felt only what was felt.
/// (docs/equations.md#choice)
[[nodiscard]] std::vector<MechanismHypothesis> make_hypotheses(const HandleBelief& belief, const PlannerConfig& config);

}  // namespace ajar
