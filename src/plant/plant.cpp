#include "ajar/plant/plant.hpp"

#include <cmath>
#include <string>

#include "ajar/core/error.hpp"

namespace ajar {
namespace {

std::string number(double value) {
  std::string text = std::to_string(value);
  if (text.find('.') != std::string::npos) {
    text.erase(text.find_last_not_of('0') + 1);
    if (text.back() == '.') text.pop_back();
  }
  return text;
}

/// @throws ConfigError unless lower ≤ value ≤ upper (which NaN never is)
void require(const char* key, double value, double lower, double upper) {
  if (value >= lower && value <= upper) return;
  throw ConfigError(std::string(key) + " = " + number(value) + ": must be from " + number(lower) + " to " + number(upper));
}

}  // namespace

void PlantConfig::validate() const {
  if (kind != "mujoco" && kind != "kinematic")
    throw ConfigError("plant.kind = \"" + kind + "\": must be mujoco or kinematic");
  // Below 0.1 ms a run takes hours, above 2 ms the grasp's spring is no longer integrated stably.
  require("plant.time_step", time_step, 1e-4, 0.002);
  require("plant.delay", delay, 0.0, 1.0);
  require("plant.grasp.stiffness", grasp.stiffness, 100.0, 1e5);
  require("plant.grasp.damping", grasp.damping, 0.0, 1e4);
  require("plant.grasp.rotational_stiffness", grasp.rotational_stiffness, 1.0, 1e4);
  require("plant.grasp.slip_force", grasp.slip_force, 1.0, 1e5);
  require("plant.grasp.break_force", grasp.break_force, grasp.slip_force, 1e5);
  require("plant.grasp.reach_tolerance", grasp.reach_tolerance, 1e-4, 0.2);
  require("plant.wrist_sensor.force_bias", wrist_sensor.force_bias, 0.0, 1e3);
  require("plant.wrist_sensor.torque_bias", wrist_sensor.torque_bias, 0.0, 1e3);
  require("plant.wrist_sensor.force_drift", wrist_sensor.force_drift, 0.0, 10.0);
  require("plant.wrist_sensor.force_noise", wrist_sensor.force_noise, 0.0, 100.0);
  require("plant.wrist_sensor.torque_noise", wrist_sensor.torque_noise, 0.0, 100.0);
  require("plant.wrist_sensor.tool_mass_error", wrist_sensor.tool_mass_error, -0.5, 5.0);
  require("plant.base.lag", base.lag, 0.0, 2.0);
  require("plant.base.delay", base.delay, 0.0, 1.0);
  require("plant.base.wheel_radius_error", base.wheel_radius_error, 0.0, 0.2);
  require("plant.base.wheel_mismatch", base.wheel_mismatch, 0.0, 0.1);
  require("plant.base.friction", base.friction, 0.01, 5.0);
  require("plant.base.odometry_rate", base.odometry_rate, 0.0, 1e4);
  require("plant.arm.lag", arm.lag, 0.0, 1.0);
  require("plant.arm.servo_gain", arm.servo_gain, 0.05, 4.0);
  require("plant.arm.encoder_resolution", arm.encoder_resolution, 0.0, 0.1);
  require("plant.perception.normal_error", perception.normal_error, -3.15, 3.15);
  require("plant.perception.position_error", perception.position_error, 0.0, 0.5);
  for (const Fault& fault : faults) require("plant.faults.time", fault.time, 0.0, 1e6);
}

}  // namespace ajar
