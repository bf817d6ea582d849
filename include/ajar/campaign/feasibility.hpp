#pragma once

#include <string>

#include "ajar/mechanism/mechanism.hpp"
#include "ajar/mission/mission.hpp"

namespace ajar {

/// Why a run cannot even begin, for a robot that stands at `start` with the arm at home; empty if it can: no collision
/// shapes, the robot in collision, the handle behind something, a doorway narrower than the base. One sentence.
[[nodiscard]] std::string obstruction(const RobotModel& model, const Mechanism& mechanism, const BasePose& start);

/// What keeps a robot from opening a mechanism wholly that it knows, by roll-outs: "no posture passes r < 0.30 m: …".
/// Empty if nothing does, if the mechanism is to be pushed, or if the base cannot move. Takes up to some seconds.
/// @param bar_turns  The bar turns in the fingers
[[nodiscard]] std::string shortfall(const RobotModel& model, const Mechanism& mechanism, const MissionConfig& config,
                                    bool bar_turns);

}  // namespace ajar
