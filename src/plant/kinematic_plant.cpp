#include "ajar/plant/kinematic_plant.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ajar/core/error.hpp"

namespace ajar {
namespace {

const PlantConfig& checked(const PlantConfig& config) {
  config.validate();
  return config;
}

const Mechanism& checked(const Mechanism& mechanism) {
  mechanism.validate();
  return mechanism;
}

}  // namespace

KinematicPlant::KinematicPlant(const RobotModel& model, const Mechanism& mechanism, const PlantConfig& config,
                               const BasePose& start, const JointVector& q_start)
    : model_(model),
      mechanism_(checked(mechanism)),
      config_(checked(config)),
      start_(start),
      q_start_(q_start),
      path_(config, model.joints()),
      wrist_(config.wrist_sensor, config.faults),
      odometry_(model.wheel_radius(), model.wheel_track(), config.base.odometry_rate),
      gripper_(model.gripper_stroke()),
      coupling_(mechanism, config.grasp) {
  if (q_start.size() != model.joints() || !q_start.allFinite()) {
    throw PlantError("start posture: " + std::to_string(q_start.size()) +
                     " joints: allowed: " + std::to_string(model.joints()) + " finite numbers");
  }
  if (!std::isfinite(start.x) || !std::isfinite(start.y) || !std::isfinite(start.yaw)) {
    throw PlantError("start of the base: allowed: finite numbers");
  }
  reset(0);
}

void KinematicPlant::reset(std::uint64_t seed) {
  random_ = Random(seed);
  disturbances_ = draw_disturbances(config_, random_);
  path_.reset();
  reference_ = DriveReference();
  reference_.dq = JointVector::Zero(model_.joints());
  wrist_.reset(disturbances_);
  wheel_angles_.setZero();
  odometry_.reset(start_, wheel_angles_);
  gripper_.reset();
  coupling_.let_go();
  state_ = MechanismState();
  base_ = start_;
  q_ = q_start_;
  dq_ = JointVector::Zero(model_.joints());
  time_ = 0.0;
  owed_ = 0.0;
  may_grasp_ = true;
  model_.compute(base_, q_, kinematics_);
  wrist_.sample(time_,
                sensor_wrench(kinematics_, Vector3d::Zero(), Vector3d::Zero(),
                              model_.tool_mass() + config_.wrist_sensor.tool_mass_error, model_.tool_com()),
                random_);
  update_truth();
}

void KinematicPlant::apply(const Command& command) noexcept { path_.apply(command); }

void KinematicPlant::advance(double dt) noexcept {
  if (!(dt > 0.0) || !std::isfinite(dt)) return;
  owed_ += dt;
  // Half a step of tolerance keeps rounding of the sum from losing or gaining a step.
  while (owed_ > 0.5 * config_.time_step) {
    step();
    owed_ -= config_.time_step;
  }
  update_truth();
}

void KinematicPlant::step() noexcept {
  reference_ = path_.step();
  const Pose before = kinematics_.X_WE;
  move_robot();
  model_.compute(base_, q_, kinematics_);
  time_ += config_.time_step;
  update_grasp();
  follow_handle(before);
  wrist_.sample(time_,
                sensor_wrench(kinematics_, coupling_.wrench().force, coupling_.wrench().torque,
                              model_.tool_mass() + config_.wrist_sensor.tool_mass_error, model_.tool_com()),
                random_);
}

// Drives follow their reference exactly, up to the rate and the end of each joint.
void KinematicPlant::move_robot() noexcept {
  const double dt = config_.time_step;
  const RobotLimits& limits = model_.limits();
  for (Eigen::Index i = 0; i < q_.size(); ++i) {
    const double wanted = q_(i) + dt * std::clamp(reference_.dq(i), -limits.velocity(i), limits.velocity(i));
    const double reached =
        std::clamp(wanted, std::min(q_(i), limits.position_lower(i)), std::max(q_(i), limits.position_upper(i)));
    dq_(i) = (reached - q_(i)) / dt;
    q_(i) = reached;
  }
  if (model_.base_type() == BaseType::Fixed) return;
  const bool blocked = fault_active(config_.faults, Fault::Kind::BaseBlocked, time_);
  move_base(blocked ? 0.0 : reference_.v, blocked ? 0.0 : reference_.w);
}

// The wheels turn as the drive believes; the base goes as far as their true radii carry it. (docs/equations.md#wheels)
void KinematicPlant::move_base(double v, double w) noexcept {
  const double dt = config_.time_step;
  Vector2d rates = wheel_speeds(model_, v, w);
  const double fastest = rates.cwiseAbs().maxCoeff();
  if (fastest > model_.limits().wheel_speed) rates *= model_.limits().wheel_speed / fastest;
  wheel_angles_ += dt * rates;
  const Vector2d rims = model_.wheel_radius() * rates.cwiseProduct(disturbances_.wheel_ratio);
  base_ = integrate_base(base_, 0.5 * (rims(0) + rims(1)), (rims(1) - rims(0)) / model_.wheel_track(), dt);
  odometry_.update(wheel_angles_, rates);
}

// Fingers close on the handle when it is between them; having lost it, they must open before they can hold again.
void KinematicPlant::update_grasp() noexcept {
  const double distance = (kinematics_.X_WE.translation() - handle_motion(mechanism_, state_.q).position).norm();
  const double thickness = grip_thickness(mechanism_.handle, model_.gripper_stroke());
  const double between = coupling_.held() || distance <= config_.grasp.reach_tolerance ? thickness : 0.0;
  gripper_.step(reference_.gripper_closed, between, config_.time_step);
  const bool lost = fault_active(config_.faults, Fault::Kind::GraspLost, time_);
  if (!gripper_.holds(between) || lost) {
    coupling_.let_go();
    if (gripper_.opening() > thickness) may_grasp_ = true;
    return;
  }
  if (!coupling_.held() && may_grasp_) {
    coupling_.take(kinematics_.X_WE, state_.q);
    may_grasp_ = false;
  }
}

void KinematicPlant::follow_handle(const Pose& before) noexcept {
  const bool locked = fault_active(config_.faults, Fault::Kind::DoorLocked, time_);
  coupling_.step({before, kinematics_.X_WE, config_.time_step}, locked, state_);
}

RobotState KinematicPlant::measure() noexcept {
  RobotState out;
  out.time = time_;
  odometry_.read(time_, out);
  out.q = q_;
  for (Eigen::Index i = 0; i < q_.size(); ++i) out.q(i) = quantise(q_(i), config_.arm.encoder_resolution);
  if (fault_active(config_.faults, Fault::Kind::JointNan, time_))
    out.q.setConstant(std::numeric_limits<double>::quiet_NaN());
  out.dq = dq_;
  wrist_.read(time_, out);
  out.gripper_opening = gripper_.opening();
  out.handle = see_handle(mechanism_.handle, leaf_motion(mechanism_, state_.q), to_pose(base_), config_.perception,
                          disturbances_, reference_.gripper_closed);
  out.handle.doorway = see_doorway(mechanism_.doorway, handle_motion(mechanism_, state_.q).position, to_pose(base_),
                                   config_.perception, disturbances_);
  return out;
}

void KinematicPlant::update_truth() noexcept {
  const HandleMotion motion = handle_motion(mechanism_, state_.q);
  truth_.opening = state_.q;
  truth_.opening_rate = state_.dq;
  truth_.base = base_;
  truth_.hand = kinematics_.X_WE;
  truth_.handle = motion.position;
  truth_.direction = motion.direction;
  truth_.curvature = motion.curvature;
  truth_.force = coupling_.wrench().force;
  truth_.torque = coupling_.wrench().torque;
  truth_.grasped = coupling_.held();
  truth_.q = q_;
  truth_.dq = dq_;
}

}  // namespace ajar
