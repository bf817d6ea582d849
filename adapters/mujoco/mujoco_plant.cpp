// The loop of the plant: commands to servos, physics steps, measurements, truth.
#include "ajar/mujoco/mujoco_plant.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "assembly.hpp"
#include "touch.hpp"

#include "ajar/core/error.hpp"
#include "ajar/plant/sensor_models.hpp"

namespace ajar {
namespace {

using scene::Addresses;
using scene::Built;
using scene::vector3;

// The wheels and casters sink in until they carry the robot [s].
constexpr double kSettleTime = 0.3;
// A blocked wheel's servo winds up no farther than this [rad]: twice what its largest torque needs.
constexpr double kWheelWindUp = 0.4;
// Speed of the handle at which static friction has turned into sliding friction [m/s].
constexpr double kStribeckSpeed = 0.005;

void check_start(const RobotModel& robot, const PlantConfig& config, const BasePose& start, const JointVector& q_start) {
  config.validate();
  if (q_start.size() != robot.joints() || !q_start.allFinite()) {
    throw PlantError("start posture: " + std::to_string(q_start.size()) + " joints: the robot has " +
                     std::to_string(robot.joints()) + " finite ones");
  }
  if (!std::isfinite(start.x) || !std::isfinite(start.y) || !std::isfinite(start.yaw))
    throw PlantError("start pose: must be finite");
}

}  // namespace

struct MujocoPlant::Impl {
  Impl(const RobotModel& robot_model, const Mechanism& true_mechanism, const PlantConfig& plant_config,
       const BasePose& start_pose, const JointVector& q_start, Built built)
      : robot(robot_model),
        mechanism(true_mechanism),
        config(plant_config),
        start(start_pose),
        X_RB(built.X_RB),
        described(built.described),
        model(std::move(built.model)),
        data(mj_makeData(model.get())),
        settled(mj_makeData(model.get())),
        at(scene::find_addresses(*model, robot, built.joint)),
        grasp(*model, robot, mechanism.handle, config.grasp),
        contact_log(*model, grasp.tool_geoms()),
        commands(config, robot.joints()),
        wrist(config.wrist_sensor, config.faults),
        odometry(robot.wheel_radius(), robot.wheel_track(), config.base.odometry_rate),
        rolls(robot.base_type() == BaseType::Differential),
        q0(q_start),
        random(0) {
    if (!data || !settled) throw PlantError("MuJoCo: no memory for the state");
    closed = model->qpos0[at.mechanism_q];
    sign = vector3(model->jnt_axis + 3 * scene::find(*model, mjOBJ_JOINT, built.joint)).dot(closed_axis(built.joint)) >= 0.0
               ? 1.0
               : -1.0;
    settle();
  }

  /// The mechanism's axis in the axes of the joint's body, to tell which sign of the joint opens.
  Vector3d closed_axis(const std::string& joint) const {
    mj_kinematics(model.get(), data.get());
    const int body = model->jnt_bodyid[scene::find(*model, mjOBJ_JOINT, joint)];
    return scene::matrix3(data->xmat + 9 * body).transpose() * mechanism.axis;
  }

  void settle();
  void reset(std::uint64_t seed);
  void step() noexcept;
  void drive(const DriveReference& reference) noexcept;
  void drive_wheels(const DriveReference& reference) noexcept;
  void load_mechanism() noexcept;
  void lock(int equality, int address) noexcept;
  void inject_faults() noexcept;
  void sample_wrist() noexcept;
  void update_odometry() noexcept;
  void update_truth() noexcept;
  [[nodiscard]] BasePose base_pose() const noexcept;
  [[nodiscard]] RobotState measure() noexcept;
  [[nodiscard]] bool fault(Fault::Kind kind) const noexcept { return fault_active(config.faults, kind, time); }

  RobotModel robot;
  Mechanism mechanism;
  PlantConfig config;
  BasePose start;
  Pose X_RB;  // base frame in the body that the free joint moves
  bool described;
  scene::ModelPtr model;
  scene::DataPtr data;
  scene::DataPtr settled;  // state that every run starts from
  Addresses at;
  scene::Grasp grasp;
  scene::ContactLog contact_log;
  CommandPath commands;
  WristSensor wrist;
  WheelOdometry odometry;
  bool rolls;
  JointVector q0;
  Random random;
  Disturbances disturbances;
  JointVector q_reference;
  Vector2d wheel_reference = Vector2d::Zero();
  Vector3d push = Vector3d::Zero();
  Truth truth;
  double closed = 0.0;  // joint position of the closed mechanism
  double sign = 1.0;    // of the joint's motion for opening
  double time = 0.0;
  double pending = 0.0;
  long steps = 0;
  bool gripper_closed = false;
  bool diverged = false;
};

void MujocoPlant::Impl::settle() {
  for (int i = 0; i < robot.joints(); ++i) data->qpos[at.joint_q[static_cast<std::size_t>(i)]] = q0(i);
  q_reference = q0;
  mj_kinematics(model.get(), data.get());
  grasp.reset(*data);
  mj_step1(model.get(), data.get());
  const std::array<double, 2> origin =
      rolls ? std::array<double, 2>{data->qpos[at.base_q], data->qpos[at.base_q + 1]} : std::array<double, 2>{};
  DriveReference rest;
  rest.dq = JointVector::Zero(robot.joints());
  const int count = static_cast<int>(std::lround(kSettleTime / config.time_step));
  for (int i = 0; i < count; ++i) {
    drive(rest);
    mj_step2(model.get(), data.get());
    data->qpos[at.mechanism_q] = closed;
    data->qvel[at.mechanism_v] = 0.0;
    mj_step1(model.get(), data.get());
  }
  if (rolls) {
    for (std::size_t k = 0; k < 2; ++k) {
      data->qpos[at.base_q + static_cast<int>(k)] = origin[k];
      data->qpos[at.wheel_q[k]] = 0.0;
    }
  }
  std::fill(data->qvel, data->qvel + model->nv, 0.0);
  data->time = 0.0;
  mj_copyData(settled.get(), model.get(), data.get());
}

void MujocoPlant::Impl::reset(std::uint64_t seed) {
  random = Random(seed);
  disturbances = draw_disturbances(config, random);
  mj_copyData(data.get(), model.get(), settled.get());
  mj_kinematics(model.get(), data.get());
  grasp.reset(*data);
  contact_log.reset();
  commands.reset();
  wrist.reset(disturbances);
  q_reference = q0;
  wheel_reference.setZero();
  push.setZero();
  time = pending = 0.0;
  steps = 0;
  gripper_closed = diverged = false;
  mj_step1(model.get(), data.get());
  odometry.reset(start, Vector2d::Zero());
  // One reading of the resting tool, so that the first measurement is one.
  mj_forward(model.get(), data.get());
  sample_wrist();
  update_truth();
}

void MujocoPlant::Impl::drive_wheels(const DriveReference& reference) noexcept {
  const Vector2d believed = wheel_speeds(robot, reference.v, reference.w);
  const double limit = robot.limits().wheel_speed;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto k = static_cast<Eigen::Index>(side);
    // The simulated wheel has the assumed radius; a larger true one shows as more turn for the same belief.
    const double speed = std::clamp(believed(k), -limit, limit) * disturbances.wheel_ratio(k);
    const double angle = data->qpos[at.wheel_q[side]];
    wheel_reference(k) =
        std::clamp(wheel_reference(k) + config.time_step * speed, angle - kWheelWindUp, angle + kWheelWindUp);
    const double* bias = model->actuator_biasprm + mjNBIAS * at.wheel_servo[side];
    data->ctrl[at.wheel_servo[side]] = wheel_reference(k) + bias[2] / bias[1] * speed;
  }
}

void MujocoPlant::Impl::drive(const DriveReference& reference) noexcept {
  for (int i = 0; i < robot.joints(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const int servo = at.joint_servo[k];
    const double* bias = model->actuator_biasprm + mjNBIAS * servo;  // force = kp ctrl - kp q - kv dq
    const double q = data->qpos[at.joint_q[k]];
    // A joint that is held back winds up no farther than its largest torque needs.
    const double reach = robot.limits().effort(i) / -bias[1];
    q_reference(i) = std::clamp(q_reference(i) + config.time_step * reference.dq(i), q - reach, q + reach);
    q_reference(i) = std::clamp(q_reference(i), robot.limits().position_lower(i), robot.limits().position_upper(i));
    data->ctrl[servo] = q_reference(i) + bias[2] / bias[1] * reference.dq(i);
    // Weight and Coriolis forces of the arm are held by the arm's own controller; the base carries the weight.
    data->qfrc_applied[at.joint_v[k]] = data->qfrc_bias[at.joint_v[k]];
  }
  if (rolls) drive_wheels(reference);
}

void MujocoPlant::Impl::load_mechanism() noexcept {
  const int dof = at.mechanism_v;
  const double q = sign * (data->qpos[at.mechanism_q] - closed);
  const double dq = sign * data->qvel[dof];
  const HandleMotion motion = handle_motion(mechanism, q);
  double force = motion.radius * motion.direction.dot(push);
  if (described) {
    const double sliding = std::min(1.0, motion.radius * std::abs(dq) / kStribeckSpeed);
    model->dof_frictionloss[dof] = mechanism.coulomb * (1.0 + (mechanism.breakaway - 1.0) * (1.0 - sliding));
    // Damping goes into the joint, where the integrator treats it implicitly; the rest of the law is a force.
    model->dof_damping[dof] = mechanism.viscous + (dq < 0.0 ? mechanism.closer.closing_damping : 0.0);
    force -= resisting_force(mechanism, q, 0.0);
  }
  data->qfrc_applied[dof] = sign * force;
}

void MujocoPlant::Impl::lock(int equality, int address) noexcept {
  if (data->eq_active[equality] != 0) return;
  double* polynomial = model->eq_data + mjNEQDATA * equality;
  std::fill(polynomial, polynomial + mjNEQDATA, 0.0);
  polynomial[0] = data->qpos[address] - model->qpos0[address];
  data->eq_active[equality] = 1;
}

void MujocoPlant::Impl::inject_faults() noexcept {
  if (config.faults.empty()) return;
  if (fault(Fault::Kind::DoorLocked)) lock(at.mechanism_lock, at.mechanism_q);
  if (rolls && fault(Fault::Kind::BaseBlocked)) {
    for (std::size_t side = 0; side < 2; ++side) lock(at.wheel_lock[side], at.wheel_q[side]);
  }
}

void MujocoPlant::Impl::sample_wrist() noexcept {
  const SensorWrench wrench{vector3(data->sensordata + at.force_sensor), vector3(data->sensordata + at.torque_sensor)};
  wrist.sample(time, wrench, random);
}

void MujocoPlant::Impl::step() noexcept {
  const DriveReference& reference = commands.step();
  gripper_closed = reference.gripper_closed;
  inject_faults();
  drive(reference);
  load_mechanism();
  const double end = static_cast<double>(steps + 1) * config.time_step;
  // The wrist is read every 2 ms; in between its forces need not be worked out.
  const bool sampled = wrist.due(end);
  model->opt.disableflags = sampled ? model->opt.disableflags & ~mjDSBL_SENSOR : model->opt.disableflags | mjDSBL_SENSOR;
  mj_step2(model.get(), data.get());
  ++steps;
  time = end;
  if (sampled) sample_wrist();
  contact_log.record(*model, *data, time, reference.leans);
  grasp.step(*data, gripper_closed, !fault(Fault::Kind::GraspLost));
  mj_step1(model.get(), data.get());
  diverged =
      data->warning[mjWARN_BADQACC].number + data->warning[mjWARN_BADQVEL].number + data->warning[mjWARN_BADQPOS].number > 0;
}

BasePose MujocoPlant::Impl::base_pose() const noexcept {
  if (!rolls) return start;
  const double* q = data->qpos + at.base_q;
  Pose X_WR = Pose::Identity();
  X_WR.linear() = Eigen::Quaterniond(q[3], q[4], q[5], q[6]).toRotationMatrix();
  X_WR.translation() = vector3(q);
  const Pose X_WB = X_WR * X_RB;
  return {X_WB.translation().x(), X_WB.translation().y(), std::atan2(X_WB.linear()(1, 0), X_WB.linear()(0, 0))};
}

void MujocoPlant::Impl::update_odometry() noexcept {
  if (!rolls) return;
  Vector2d angles;
  Vector2d rates;
  for (std::size_t side = 0; side < 2; ++side) {
    const auto k = static_cast<Eigen::Index>(side);
    angles(k) = data->qpos[at.wheel_q[side]] / disturbances.wheel_ratio(k);
    rates(k) = data->qvel[at.wheel_v[side]] / disturbances.wheel_ratio(k);
  }
  odometry.update(angles, rates);
}

void MujocoPlant::Impl::update_truth() noexcept {
  truth.opening = sign * (data->qpos[at.mechanism_q] - closed);
  truth.opening_rate = sign * data->qvel[at.mechanism_v];
  truth.base = base_pose();
  truth.hand.linear() = scene::matrix3(data->site_xmat + 9 * at.hand_site);
  truth.hand.translation() = vector3(data->site_xpos + 3 * at.hand_site);
  const HandleMotion motion = handle_motion(mechanism, truth.opening);
  truth.handle = motion.position;
  truth.direction = motion.direction;
  truth.curvature = motion.curvature;
  truth.force = grasp.force();
  truth.torque = grasp.torque();
  truth.grasped = grasp.grasped();
  truth.q.resize(robot.joints());
  truth.dq.resize(robot.joints());
  for (int i = 0; i < robot.joints(); ++i) {
    truth.q(i) = data->qpos[at.joint_q[static_cast<std::size_t>(i)]];
    truth.dq(i) = data->qvel[at.joint_v[static_cast<std::size_t>(i)]];
  }
}

RobotState MujocoPlant::Impl::measure() noexcept {
  RobotState state;
  state.time = time;
  odometry.read(time, state);
  if (!rolls) state.base = start;
  state.q = truth.q;
  state.dq = truth.dq;
  for (double& value : state.q) value = quantise(value, config.arm.encoder_resolution);
  wrist.read(time, state);
  state.gripper_opening = grasp.opening();
  const Pose moved = leaf_motion(mechanism, truth.opening);
  state.handle = see_handle(mechanism.handle, moved, to_pose(truth.base), config.perception, disturbances, gripper_closed);
  state.handle.doorway = see_doorway(mechanism.doorway, moved * mechanism.handle.position, to_pose(truth.base),
                                     config.perception, disturbances);
  if (fault(Fault::Kind::JointNan) || diverged) {
    state.q.setConstant(std::numeric_limits<double>::quiet_NaN());
    state.dq.setConstant(std::numeric_limits<double>::quiet_NaN());
  }
  return state;
}

MujocoPlant::MujocoPlant(const RobotModel& model, const Mechanism& mechanism, const PlantConfig& config,
                         const BasePose& start, const JointVector& q_start) {
  check_start(model, config, start, q_start);
  impl_ = std::make_unique<Impl>(model, mechanism, config, start, q_start, scene::build(model, mechanism, config, start));
  impl_->reset(0);
}

MujocoPlant::MujocoPlant(const RobotModel& model, const MjcfWorld& world, const PlantConfig& config, const BasePose& start,
                         const JointVector& q_start) {
  check_start(model, config, start, q_start);
  const Mechanism mechanism = load_mjcf_mechanism(world);
  impl_ =
      std::make_unique<Impl>(model, mechanism, config, start, q_start, scene::build(model, world, mechanism, config, start));
  impl_->reset(0);
}

MujocoPlant::~MujocoPlant() = default;

void MujocoPlant::reset(std::uint64_t seed) { impl_->reset(seed); }

void MujocoPlant::apply(const Command& command) noexcept { impl_->commands.apply(command); }

void MujocoPlant::advance(double dt) noexcept {
  if (!(dt > 0.0) || !std::isfinite(dt)) return;
  Impl& plant = *impl_;
  plant.pending += dt;
  while (plant.pending > 0.5 * plant.config.time_step) {
    plant.pending -= plant.config.time_step;
    if (plant.diverged) {
      plant.time += plant.config.time_step;
    } else {
      plant.step();
    }
  }
  plant.update_odometry();
  plant.update_truth();
}

RobotState MujocoPlant::measure() noexcept { return impl_->measure(); }

const Truth& MujocoPlant::truth() const noexcept { return impl_->truth; }

const std::vector<Contact>& MujocoPlant::contacts() const noexcept { return impl_->contact_log.contacts(); }

const Mechanism& MujocoPlant::mechanism() const noexcept { return impl_->mechanism; }

void MujocoPlant::push_handle(const Vector3d& force) noexcept {
  impl_->push = force.allFinite() ? force : Vector3d(Vector3d::Zero());
}

double MujocoPlant::mechanism_inertia() const noexcept {
  std::array<double, 64> unit{};
  std::array<double, 64> column{};
  const Impl& plant = *impl_;
  if (plant.model->nv > 64) return std::numeric_limits<double>::quiet_NaN();
  unit[static_cast<std::size_t>(plant.at.mechanism_v)] = 1.0;
  mj_mulM(plant.model.get(), plant.data.get(), column.data(), unit.data());
  return column[static_cast<std::size_t>(plant.at.mechanism_v)];
}

}  // namespace ajar
