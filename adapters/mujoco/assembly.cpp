// The order in which a scene is put together, and the addresses of its parts.
#include "assembly.hpp"

#include "ajar/core/error.hpp"

namespace ajar::scene {

int find(const mjModel& model, mjtObj type, const std::string& name) {
  const int id = mj_name2id(&model, type, name.c_str());
  if (id < 0) throw PlantError("scene: part '" + name + "' is missing");
  return id;
}

Addresses find_addresses(const mjModel& model, const RobotModel& robot, const std::string& mechanism_joint) {
  const std::string prefix = kRobotPrefix;
  Addresses at;
  for (int i = 0; i < robot.joints(); ++i) {
    const auto k = static_cast<std::size_t>(i);
    const std::string name = prefix + robot.joint_names()[k];
    const int joint = find(model, mjOBJ_JOINT, name);
    at.joint_q[k] = model.jnt_qposadr[joint];
    at.joint_v[k] = model.jnt_dofadr[joint];
    at.joint_servo[k] = find(model, mjOBJ_ACTUATOR, name);
  }
  if (robot.base_type() == BaseType::Differential) {
    for (std::size_t side = 0; side < 2; ++side) {
      const int joint = find(model, mjOBJ_JOINT, prefix + kWheel[side]);
      at.wheel_q[side] = model.jnt_qposadr[joint];
      at.wheel_v[side] = model.jnt_dofadr[joint];
      at.wheel_servo[side] = find(model, mjOBJ_ACTUATOR, prefix + kWheel[side]);
      at.wheel_lock[side] = find(model, mjOBJ_EQUALITY, kWheelLock[side]);
    }
    at.base_q = model.jnt_qposadr[find(model, mjOBJ_JOINT, kBaseJoint)];
  }
  const int mechanism = find(model, mjOBJ_JOINT, mechanism_joint);
  at.mechanism_q = model.jnt_qposadr[mechanism];
  at.mechanism_v = model.jnt_dofadr[mechanism];
  at.mechanism_lock = find(model, mjOBJ_EQUALITY, kMechanismLock);
  at.hand_site = find(model, mjOBJ_SITE, prefix + kHandSite);
  const int sensor_site = find(model, mjOBJ_SITE, prefix + kSensorSite);
  for (int s = 0; s < model.nsensor; ++s) {
    if (model.sensor_objtype[s] != mjOBJ_SITE || model.sensor_objid[s] != sensor_site) continue;
    if (model.sensor_type[s] == mjSENS_FORCE) at.force_sensor = model.sensor_adr[s];
    if (model.sensor_type[s] == mjSENS_TORQUE) at.torque_sensor = model.sensor_adr[s];
  }
  if (at.force_sensor < 0 || at.torque_sensor < 0) throw PlantError("scene: the wrist sensor is missing");
  return at;
}

Built build(const RobotModel& robot, const Mechanism& mechanism, const PlantConfig& config, const BasePose& start) {
  mechanism.validate();
  const SpecPtr spec = empty_world(config);
  add_floor(*spec, config);
  const LeafSlot slot = add_mechanism(*spec, mechanism);
  const Pose X_RB = add_robot(*spec, robot, config, start);
  add_grasp(*spec, robot, mechanism, config.grasp, slot);
  return {compile(*spec, "scene of '" + mechanism.name + "' and '" + robot.name() + "'"), slot.joint, X_RB, true};
}

Built build(const RobotModel& robot, const MjcfWorld& world, const Mechanism& mechanism, const PlantConfig& config,
            const BasePose& start) {
  const SpecPtr spec = read_mjcf(world.path);
  const LeafSlot slot = adopt_world(*spec, world, config);
  const Pose X_RB = add_robot(*spec, robot, config, start);
  add_grasp(*spec, robot, mechanism, config.grasp, slot);
  return {compile(*spec, world.path.string()), slot.joint, X_RB, false};
}

}  // namespace ajar::scene
