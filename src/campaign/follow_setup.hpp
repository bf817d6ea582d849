#pragma once

#include "ajar/mechanism/mechanism.hpp"
#include "ajar/mission/follower.hpp"
#include "ajar/plant/plant.hpp"
#include "ajar/scenario/scenario.hpp"

namespace ajar {

/// What a follower is told and how the arm starts.
struct FollowSetup {
  HandPath path;
  JointVector posture;  ///< With the base parked the hand is at the handle, shape (n)
};

/// The path of the closed mechanism's handle up to the goal, in the axes of the hand that would hold it.
/// @throws ConfigError  if the arm does not reach the handle from the parking pose
[[nodiscard]] FollowSetup make_follow_setup(const Scenario& scenario, const RobotModel& model, const Mechanism& mechanism);

/// The mechanism without its walls and so far off that the free hand cannot meet it.
[[nodiscard]] Mechanism out_of_the_way(Mechanism mechanism);

/// Lets the mechanism of a follow run go along with the free hand: at every instant its handle is the point of the path
/// nearest to the hand, so that the distance between them is the error of the path.
class FollowedPath {
 public:
  FollowedPath(const HandPath& path, const Mechanism& mechanism);
  /// @param phase  The path begins at the hand in the first tick of phase Open
  [[nodiscard]] const Truth& see(const Truth& truth, Phase phase) noexcept;

 private:
  HandPath path_;
  bool hinge_;
  bool begun_ = false;
  Pose start_ = Pose::Identity();
  Truth seen_;
};

}  // namespace ajar
