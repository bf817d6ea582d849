#pragma once

// A robot that stands in front of a mechanism with its hand on the handle, for tests of the physics.

#include <cmath>
#include <stdexcept>

#include "ajar/mechanism/builders.hpp"
#include "ajar/mujoco/mujoco_plant.hpp"

namespace ajar::test {

/// Without noise, bias and errors: what is left is physics.
inline PlantConfig quiet() {
  PlantConfig config;
  config.wrist_sensor = {0.0, 0.0, 0.0, 0.0, 0.0, 0.0};
  config.base.wheel_radius_error = config.base.wheel_mismatch = 0.0;
  config.perception.position_error = 0.0;
  config.arm.encoder_resolution = 0.0;
  return config;
}

inline Mechanism door(const MechanismConfig& config = {}) { return make_mechanism(config); }

/// Hand frame at a handle: z into the leaf, y along the closing direction across the bar.
inline Pose hand_at(const Handle& handle) {
  Pose X_WE = Pose::Identity();
  const Vector3d z = -handle.normal;
  const Vector3d y = handle.bar.cross(z).normalized();
  X_WE.linear() << y.cross(z), y, z;
  X_WE.translation() = handle.position;
  return X_WE;
}

struct Stance {
  BasePose base;
  JointVector q;
};

/// Base in front of the handle, arm on it. @throws std::runtime_error when out of reach
inline Stance stand_at(const RobotModel& robot, const Handle& handle, double distance = 0.85) {
  Stance stance;
  const Vector3d foot = handle.position + distance * handle.normal;
  stance.base = {foot.x(), foot.y(), std::atan2(-handle.normal.y(), -handle.normal.x())};
  for (const double lift : {-1.6, -1.2, -2.0, -0.8}) {
    for (const double elbow : {1.6, 2.0, 1.2, -1.6}) {
      for (const double pan : {1.5708, 0.5, 2.6, -1.5708, 0.0, 3.1}) {
        for (const double wrist : {-1.5708, 1.5708}) {
          stance.q = robot.home();
          if (stance.q.size() >= 6) stance.q << pan, lift, elbow, -lift - elbow, wrist, 0.0;
          if (robot.solve_ik(stance.base, hand_at(handle), stance.q)) return stance;
        }
      }
    }
  }
  throw std::runtime_error("test stance out of reach");
}

inline Command still(const RobotModel& robot, bool closed = false) {
  Command command;
  command.dq = JointVector::Zero(robot.joints());
  command.gripper_closed = closed;
  return command;
}

/// Lets time pass in control periods of 2 ms under one command.
inline void hold(MujocoPlant& plant, const Command& command, double duration) {
  plant.apply(command);
  for (int i = 0; i < static_cast<int>(std::lround(duration / 0.002)); ++i) plant.advance(0.002);
}

/// Rates of the arm alone for a hand velocity with no rotation (least squares).
inline JointVector arm_rates(const RobotModel& robot, const RobotState& state, const Vector3d& velocity) {
  Kinematics kinematics;
  robot.compute(state.base, state.q, kinematics);
  Vector6d twist = Vector6d::Zero();
  twist.head<3>() = velocity;
  const Eigen::MatrixXd J = kinematics.J.leftCols(robot.joints());
  return J.completeOrthogonalDecomposition().solve(twist);
}

}  // namespace ajar::test
