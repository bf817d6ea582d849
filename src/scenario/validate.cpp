// What single keys cannot tell.
#include <fmt/format.h>

#include <cmath>

#include "ajar/core/error.hpp"
#include "ajar/scenario/scenario.hpp"

namespace ajar {

namespace {

void require(bool holds, const std::string& message) {
  if (!holds) throw ConfigError(message);
}

void check_mechanism(const MechanismSource& source) {
  switch (source.form) {
    case MechanismSource::Form::Described: {
      const MechanismConfig& c = source.described;
      require(c.closer_size == 0 || (c.closer.moment == 0.0 && c.closer.stiffness == 0.0 && c.closer.closing_damping == 0.0),
              fmt::format("mechanism.closer_size = {}: allowed: either closer_size or [mechanism.closer], not both",
                          c.closer_size));
      require(c.seal.range <= c.travel,
              fmt::format("mechanism.seal.range = {}: allowed: at most the travel, {}", c.seal.range, c.travel));
      static_cast<void>(make_mechanism(c));
      break;
    }
    case MechanismSource::Form::Table:
      require(!source.id.empty(), "mechanism.id: missing");
      static_cast<void>(load_door(source.table, source.id));
      break;
    case MechanismSource::Form::Mjcf: {
      std::error_code status;
      if (!std::filesystem::is_regular_file(source.mjcf, status)) {
        throw ConfigError("mechanism.mjcf = \"" + source.mjcf.string() + "\": no such file");
      }
      break;
    }
  }
}

void check_clearance(const ClearanceLimits& limits, const std::string& name) {
  require(limits.stop < limits.influence, fmt::format("control.clearance.{}.stop = {}: allowed: below its influence, {}",
                                                      name, limits.stop, limits.influence));
}

}  // namespace

void validate(const Scenario& scenario) {
  check_mechanism(scenario.mechanism);
  const MissionConfig& mission = scenario.mission;
  check_clearance(mission.clearance.self, "self");
  check_clearance(mission.clearance.arm_world, "arm_world");
  check_clearance(mission.clearance.base_world, "base_world");
  require(mission.limits.force < mission.limits.abort_force,
          fmt::format("limits.force_N = {}: allowed: below abort_force_N, {}", mission.limits.force,
                      mission.limits.abort_force));
  const GraspConfig& grasp = scenario.plant.grasp;
  require(
      grasp.slip_force <= grasp.break_force,
      fmt::format("plant.grasp.slip_force_N = {}: allowed: at most break_force_N, {}", grasp.slip_force, grasp.break_force));
  require(scenario.plant.time_step <= mission.period + 1e-12,
          fmt::format("plant.time_step_s = {}: allowed: at most the control period, {} s", scenario.plant.time_step,
                      mission.period));
  const NavigationConfig& drive = mission.navigation;
  require(drive.law == "thesis" || drive.k_gamma > 2.0 * drive.k_rho,
          fmt::format("control.navigation.k_gamma = {}: allowed: above 2 k_rho, {}", drive.k_gamma, 2.0 * drive.k_rho));
  require(mission.estimator.slide_curvature < mission.estimator.hinge_curvature,
          fmt::format("control.estimator.slide_curvature = {}: allowed: below hinge_curvature, {}",
                      mission.estimator.slide_curvature, mission.estimator.hinge_curvature));
  mission.validate();
  scenario.plant.validate();
}

}  // namespace ajar
