#pragma once

#include <string>

#include "ajar/mechanism/mechanism.hpp"
#include "ajar/mission/mission.hpp"
#include "ajar/model/robot_model.hpp"

namespace ajar {

/// `scene.json` of a run: what a picture of it needs and log and result do not say: shapes, joints and limits of the robot,
/// boxes, axis, handle and end stop of the true mechanism, goal and limits of the mission.
[[nodiscard]] std::string scene_json(const RobotModel& model, const Mechanism& mechanism, const MissionConfig& mission);

}  // namespace ajar
