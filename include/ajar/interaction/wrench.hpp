#pragma once

#include "ajar/model/robot_model.hpp"

namespace ajar {

/// Force and torque of the robot on the handle, world axes, torque about the hand. [N, N m]
struct HandWrench {
  Vector3d force = Vector3d::Zero();
  Vector3d torque = Vector3d::Zero();
};

/// Contact wrench at the hand from a bias-free reading: f = R s - (0, 0, m g), τ about the hand.
/// (docs/equations.md#wrench)
/// @param reading   Robot on tool side, sensor axes and origin, bias removed
/// @param tool_com  Of the mass beyond the sensor, sensor axes and origin [m]
[[nodiscard]] HandWrench contact_wrench(const HandWrench& reading, const Kinematics& kinematics, double tool_mass,
                                        const Vector3d& tool_com) noexcept;

/// Reading of a free tool at rest, sensor axes and origin. (docs/equations.md#wrench)
[[nodiscard]] HandWrench tool_reading(const Matrix3d& R_WF, double tool_mass, const Vector3d& tool_com) noexcept;

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
  /// Wrench now; zero for a reading that is not finite. The bias is kept in sensor axes.
  [[nodiscard]] HandWrench hand_wrench(const RobotState& state, const Kinematics& kinematics) const noexcept;

 private:
  double tool_mass_;
  Vector3d tool_com_;
  Vector3d force_bias_ = Vector3d::Zero();
  Vector3d torque_bias_ = Vector3d::Zero();
  int samples_ = 0;
};

}  // namespace ajar
