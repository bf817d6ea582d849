#pragma once

#include <string>

#include "ajar/campaign/run.hpp"

/// Builds the plant that a scenario asks for: kinematic, or MuJoCo around a mechanism of ours or inside somebody's model.
/// @throws ajar::Error
[[nodiscard]] ajar::SimulatedPlant make_plant(const ajar::PlantRequest& request);

/// Builds all that a scenario names, without running it; what check_beginning refuses is an error.
/// @return what keeps the robot from opening the mechanism wholly, in words; empty if nothing does
/// @throws ajar::Error
[[nodiscard]] std::string check_scenario(const ajar::Scenario& scenario);

/// Throws if a run could not even begin: no posture of the arm takes a described handle from any place of the base nearby,
/// the robot starts in collision or has no collision shapes, the handle is behind something, the doorway is too narrow.
/// @throws ajar::ConfigError
void check_beginning(const ajar::Scenario& scenario, const ajar::RobotModel& model);
