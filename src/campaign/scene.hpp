#pragma once

#include <string>

#include "ajar/mechanism/mechanism.hpp"
#include "ajar/model/robot_model.hpp"

namespace ajar {

/// `scene.json` of a run: what a picture of it needs and log and result do not say: footprint and limits of the robot,
/// boxes, axis and end stop of the true mechanism.
[[nodiscard]] std::string scene_json(const RobotModel& model, const Mechanism& mechanism);

}  // namespace ajar
