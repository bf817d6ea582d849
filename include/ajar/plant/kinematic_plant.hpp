#pragma once

#include <vector>

#include "ajar/core/random.hpp"
#include "ajar/mechanism/mechanism.hpp"
#include "ajar/model/robot_model.hpp"
#include "ajar/plant/grasp_coupling.hpp"
#include "ajar/plant/plant.hpp"
#include "ajar/plant/sensor_models.hpp"

namespace ajar {

/// A plant whose arm and base go exactly where their drives are told to; only the mechanism has inertia and friction.
/// It feels nothing but the handle: no contact, no droop of the arm, no slip of the wheels.
class KinematicPlant : public Plant, public Witness {
 public:
  /// @param start  Base pose at the start of every run, world  @param q_start  Joint positions then, shape (n)
  /// @throws ConfigError for a bad configuration or mechanism, PlantError for a start of the wrong shape
  KinematicPlant(const RobotModel& model, const Mechanism& mechanism, const PlantConfig& config, const BasePose& start,
                 const JointVector& q_start);

  void reset(std::uint64_t seed) override;
  void apply(const Command& command) noexcept override;
  void advance(double dt) noexcept override;
  [[nodiscard]] RobotState measure() noexcept override;
  [[nodiscard]] const Truth& truth() const noexcept override { return truth_; }
  [[nodiscard]] const std::vector<Contact>& contacts() const noexcept override { return contacts_; }

 private:
  void step() noexcept;
  void move_robot() noexcept;
  void move_base(double v, double w) noexcept;
  void follow_handle(const Pose& before) noexcept;
  void update_grasp() noexcept;
  void update_truth() noexcept;

  RobotModel model_;
  Mechanism mechanism_;
  PlantConfig config_;
  BasePose start_;
  JointVector q_start_;

  Random random_{0};
  Disturbances disturbances_;
  CommandPath path_;
  DriveReference reference_;
  WristSensor wrist_;
  WheelOdometry odometry_;
  Gripper gripper_;
  GraspCoupling coupling_;
  MechanismState state_;
  Kinematics kinematics_;
  BasePose base_;
  JointVector q_;
  JointVector dq_;
  Vector2d wheel_angles_ = Vector2d::Zero();
  double time_ = 0.0;
  double owed_ = 0.0;
  bool may_grasp_ = true;
  Truth truth_;
  std::vector<Contact> contacts_;
};

}  // namespace ajar
