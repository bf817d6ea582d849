#pragma once

#include "ajar/campaign/run.hpp"

/// Builds the plant that a scenario asks for: kinematic, or MuJoCo around a mechanism of ours or inside somebody's model.
/// @throws ajar::Error
[[nodiscard]] ajar::SimulatedPlant make_plant(const ajar::PlantRequest& request);

/// Builds all that a scenario names, without running it; a handle that the arm reaches from nowhere is an error.
/// @throws ajar::Error
void check_scenario(const ajar::Scenario& scenario);

/// Throws if no posture of the arm takes a described handle from any place of the base nearby.
/// @throws ajar::ConfigError
void check_reach(const ajar::Scenario& scenario, const ajar::RobotModel& model);
