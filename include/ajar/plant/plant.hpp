#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "ajar/core/types.hpp"

namespace ajar {

/// What executes commands and answers with measurements: kinematic, MuJoCo, later a real robot.
class Plant {
 public:
  virtual ~Plant() = default;
  /// Back to the start, with the disturbances of this seed. @throws PlantError
  virtual void reset(std::uint64_t seed) = 0;
  /// Takes a command; holds until the next one. Non-finite values are refused (the arm stops) and counted by the judge.
  virtual void apply(const Command& command) noexcept = 0;
  /// Lets time pass [s].
  virtual void advance(double dt) noexcept = 0;
  /// What the robot measures now.
  [[nodiscard]] virtual RobotState measure() noexcept = 0;
};

/// A touch of the robot with something other than the handle and the floor.
struct Contact {
  double time = 0.0;   ///< First instant [s]
  std::string bodies;  ///< "robot body + other body"
  double force = 0.0;  ///< Largest normal force [N]
};

/// The state of the world, known to the plant alone; read by the log and the judge.
struct Truth {
  double opening = 0.0;                    ///< Mechanism coordinate q [rad or m]
  double opening_rate = 0.0;               ///< [rad/s or m/s]
  BasePose base;                           ///< World
  Pose hand = Pose::Identity();            ///< World
  Vector3d handle = Vector3d::Zero();      ///< Grip centre, world [m]
  Vector3d direction = Vector3d::UnitX();  ///< Of the handle's motion for opening, unit, world
  Vector3d curvature = Vector3d::Zero();   ///< [1/m]
  Vector3d force = Vector3d::Zero();       ///< Robot on handle, world axes [N]
  Vector3d torque = Vector3d::Zero();      ///< Robot on handle about the hand, world axes [N m]
  bool grasped = false;
  JointVector q;   ///< Joint positions, shape (n)
  JointVector dq;  ///< Joint rates, shape (n)
};

/// Gives the truth away; implemented by simulated plants, held by nobody but the log and the judge.
class Witness {
 public:
  virtual ~Witness() = default;
  [[nodiscard]] virtual const Truth& truth() const noexcept = 0;
  /// Unwanted contacts so far, one entry per pair of bodies.
  [[nodiscard]] virtual const std::vector<Contact>& contacts() const noexcept = 0;
};

/// Something that goes wrong on purpose, for tests and stress runs.
struct Fault {
  enum class Kind { SensorNan, SensorSilent, BaseBlocked, GraspLost, DoorLocked, JointNan };
  Kind kind = Kind::SensorNan;
  double time = 0.0;  ///< When it begins [s]
  bool operator==(const Fault&) const = default;
};

struct GraspConfig {
  double stiffness = 1e4;               ///< Of fingers and handle [N/m]
  double damping = 100.0;               ///< [N s/m]
  double rotational_stiffness = 100.0;  ///< [N m/rad]
  bool pivots = false;                  ///< The bar may turn in the fingers
  double slip_force = 120.0;            ///< Above this the grip creeps along the force [N]
  double break_force = 250.0;           ///< Above this it is lost [N]
  double reach_tolerance = 0.025;       ///< Closing succeeds within this distance of the grip centre [m]
  bool operator==(const GraspConfig&) const = default;
};

struct WristSensorConfig {
  double force_bias = 3.0;       ///< Uniform per axis and run, ± [N]
  double torque_bias = 0.1;      ///< ± [N m]
  double force_drift = 0.0167;   ///< Standard deviation of the drift rate per axis [N/s]
  double force_noise = 0.4;      ///< White, per 2 ms sample [N]
  double torque_noise = 0.03;    ///< [N m]
  double tool_mass_error = 0.0;  ///< True minus modelled tool mass [kg]
  bool operator==(const WristSensorConfig&) const = default;
};

struct BasePlantConfig {
  double lag = 0.1;                  ///< First order [s]
  double delay = 0.05;               ///< Transport delay of base commands [s]
  double wheel_radius_error = 0.01;  ///< Uniform relative error of each wheel, common part, ± [-]
  double wheel_mismatch = 0.001;     ///< Relative difference between the wheels, ± [-]
  double friction = 0.8;             ///< Wheel on floor [-]
  double odometry_rate = 0.0;        ///< Readings per second, taken at control ticks; 0 = one in every tick [1/s]
  bool operator==(const BasePlantConfig&) const = default;
};

struct ArmPlantConfig {
  double lag = 0.015;                ///< Of the rate servo [s]
  double servo_gain = 1.0;           ///< Stiffness of the joint servos relative to the nominal one [-]
  double encoder_resolution = 1e-5;  ///< [rad]
  bool operator==(const ArmPlantConfig&) const = default;
};

struct PerceptionConfig {
  double normal_error = 0.0;      ///< Of the seen leaf normal about the vertical, signed [rad]
  double position_error = 0.003;  ///< Of the seen handle, uniform per axis and run, ± [m]
  bool operator==(const PerceptionConfig&) const = default;
};

/// Everything that is the same for all simulated plants.
struct PlantConfig {
  std::string kind = "mujoco";  ///< mujoco | kinematic
  double time_step = 0.001;     ///< Of the physics [s]
  double delay = 0.0;           ///< Of all measurements and commands together [s]
  GraspConfig grasp;
  WristSensorConfig wrist_sensor;
  BasePlantConfig base;
  ArmPlantConfig arm;
  PerceptionConfig perception;
  std::vector<Fault> faults;
  bool operator==(const PlantConfig&) const = default;
  /// @throws ConfigError
  void validate() const;
};

}  // namespace ajar
