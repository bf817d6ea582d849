#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <optional>

namespace ajar {

/// Largest number of arm joints (a torso lift counts as one); sizes the vectors of the loop, which never allocate.
inline constexpr int kMaxJoints = 8;
/// Largest number of inputs: the joints, the turning rate ω and the forward speed v of the base.
inline constexpr int kMaxInputs = kMaxJoints + 2;

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

/// One value per arm joint, shape (n), n ≤ kMaxJoints.
using JointVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxJoints, 1>;
/// Inputs u = (q̇_1 … q̇_n, ω, v), shape (n + 2) [rad/s or m/s, rad/s, m/s].
using InputVector = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMaxInputs, 1>;
/// Twist or wrench, linear part first, axes of the world, reference point the hand's tool centre point.
using Vector6d = Eigen::Matrix<double, 6, 1>;
/// Hand Jacobian over the inputs, shape (6, n + 2), linear rows first, axes of the world.
using HandJacobian = Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMaxInputs>;
/// One row over the inputs, shape (1, n + 2).
using InputRow = Eigen::Matrix<double, 1, Eigen::Dynamic, Eigen::RowMajor, 1, kMaxInputs>;
/// Rigid pose.
using Pose = Eigen::Isometry3d;

/// Pose of the base on the floor: midpoint of the wheel axle, heading from world x.
struct BasePose {
  double x = 0.0;    ///< [m]
  double y = 0.0;    ///< [m]
  double yaw = 0.0;  ///< [rad]
};

/// The pose of the base frame in the world.
[[nodiscard]] inline Pose to_pose(const BasePose& base) {
  Pose X_WB = Pose::Identity();
  X_WB.linear() = Eigen::AngleAxisd(base.yaw, Vector3d::UnitZ()).toRotationMatrix();
  X_WB.translation() = Vector3d(base.x, base.y, 0.0);
  return X_WB;
}

/// A box, used for obstacles, furniture and leaves.
struct Box {
  Pose pose = Pose::Identity();                     ///< Centre and axes, in the frame that the owner names
  Vector3d half_extents = Vector3d::Constant(0.5);  ///< [m]
};

/// The opening in a wall that a leaf closes: its upright edges on the robot's side, left and right as the robot sees them.
struct Doorway {
  Vector3d left = Vector3d::Zero();   ///< In the frame that the owner names; its height means nothing [m]
  Vector3d right = Vector3d::Zero();  ///< [m]
};

/// What the robot's camera says of the handle, in the base frame at the time of the sight.
struct HandleSight {
  bool visible = false;                  ///< False: nothing seen, the rest is meaningless
  Vector3d position = Vector3d::Zero();  ///< Centre of the grip, base frame [m]
  Vector3d normal = Vector3d::UnitX();  ///< Outward normal of the leaf at the grip (towards the robot), unit, base frame [-]
  Vector3d bar = Vector3d::UnitZ();     ///< Direction of the bar, unit, base frame; zero for a knob [-]
  double standoff = 0.06;               ///< Distance from the leaf's face to the grip's centre [m]
  double thickness = 0.02;              ///< Thickness of what the fingers close on; 0 = nothing to grip [m]
  std::optional<Doorway> doorway;       ///< Of the frame round the leaf, base frame; none where there is no frame [m]
};

/// What the robot measures in one tick. Nothing else of the world reaches mission, controller or estimator.
struct RobotState {
  double time = 0.0;      ///< Since the start of the run [s]
  BasePose base;          ///< Odometry, in the odometry frame
  double base_age = 0.0;  ///< How much older odometry and wheel speeds are than `time` [s]
  double base_v = 0.0;    ///< Forward speed by the wheel encoders [m/s]
  double base_w = 0.0;    ///< Turning rate by the wheel encoders [rad/s]
  JointVector q;          ///< Joint positions, shape (n) [rad or m]
  JointVector dq;         ///< Joint rates, shape (n) [rad/s or m/s]
  Vector3d sensor_force =
      Vector3d::Zero();  ///< Raw wrist reading, sensor axes: robot on tool side, with weight and bias [N]
  Vector3d sensor_torque = Vector3d::Zero();  ///< Raw wrist reading about the sensor's origin, sensor axes [N m]
  double wrench_time = 0.0;                   ///< Time stamp of the wrist reading [s]
  double gripper_opening = 0.1;               ///< Measured distance of the fingers [m]
  HandleSight handle;                         ///< What the camera sees of the handle
};

/// What the robot is told to do until the next tick.
struct Command {
  JointVector dq;               ///< Joint rates, shape (n) [rad/s or m/s]
  double base_v = 0.0;          ///< Forward speed [m/s]
  double base_w = 0.0;          ///< Turning rate [rad/s]
  bool gripper_closed = false;  ///< True: fingers closing or closed
  bool leans = false;           ///< The hand is meant to touch the leaf: it presses on it
};

}  // namespace ajar
