#include "ajar/interaction/wrench.hpp"

namespace ajar {
namespace {

// Standard value used by the plants [m/s²].
constexpr double kGravity = 9.81;

// Force that carries the tool, world axes: the robot pushes its tool upward.
Vector3d tool_weight(double mass) { return {0.0, 0.0, mass * kGravity}; }

bool is_finite(const RobotState& state, const Kinematics& kinematics) {
  return state.sensor_force.allFinite() && state.sensor_torque.allFinite() && kinematics.R_WF.allFinite() &&
         kinematics.p_WF.allFinite() && kinematics.X_WE.translation().allFinite();
}

}  // namespace

HandWrench contact_wrench(const HandWrench& reading, const Kinematics& kinematics, double tool_mass,
                          const Vector3d& tool_com) noexcept {
  const Matrix3d& R = kinematics.R_WF;
  const Vector3d weight = tool_weight(tool_mass);
  HandWrench wrench;
  wrench.force = R * reading.force - weight;
  const Vector3d at_sensor = R * reading.torque - (R * tool_com).cross(weight);
  wrench.torque = at_sensor + (kinematics.p_WF - kinematics.X_WE.translation()).cross(wrench.force);
  return wrench;
}

HandWrench tool_reading(const Matrix3d& R_WF, double tool_mass, const Vector3d& tool_com) noexcept {
  HandWrench reading;
  reading.force = R_WF.transpose() * tool_weight(tool_mass);
  reading.torque = tool_com.cross(reading.force);
  return reading;
}

WrenchEstimator::WrenchEstimator(const RobotModel& model) : tool_mass_(model.tool_mass()), tool_com_(model.tool_com()) {}

void WrenchEstimator::reset() noexcept {
  force_bias_.setZero();
  torque_bias_.setZero();
  samples_ = 0;
}

void WrenchEstimator::zero(const RobotState& state, const Kinematics& kinematics) noexcept {
  if (!is_finite(state, kinematics)) {
    return;
  }
  const HandWrench tool = tool_reading(kinematics.R_WF, tool_mass_, tool_com_);
  ++samples_;
  const double share = 1.0 / static_cast<double>(samples_);
  force_bias_ += share * (state.sensor_force - tool.force - force_bias_);
  torque_bias_ += share * (state.sensor_torque - tool.torque - torque_bias_);
}

HandWrench WrenchEstimator::hand_wrench(const RobotState& state, const Kinematics& kinematics) const noexcept {
  if (!is_finite(state, kinematics)) {
    return {};
  }
  const HandWrench reading{state.sensor_force - force_bias_, state.sensor_torque - torque_bias_};
  return contact_wrench(reading, kinematics, tool_mass_, tool_com_);
}

}  // namespace ajar
