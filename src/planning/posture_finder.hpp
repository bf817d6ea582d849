#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ajar/core/random.hpp"
#include "ajar/planning/roll_out.hpp"

namespace ajar {

/// One posture that holds the handle from a base pose.
struct Posture {
  BasePose base;
  JointVector q;
  Pose hand = Pose::Identity();
  double value = -1.0;
};

/// How far the postures came that were tried: what `why` is made of.
struct PostureTally {
  int starts = 0;
  int reached = 0;
  int inside_limits = 0;
  int regular = 0;  // sigma large enough
  int clear_of_self = 0;
  int clear_of_wall = 0;
  double best_sigma = 0.0;
  double best_own = 0.0;
  double best_wall = -1.0;
};

/// What a posture must have at the grasp.
struct PostureLimits {
  double sigma = 0.09;
  double own = 0.025;
  double wall = 0.03;
};

/// Hand orientations that are worth trying: both flips, for a knob several rolls, for a push several turns to the hinge.
[[nodiscard]] std::vector<Matrix3d> hand_orientations(const HandleBelief& belief, const PlannerConfig& config);

/// Where the hand takes hold, or presses. [m]
[[nodiscard]] Vector3d hand_place(const HandleBelief& belief);

/// The hand that holds the handle with a given orientation.
[[nodiscard]] Pose hand_at(const HandleBelief& belief, const Matrix3d& R);

/// Finds and judges arm postures at the handle. Planning only.
class PostureFinder {
 public:
  PostureFinder(const RobotModel& model, const PlannerConfig& config, RollOut& roll_out)
      : model_(model), config_(config), roll_out_(roll_out) {}

  /// One posture from one random start, brought into the joint range; empty if that start leads nowhere.
  [[nodiscard]] std::optional<JointVector> reach(const BasePose& base, const Pose& hand, Random& random,
                                                 PostureTally& tally) const;

  /// Joints away from their limits, arm away from singularity, robot clear of itself and the wall.
  [[nodiscard]] bool usable(const HandleBelief& belief, const BasePose& base, const JointVector& q,
                            const PostureLimits& limits, PostureTally& tally) const;

  /// Posture with the hand `approach_distance` before the handle, continuous with the grasp and clear on the way.
  [[nodiscard]] std::optional<JointVector> approach(const HandleBelief& belief, const Posture& grasp) const;

  /// Turns whole revolutions out of the joints where their range allows it.
  [[nodiscard]] JointVector unwind(const JointVector& q) const;

 private:
  [[nodiscard]] bool inside_limits(const JointVector& q) const;

  const RobotModel& model_;
  const PlannerConfig& config_;
  RollOut& roll_out_;
};

/// Same posture: no joint differs by more than a few degrees.
[[nodiscard]] bool same_posture(const JointVector& a, const JointVector& b) noexcept;

/// Says in words why no posture was found.
[[nodiscard]] std::string explain(const PostureTally& tally, const HandleBelief& belief, const PostureLimits& limits);

}  // namespace ajar
