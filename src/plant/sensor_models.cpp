#include "ajar/plant/sensor_models.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ajar {
namespace {

/// Creep of a grip under the break force [m/s]; of the order of the speed at which handles are pulled, so that a hand that
/// goes on regardless reaches the break force.
constexpr double kCreepSpeed = 0.05;
/// Speed of the fingers [m/s]: between the 0.02 and 0.15 m/s of the Robotiq 2F-85 data sheet.
constexpr double kFingerSpeed = 0.1;
// Round-off of a sum of ticks [s].
constexpr double kTimeRoundOff = 1e-9;

Vector3d uniform3(double bound, Random& random) {
  const double x = random.uniform(-bound, bound);
  const double y = random.uniform(-bound, bound);
  const double z = random.uniform(-bound, bound);
  return {x, y, z};
}

/// Share of the way to its input that a first-order lag goes in one step, exact for an input held over the step.
double lag_share(double lag, double step) { return lag > 0.0 ? -std::expm1(-step / lag) : 1.0; }

int whole_steps(double delay, double step) { return static_cast<int>(std::lround(delay / step)); }

}  // namespace

Disturbances draw_disturbances(const PlantConfig& config, Random& random) {
  Disturbances drawn;
  drawn.force_bias = uniform3(config.wrist_sensor.force_bias, random);
  drawn.torque_bias = uniform3(config.wrist_sensor.torque_bias, random);
  drawn.force_drift = random.normal3(config.wrist_sensor.force_drift);
  const double common = random.uniform(-config.base.wheel_radius_error, config.base.wheel_radius_error);
  const double difference = random.uniform(-config.base.wheel_mismatch, config.base.wheel_mismatch);
  drawn.wheel_ratio = Vector2d((1.0 + common) * (1.0 + 0.5 * difference), (1.0 + common) * (1.0 - 0.5 * difference));
  drawn.sight_error = uniform3(config.perception.position_error, random);
  return drawn;
}

bool fault_active(const std::vector<Fault>& faults, Fault::Kind kind, double time) noexcept {
  return std::any_of(faults.begin(), faults.end(),
                     [&](const Fault& fault) { return fault.kind == kind && time >= fault.time; });
}

double quantise(double value, double resolution) noexcept {
  return resolution > 0.0 ? resolution * std::round(value / resolution) : value;
}

SensorWrench sensor_wrench(const Kinematics& kinematics, const Vector3d& force, const Vector3d& torque, double mass,
                           const Vector3d& com) noexcept {
  const Matrix3d R_FW = kinematics.R_WF.transpose();
  const Vector3d lift = R_FW * Vector3d(0.0, 0.0, mass * kGravity);
  const Vector3d arm = kinematics.X_WE.translation() - kinematics.p_WF;
  return {R_FW * force + lift, R_FW * (torque + arm.cross(force)) + com.cross(lift)};
}

void WristSensor::reset(const Disturbances& disturbances) noexcept {
  disturbances_ = disturbances;
  sum_ = SensorWrench();
  last_ = SensorWrench();
  next_sample_ = sample_time_ = last_time_ = 0.0;
  count_ = 0;
}

void WristSensor::sample(double time, const SensorWrench& truth, Random& random) noexcept {
  if (!due(time)) return;
  next_sample_ = time + kWristSamplePeriod;
  sum_.force +=
      truth.force + disturbances_.force_bias + time * disturbances_.force_drift + random.normal3(config_.force_noise);
  sum_.torque += truth.torque + disturbances_.torque_bias + random.normal3(config_.torque_noise);
  sample_time_ = time;
  ++count_;
}

void WristSensor::read(double time, RobotState& state) noexcept {
  const bool silent = fault_active(faults_, Fault::Kind::SensorSilent, time);
  if (count_ > 0 && !silent) {
    last_ = {sum_.force / count_, sum_.torque / count_};
    last_time_ = sample_time_;
  }
  if (count_ > 0) {
    sum_ = SensorWrench();
    count_ = 0;
  }
  state.sensor_force = last_.force;
  state.sensor_torque = last_.torque;
  state.wrench_time = last_time_;
  if (fault_active(faults_, Fault::Kind::SensorNan, time)) {
    state.sensor_force.setConstant(std::numeric_limits<double>::quiet_NaN());
    state.sensor_torque.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
}

void WheelOdometry::reset(const BasePose& start, const Vector2d& angles) noexcept {
  pose_ = start;
  angles_ = angles;
  v_ = w_ = 0.0;
  reading_ = {start, 0.0, 0.0, 0.0};
  next_reading_ = 0.0;
}

void WheelOdometry::read(double time, RobotState& state) noexcept {
  if (rate_ <= 0.0 || time >= next_reading_ - kTimeRoundOff) {
    reading_ = {pose_, v_, w_, time};
    if (rate_ > 0.0) next_reading_ = std::max(next_reading_, time - 1.0 / rate_) + 1.0 / rate_;
  }
  state.base = reading_.pose;
  state.base_v = reading_.v;
  state.base_w = reading_.w;
  state.base_age = time - reading_.time;
}

void WheelOdometry::update(const Vector2d& angles, const Vector2d& rates) noexcept {
  if (!angles.allFinite() || !rates.allFinite()) return;
  const Vector2d travel = radius_ * (angles - angles_);
  angles_ = angles;
  pose_ = integrate_base(pose_, 0.5 * (travel(0) + travel(1)), (travel(1) - travel(0)) / track_, 1.0);
  v_ = 0.5 * radius_ * (rates(0) + rates(1));
  w_ = radius_ * (rates(1) - rates(0)) / track_;
}

HandleSight see_handle(const Handle& handle, const Pose& moved, const Pose& X_WB, const PerceptionConfig& config,
                       const Disturbances& disturbances, bool gripper_closed) noexcept {
  HandleSight sight;
  sight.visible = !gripper_closed;
  if (!sight.visible) return sight;
  const Pose X_BW = X_WB.inverse(Eigen::Isometry);
  const Matrix3d misread = Eigen::AngleAxisd(config.normal_error, Vector3d::UnitZ()).toRotationMatrix();
  const Matrix3d turn = X_BW.linear() * misread * moved.linear();
  sight.position = X_BW * (moved * handle.position + disturbances.sight_error);
  sight.normal = turn * handle.normal;
  sight.bar = handle.kind == HandleKind::Knob ? Vector3d::Zero() : Vector3d(turn * handle.bar);
  sight.standoff = handle.standoff;
  sight.thickness = grip_thickness(handle, std::numeric_limits<double>::infinity());
  return sight;
}

std::optional<Doorway> see_doorway(const std::optional<Doorway>& doorway, const Vector3d& handle, const Pose& X_WB,
                                   const PerceptionConfig& config, const Disturbances& disturbances) noexcept {
  if (!doorway) return std::nullopt;
  const Pose X_BW = X_WB.inverse(Eigen::Isometry);
  const Matrix3d misread = Eigen::AngleAxisd(config.normal_error, Vector3d::UnitZ()).toRotationMatrix();
  const auto seen = [&](const Vector3d& edge) -> Vector3d {
    return X_BW * (handle + misread * (edge - handle) + disturbances.sight_error);
  };
  return Doorway{seen(doorway->left), seen(doorway->right)};
}

double grip_thickness(const Handle& handle, double stroke) noexcept {
  const bool graspable = handle.kind == HandleKind::Bar || handle.kind == HandleKind::Knob;
  return graspable && handle.thickness > 0.0 && handle.thickness < stroke ? handle.thickness : 0.0;
}

double grip_creep(const GraspConfig& grasp, double force, double dt) noexcept {
  const double excess = force - grasp.slip_force;
  if (!(excess > 0.0)) return 0.0;
  const double range = std::max(grasp.break_force - grasp.slip_force, 1.0);
  return std::min(dt * kCreepSpeed * excess / range, excess / grasp.stiffness);
}

void Gripper::step(bool closed, double between, double dt) noexcept {
  // Fingers that are already closer than the thing is thick have missed it.
  const double stop = opening_ >= between - 1e-9 ? between : 0.0;
  const double goal = closed ? std::clamp(stop, 0.0, stroke_) : stroke_;
  const double reach = kFingerSpeed * dt;
  opening_ += std::clamp(goal - opening_, -reach, reach);
}

CommandPath::CommandPath(const PlantConfig& config, int joints)
    : joints_(joints),
      arm_share_(lag_share(config.arm.lag, config.time_step)),
      base_share_(lag_share(config.base.lag, config.time_step)),
      delay_(whole_steps(config.delay, config.time_step)),
      base_delay_(whole_steps(config.base.delay, config.time_step)) {
  reset();
}

void CommandPath::reset() noexcept {
  held_ = Command();
  held_.dq = JointVector::Zero(joints_);
  delay_.reset(held_);
  base_delay_.reset(BaseTwist());
  out_ = DriveReference();
  out_.dq = JointVector::Zero(joints_);
}

void CommandPath::apply(const Command& command) noexcept {
  const bool sound = command.dq.size() == joints_ && command.dq.allFinite() && std::isfinite(command.base_v) &&
                     std::isfinite(command.base_w);
  held_.gripper_closed = command.gripper_closed;
  held_.leans = command.leans;
  held_.dq.setZero();
  if (sound) held_.dq = command.dq;
  held_.base_v = sound ? command.base_v : 0.0;
  held_.base_w = sound ? command.base_w : 0.0;
}

const DriveReference& CommandPath::step() noexcept {
  const Command arrived = delay_.push(held_);
  const BaseTwist twist = base_delay_.push({arrived.base_v, arrived.base_w});
  out_.dq += arm_share_ * (arrived.dq - out_.dq);
  out_.v += base_share_ * (twist.v - out_.v);
  out_.w += base_share_ * (twist.w - out_.w);
  out_.gripper_closed = arrived.gripper_closed;
  out_.leans = arrived.leans;
  return out_;
}

}  // namespace ajar
