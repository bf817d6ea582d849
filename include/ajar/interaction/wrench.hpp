#pragma once

#include "ajar/model/robot_model.hpp"

namespace ajar {

/// Force and torque of the robot on the handle, world axes, torque about the hand. [N, N m]
struct HandWrench {
  Vector3d force = Vector3d::Zero();
  Vector3d torque = Vector3d::Zero();
};

/// Turns raw wrist readings into the wrench at the hand: tool weight and bias removed. (docs/equations.md#wrench)
class WrenchEstimator {
 public:
  explicit WrenchEstimator(const RobotModel& model);

  /// Forgets the bias.
  void reset() noexcept;
  /// Takes one reading at standstill without contact into the mean that becomes the bias.
  void zero(const RobotState& state, const Kinematics& kinematics) noexcept;
  /// Readings in the mean so far.
  [[nodiscard]] int zero_samples() const noexcept { return samples_; }
  /// Wrench now.
  [[nodiscard]] HandWrench hand_wrench(const RobotState& state, const Kinematics& kinematics) const noexcept;

 private:
  double tool_mass_;
  Vector3d tool_com_;
  Vector3d force_bias_ = Vector3d::Zero();
  Vector3d torque_bias_ = Vector3d::Zero();
  int samples_ = 0;
};

}  // namespace ajar
