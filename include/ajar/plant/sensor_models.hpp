#pragma once

#include <vector>

#include "ajar/core/random.hpp"
#include "ajar/mechanism/mechanism.hpp"
#include "ajar/model/robot_model.hpp"
#include "ajar/plant/plant.hpp"

namespace ajar {

/// Time between two samples of the wrist sensor [s]; the 500 Hz of the UR5e's sensor.
inline constexpr double kWristSamplePeriod = 0.002;
/// Gravity [m/s²], as MuJoCo and the door tables have it.
inline constexpr double kGravity = 9.81;

/// What goes wrong in one run, drawn once from its seed.
struct Disturbances {
  Vector3d force_bias = Vector3d::Zero();   ///< Sensor axes [N]
  Vector3d torque_bias = Vector3d::Zero();  ///< Sensor axes [N m]
  Vector3d force_drift = Vector3d::Zero();  ///< Sensor axes [N/s]
  Vector2d wheel_ratio = Vector2d::Ones();  ///< True over assumed radius, left and right, shape (2) [-]
  Vector3d sight_error = Vector3d::Zero();  ///< Of the seen handle, world axes [m]
};
/// Draws them, always in the same order: every plant meets the same run for the same seed.
[[nodiscard]] Disturbances draw_disturbances(const PlantConfig& config, Random& random);

/// Whether a fault has begun.
[[nodiscard]] bool fault_active(const std::vector<Fault>& faults, Fault::Kind kind, double time) noexcept;

/// Value rounded to whole steps of an encoder; a resolution of 0 leaves it alone.
[[nodiscard]] double quantise(double value, double resolution) noexcept;

/// Gives back what was put in a fixed number of steps ago. Allocates when built, never afterwards.
template <typename T>
class DelayLine {
 public:
  /// @param steps  Delay, ≥ 0 [-]  @param rest  What comes out until the first value arrives
  explicit DelayLine(int steps = 0, const T& rest = T()) : values_(static_cast<std::size_t>(steps < 0 ? 0 : steps), rest) {}

  /// Fills the line with one value.
  void reset(const T& rest) noexcept {
    for (T& value : values_) value = rest;
    next_ = 0;
  }
  /// Puts one value in and takes the delayed one out.
  [[nodiscard]] T push(const T& value) noexcept {
    if (values_.empty()) return value;
    const T out = values_[next_];
    values_[next_] = value;
    next_ = next_ + 1 == values_.size() ? 0 : next_ + 1;
    return out;
  }

 private:
  std::vector<T> values_;
  std::size_t next_ = 0;
};

/// Wrench that a wrist sensor feels.
struct SensorWrench {
  Vector3d force = Vector3d::Zero();   ///< Robot on tool side, sensor axes [N]
  Vector3d torque = Vector3d::Zero();  ///< About the sensor's origin, sensor axes [N m]
};

/// The wrench at the sensor of a tool at rest that holds something: f_F = R_FW (f + m g z),
/// τ_F = R_FW (τ + (p_E - p_F) × f) + c × R_FW m g z. (docs/equations.md#wrench)
/// @param force   Robot on handle, world axes [N]  @param torque  Robot on handle about the hand, world axes [N m]
/// @param mass    Of the tool [kg]                 @param com     c of the tool, sensor axes [m]
[[nodiscard]] SensorWrench sensor_wrench(const Kinematics& kinematics, const Vector3d& force, const Vector3d& torque,
                                         double mass, const Vector3d& com) noexcept;

/// The wrist sensor: bias, drift and white noise on samples every 2 ms, averaged between two readings.
class WristSensor {
 public:
  explicit WristSensor(const WristSensorConfig& config, const std::vector<Fault>& faults)
      : config_(config), faults_(faults) {}

  /// Starts a run. The bias is there from the first sample on.
  void reset(const Disturbances& disturbances) noexcept;
  /// True when a sample is wanted at this time.
  [[nodiscard]] bool due(double time) const noexcept { return time >= next_sample_ - 1e-9; }
  /// Offers the true wrench at a time; taken when 2 ms have passed since the last sample. No allocation.
  void sample(double time, const SensorWrench& truth, Random& random) noexcept;
  /// Writes the mean since the last reading into `sensor_force`, `sensor_torque`, `wrench_time`.
  /// SensorNan makes both NaN, SensorSilent repeats the last reading and its time.
  void read(double time, RobotState& state) noexcept;

 private:
  WristSensorConfig config_;
  std::vector<Fault> faults_;
  Disturbances disturbances_;
  SensorWrench sum_;
  SensorWrench last_;
  double next_sample_ = 0.0;
  double sample_time_ = 0.0;
  double last_time_ = 0.0;
  int count_ = 0;
};

/// Base pose from wheel angles, as the robot believes it. (docs/equations.md#wheels)
class WheelOdometry {
 public:
  /// @param radius  Assumed [m]  @param track  Distance of the driven wheels [m]
  /// @param rate    Readings per second; 0 = whenever asked [1/s]
  WheelOdometry(double radius, double track, double rate = 0.0) : radius_(radius), track_(track), rate_(rate) {}

  /// Starts at a pose. @param angles  Of the wheels (left, right) [rad]
  void reset(const BasePose& start, const Vector2d& angles) noexcept;
  /// Follows the wheels. No allocation. @param angles  Encoder angles (left, right) [rad]  @param rates  [rad/s]
  void update(const Vector2d& angles, const Vector2d& rates) noexcept;
  /// Writes pose and speeds of the last reading and its age; takes a new reading when one is due. No allocation.
  void read(double time, RobotState& state) noexcept;

  [[nodiscard]] const BasePose& pose() const noexcept { return pose_; }
  [[nodiscard]] double v() const noexcept { return v_; }  ///< [m/s]
  [[nodiscard]] double w() const noexcept { return w_; }  ///< [rad/s]

 private:
  struct Reading {
    BasePose pose;
    double v = 0.0;
    double w = 0.0;
    double time = 0.0;
  };
  double radius_;
  double track_;
  double rate_;
  BasePose pose_;
  Vector2d angles_ = Vector2d::Zero();
  double v_ = 0.0;
  double w_ = 0.0;
  Reading reading_;
  double next_reading_ = 0.0;
};

/// What the camera sees of a handle: in the true base frame, with the position error of the run and the normal and bar
/// turned about the vertical. Hidden once the gripper closes (the hand covers it).
/// @param handle  At the closed mechanism  @param moved  Motion of the leaf since then, world  @param X_WB  True base pose
[[nodiscard]] HandleSight see_handle(const Handle& handle, const Pose& moved, const Pose& X_WB,
                                     const PerceptionConfig& config, const Disturbances& disturbances,
                                     bool gripper_closed) noexcept;

/// What the camera sees of the frame round a leaf: wrong in the same way as the handle, shifted with it and turned about it.
/// @param handle  Grip centre where it is now, world [m]
[[nodiscard]] std::optional<Doorway> see_doorway(const std::optional<Doorway>& doorway, const Vector3d& handle,
                                                 const Pose& X_WB, const PerceptionConfig& config,
                                                 const Disturbances& disturbances) noexcept;

/// Thickness that the fingers find at a handle: zero for a recess, for no handle and for more than the gripper's stroke. [m]
[[nodiscard]] double grip_thickness(const Handle& handle, double stroke) noexcept;

/// Fingers that close and open at constant speed.
class Gripper {
 public:
  explicit Gripper(double stroke) : stroke_(stroke), opening_(stroke) {}
  void reset() noexcept { opening_ = stroke_; }
  /// Moves for dt. @param between  Thickness of what is between the fingers, 0 = nothing [m]
  void step(bool closed, double between, double dt) noexcept;
  [[nodiscard]] double opening() const noexcept { return opening_; }  ///< [m]
  /// True when closed onto something of this thickness.
  [[nodiscard]] bool holds(double between) const noexcept {
    return between > 0.0 && opening_ <= between + 1e-9 && opening_ >= between - 1e-9;
  }

 private:
  double stroke_;
  double opening_;
};

/// Way that an overloaded grip creeps along its force in one step: at 5 cm/s under the break force, in proportion below it,
/// never beyond the point where the spring has the slip force again. [m]
/// @param force  Size of the force in the grip [N]  @param dt  Step [s]
[[nodiscard]] double grip_creep(const GraspConfig& grasp, double force, double dt) noexcept;

/// What reaches the drives in one physics step.
struct DriveReference {
  JointVector dq;  ///< shape (n) [rad/s or m/s]
  double v = 0.0;  ///< [m/s]
  double w = 0.0;  ///< [rad/s]
  bool gripper_closed = false;
  bool leans = false;
};

/// The way of a command to the drives: refusal of non-finite values, transport delay, first-order lags. No allocation in
/// step.
class CommandPath {
 public:
  /// @param joints  n  @param step  Of the physics [s]
  CommandPath(const PlantConfig& config, int joints);

  /// At rest, gripper open.
  void reset() noexcept;
  /// Takes the command that holds from now on; a command with a non-finite value or a wrong shape becomes a stop.
  void apply(const Command& command) noexcept;
  /// One physics step further.
  const DriveReference& step() noexcept;

 private:
  struct BaseTwist {
    double v = 0.0;
    double w = 0.0;
  };
  int joints_;
  double arm_share_;   ///< 1 - exp(-dt / lag) [-]
  double base_share_;  ///< [-]
  Command held_;
  DelayLine<Command> delay_;
  DelayLine<BaseTwist> base_delay_;
  DriveReference out_;
};

}  // namespace ajar
