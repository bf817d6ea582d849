// The robot as bodies: inertias from its URDF, collision shapes, wheels, casters, servos and the wrist sensor.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "scene.hpp"

#include "ajar/core/error.hpp"

namespace ajar::scene {
namespace {

// Casters: frictionless spheres under the corners of the hull, as far inside it as the MiR100's are [m].
constexpr double kCasterRadius = 0.03;
constexpr double kCasterInsetX = 0.145;
constexpr double kCasterInsetY = 0.089;
// Contact time of the casters [s]: it sets how much of the weight stays on the wheels, 52 % for Heron.
constexpr double kCasterTime = 0.01;
constexpr double kWheelContactTime = 0.005;
// A wheel of the MiR100: mass [kg], inertia of wheel and geared motor [kg m²], bearing friction [N m s/rad].
constexpr double kWheelMass = 1.0;
constexpr double kWheelArmature = 0.05;
constexpr double kWheelDamping = 0.05;
// Wheel servo: stiffness [N m/rad], damping [N m s/rad], limit [N m]; softer ones give way under a pull of 40 N.
constexpr double kWheelKp = 100.0;
constexpr double kWheelKv = 10.0;
constexpr double kWheelTorque = 20.0;

std::string prefixed(const std::string& name) { return kRobotPrefix + name; }

mjsBody& robot_body(mjSpec& spec, const std::string& link) {
  mjsBody* body = mjs_findBody(&spec, link.c_str());
  if (body == nullptr) throw ModelError("robot: link '" + link + "' is not in the URDF");
  return *body;
}

void delete_all(mjSpec& spec, mjtObj type) {
  while (mjsElement* element = mjs_firstElement(&spec, type)) mjs_delete(&spec, element);
}

/// Joints that the robot model does not move (wheels, casters, fingers) become fixed.
void fix_other_joints(mjSpec& spec, const std::vector<std::string>& moving) {
  std::vector<mjsElement*> fixed;
  for (mjsElement* e = mjs_firstElement(&spec, mjOBJ_JOINT); e != nullptr; e = mjs_nextElement(&spec, e)) {
    const std::string name = mjs_getString(mjs_getName(e));
    if (std::find(moving.begin(), moving.end(), name) == moving.end()) fixed.push_back(e);
  }
  for (mjsElement* e : fixed) mjs_delete(&spec, e);
}

/// Everything in a body's subtree, itself included.
template <typename Visit>
void visit_bodies(mjsBody& root, Visit visit) {
  visit(root);
  for (mjsElement* e = mjs_firstChild(&root, mjOBJ_BODY, 0); e != nullptr; e = mjs_nextChild(&root, e, 0)) {
    visit_bodies(*mjs_asBody(e), visit);
  }
}

/// The joint's element, of the robot's own spec before it is attached.
mjsJoint& robot_joint(mjSpec& spec, const std::string& name) {
  mjsElement* element = mjs_findElement(&spec, mjOBJ_JOINT, name.c_str());
  if (element == nullptr) throw ModelError("robot: joint '" + name + "' is not in the URDF");
  return *mjs_asJoint(element);
}

mjsBody& body_of_joint(mjSpec& spec, const std::string& name) { return *mjs_getParent(robot_joint(spec, name).element); }

void dress_joints(mjSpec& spec, const RobotModel& model) {
  const std::vector<ServoGains> gains = servo_gains(model);
  const RobotLimits& limits = model.limits();
  for (int i = 0; i < model.joints(); ++i) {
    mjsJoint& joint = robot_joint(spec, model.joint_names()[static_cast<std::size_t>(i)]);
    joint.armature = gains[static_cast<std::size_t>(i)].armature;
    joint.limited = mjLIMITED_TRUE;
    joint.range[0] = limits.position_lower(i);
    joint.range[1] = limits.position_upper(i);
    joint.actfrclimited = mjLIMITED_TRUE;
    joint.actfrcrange[0] = -limits.effort(i);
    joint.actfrcrange[1] = limits.effort(i);
  }
}

/// Gives the tool its true mass and keeps the frames that carry sites.
void dress_tool(mjSpec& spec, const RobotModel& model, const PlantConfig& config) {
  mjsBody& sensor = robot_body(spec, model.sensor_frame());
  mjsBody& hand = robot_body(spec, model.hand_frame());
  sensor.fuse = 0;
  hand.fuse = 0;
  const double scale = 1.0 + config.wrist_sensor.tool_mass_error / std::max(model.tool_mass(), 1e-3);
  if (!(scale > 0.0)) {
    throw ConfigError("plant.wrist_sensor.tool_mass_error = " + std::to_string(config.wrist_sensor.tool_mass_error) +
                      ": leaves no mass of the tool's " + std::to_string(model.tool_mass()) + " kg");
  }
  visit_bodies(sensor, [scale](mjsBody& body) {
    body.mass *= scale;
    for (double& value : body.inertia) value *= scale;
    if (std::isfinite(body.fullinertia[0])) {
      for (double& value : body.fullinertia) value *= scale;
    }
  });
  mjsSite* site = mjs_addSite(&sensor, nullptr);
  mjs_setName(site->element, kSensorSite);
  site = mjs_addSite(&hand, nullptr);
  mjs_setName(site->element, kHandSite);
}

/// Whether two parts of the robot can meet, by the rule of ClearanceChecker: the first link always sits on its mount, and
/// neighbours overlap where they are joined.
bool can_meet(const RobotModel& model, int joint_a, int joint_b) {
  const int low = std::min(joint_a, joint_b);
  const int high = std::max(joint_a, joint_b);
  if (low < 0 ? high < 1 : high - low < 2) return false;
  // MuJoCo excludes whole bodies, so one pair of shapes that the robot's file exempts frees the parts that carry them.
  const auto joint_of = [&](int shape) { return model.shapes()[static_cast<std::size_t>(shape)].joint; };
  return std::none_of(model.unchecked_pairs().begin(), model.unchecked_pairs().end(), [&](const std::array<int, 2>& pair) {
    return std::min(joint_of(pair[0]), joint_of(pair[1])) == low && std::max(joint_of(pair[0]), joint_of(pair[1])) == high;
  });
}

void add_shape(mjsBody& body, const CollisionShape& shape, const Pose& X_body, int index) {
  mjsGeom* geom = mjs_addGeom(&body, nullptr);
  mjs_setName(geom->element, (shape.link + "#" + std::to_string(index)).c_str());
  const Pose pose = X_body * shape.pose_in_joint;
  copy_to(geom->pos, pose.translation());
  copy_quaternion(geom->quat, pose.linear());
  if (shape.kind == CollisionShape::Kind::Capsule) {
    geom->type = mjGEOM_CAPSULE;
    geom->size[0] = shape.radius;
    geom->size[1] = shape.half_length;
  } else {
    geom->type = mjGEOM_BOX;
    copy_to(geom->size, shape.half_extents);
  }
  geom->mass = 0.0;
  geom->density = 0.0;
  geom->contype = kWorldBit | kLeafBit | kSelfBit;
  geom->conaffinity = kSelfBit;
}

/// Pose of the wrist sensor in the last joint's body.
Pose sensor_in_joint(const RobotModel& model) {
  Kinematics kinematics;
  model.compute(BasePose{}, model.home(), kinematics);
  Pose X_WF = Pose::Identity();
  X_WF.linear() = kinematics.R_WF;
  X_WF.translation() = kinematics.p_WF;
  return model.joint_pose(model.joints() - 1, BasePose{}).inverse(Eigen::Isometry) * X_WF;
}

/// What the tool touches is felt: its shapes belong to the body that the wrist sensor carries.
void add_shapes(mjSpec& spec, const RobotModel& model, mjsBody& root, const Pose& X_RB) {
  mjsBody& sensor = robot_body(spec, model.sensor_frame());
  std::vector<std::string> tool;
  visit_bodies(sensor, [&](mjsBody& body) { tool.emplace_back(mjs_getString(mjs_getName(body.element))); });
  const Pose X_FJ = sensor_in_joint(model).inverse(Eigen::Isometry);
  const auto carrier = [&](int joint) -> mjsBody& {
    return joint < 0 ? root : body_of_joint(spec, model.joint_names()[static_cast<std::size_t>(joint)]);
  };
  int index = 0;
  for (const CollisionShape& shape : model.shapes()) {
    if (std::find(tool.begin(), tool.end(), shape.link) != tool.end()) {
      add_shape(sensor, shape, X_FJ, index++);
    } else {
      add_shape(carrier(shape.joint), shape, shape.joint < 0 ? X_RB : Pose::Identity(), index++);
    }
  }
  const auto exclude = [&](mjsBody& a, mjsBody& b) {
    mjsExclude* pair = mjs_addExclude(&spec);
    mjs_setString(pair->bodyname1, mjs_getString(mjs_getName(a.element)));
    mjs_setString(pair->bodyname2, mjs_getString(mjs_getName(b.element)));
  };
  for (int a = -1; a < model.joints(); ++a) {
    for (int b = a + 1; b < model.joints(); ++b) {
      if (can_meet(model, a, b)) continue;
      exclude(carrier(a), carrier(b));
      if (b == model.joints() - 1) exclude(carrier(a), sensor);
    }
  }
}

void add_casters(mjsBody& root, const RobotModel& model, const Pose& X_RB) {
  Vector3d lower = Vector3d::Constant(std::numeric_limits<double>::infinity());
  Vector3d upper = -lower;
  for (const CollisionShape& shape : model.shapes()) {
    if (shape.joint >= 0) continue;
    Vector3d extent = shape.pose_in_joint.linear().cwiseAbs() * shape.half_extents;
    if (shape.kind == CollisionShape::Kind::Capsule) {
      extent = (shape.pose_in_joint.linear().col(2) * shape.half_length).cwiseAbs().array() + shape.radius;
    }
    lower = lower.cwiseMin(shape.pose_in_joint.translation() - extent);
    upper = upper.cwiseMax(shape.pose_in_joint.translation() + extent);
  }
  if (!lower.allFinite())
    throw ModelError("robot '" + model.name() + "': a wheeled base needs a collision shape to stand on");
  const Vector3d middle = 0.5 * (lower + upper);
  const Vector3d half = 0.5 * (upper - lower);
  const double x = std::max(half.x() - kCasterInsetX, 0.5 * half.x());
  const double y = std::max(half.y() - kCasterInsetY, 0.5 * half.y());
  for (const Vector2d& corner : {Vector2d(x, y), Vector2d(x, -y), Vector2d(-x, y), Vector2d(-x, -y)}) {
    mjsGeom* geom = mjs_addGeom(&root, nullptr);
    geom->type = mjGEOM_SPHERE;
    geom->size[0] = kCasterRadius;
    copy_to(geom->pos, X_RB * Vector3d(middle.x() + corner.x(), middle.y() + corner.y(), kCasterRadius));
    geom->mass = geom->density = 0.0;
    geom->contype = kFloorBit;
    geom->conaffinity = 0;
    geom->condim = 1;
    geom->priority = 1;
    geom->solref[0] = kCasterTime;
    geom->solref[1] = 1.0;
  }
}

/// Spheres, not cylinders: a cylinder touches in several points and scrubs the floor (84 mm of drift over 1.7 m).
void add_wheels(mjsBody& root, const RobotModel& model, const PlantConfig& config, const Pose& X_RB) {
  for (int side = 0; side < 2; ++side) {
    mjsBody* body = mjs_addBody(&root, nullptr);
    mjs_setName(body->element, kWheel[side]);
    copy_to(body->pos, X_RB * Vector3d(0.0, (side == 0 ? 0.5 : -0.5) * model.wheel_track(), model.wheel_radius()));
    copy_quaternion(body->quat, X_RB.linear());
    mjsJoint* joint = mjs_addJoint(body, nullptr);
    mjs_setName(joint->element, kWheel[side]);
    joint->type = mjJNT_HINGE;
    copy_to(joint->axis, Vector3d::UnitY());
    joint->armature = kWheelArmature;
    joint->damping[0] = kWheelDamping;
    mjsGeom* geom = mjs_addGeom(body, nullptr);
    geom->type = mjGEOM_SPHERE;
    geom->size[0] = model.wheel_radius();
    geom->mass = kWheelMass;
    geom->contype = kFloorBit;
    geom->conaffinity = 0;
    geom->condim = 3;
    geom->friction[0] = config.base.friction;
    geom->priority = 2;
    geom->solref[0] = kWheelContactTime;
    geom->solref[1] = 1.0;
  }
}

void add_servo(mjSpec& spec, const std::string& joint, double kp, double kv, double limit) {
  mjsActuator* actuator = mjs_addActuator(&spec, nullptr);
  mjs_setName(actuator->element, joint.c_str());
  mjs_setToPosition(actuator, kp, &kv, nullptr, nullptr, 0.0);
  actuator->trntype = mjTRN_JOINT;
  mjs_setString(actuator->target, joint.c_str());
  if (limit > 0.0) {
    actuator->forcelimited = mjLIMITED_TRUE;
    actuator->forcerange[0] = -limit;
    actuator->forcerange[1] = limit;
  }
}

void add_actuators(mjSpec& spec, const RobotModel& model, const PlantConfig& config) {
  const std::vector<ServoGains> gains = servo_gains(model);
  const double gain = config.arm.servo_gain;
  for (std::size_t i = 0; i < gains.size(); ++i) {
    // Damping grows with the root of the stiffness, which keeps the damping ratio.
    add_servo(spec, prefixed(model.joint_names()[i]), gain * gains[i].kp, std::sqrt(gain) * gains[i].kv, 0.0);
  }
  if (model.base_type() != BaseType::Differential) return;
  for (int side = 0; side < 2; ++side) {
    const std::string wheel = prefixed(kWheel[side]);
    add_servo(spec, wheel, kWheelKp, kWheelKv, kWheelTorque);
    mjsEquality* lock = mjs_addEquality(&spec, nullptr);
    mjs_setName(lock->element, kWheelLock[side]);
    lock->type = mjEQ_JOINT;
    lock->objtype = mjOBJ_JOINT;
    lock->active = 0;
    mjs_setString(lock->name1, wheel.c_str());
  }
}

void add_wrist_sensor(mjSpec& spec) {
  for (const mjtSensor type : {mjSENS_FORCE, mjSENS_TORQUE}) {
    mjsSensor* sensor = mjs_addSensor(&spec);
    sensor->type = type;
    sensor->objtype = mjOBJ_SITE;
    mjs_setString(sensor->objname, prefixed(kSensorSite).c_str());
  }
}

/// Pose of the base frame in the URDF's root link: the difference between where both say the hand is, all joints at zero.
Pose base_in_root(const mjSpec& robot, const RobotModel& model) {
  const SpecPtr copy(mj_copySpec(&robot));
  const ModelPtr compiled = compile(*copy, model.urdf_path().string());
  const DataPtr data(mj_makeData(compiled.get()));
  mj_kinematics(compiled.get(), data.get());
  const int site = mj_name2id(compiled.get(), mjOBJ_SITE, kHandSite);
  Pose X_RE = Pose::Identity();
  X_RE.linear() = matrix3(data->site_xmat + 9 * site);
  X_RE.translation() = vector3(data->site_xpos + 3 * site);
  Kinematics kinematics;
  model.compute(BasePose(), JointVector::Zero(model.joints()), kinematics);
  return X_RE * kinematics.X_WE.inverse(Eigen::Isometry);
}

SpecPtr read_urdf(const RobotModel& model) {
  char message[512] = "";
  SpecPtr spec(mj_parseXML(model.urdf_path().string().c_str(), nullptr, message, sizeof message));
  if (!spec) throw ModelError(model.urdf_path().string() + ": " + message);
  // Meshes and visuals are of no use here: the collision shapes are those that the planner knows.
  delete_all(*spec, mjOBJ_GEOM);
  delete_all(*spec, mjOBJ_MESH);
  fix_other_joints(*spec, model.joint_names());
  return spec;
}

}  // namespace

std::vector<ServoGains> servo_gains(const RobotModel& model) {
  // UR5e: measured behaviour of its servo, about 9e3 N/m at the tool; damping ratio about 1 with the motors' inertia.
  static const std::vector<ServoGains> ur5e = {{1e4, 300.0, 0.5}, {1e4, 300.0, 0.5}, {8e3, 200.0, 0.5},
                                               {2e3, 40.0, 0.1},  {2e3, 40.0, 0.1},  {1e3, 20.0, 0.1}};
  const JointVector& effort = model.limits().effort;
  JointVector of_ur5e(6);
  of_ur5e << 150.0, 150.0, 150.0, 28.0, 28.0, 28.0;
  if (effort.size() == 6 && effort.isApprox(of_ur5e, 1e-9)) return ur5e;
  std::vector<ServoGains> gains;
  for (const double limit : effort) {
    // The same proportions: full effort at 15 mrad (or mm) of error, 25 ms from error to rate, motor inertia by size.
    gains.push_back({limit / 0.015, 0.025 * limit / 0.015, limit / 300.0});
  }
  return gains;
}

Pose add_robot(mjSpec& spec, const RobotModel& model, const PlantConfig& config, const BasePose& start) {
  SpecPtr robot = read_urdf(model);
  mjsElement* first = mjs_firstChild(mjs_findBody(robot.get(), "world"), mjOBJ_BODY, 0);
  if (first == nullptr) throw ModelError(model.urdf_path().string() + ": has no links");
  mjsBody& root = *mjs_asBody(first);
  root.fuse = 0;
  dress_joints(*robot, model);
  dress_tool(*robot, model, config);
  const Pose X_RB = base_in_root(*robot, model);
  add_shapes(*robot, model, root, X_RB);
  if (model.base_type() == BaseType::Differential) {
    add_casters(root, model, X_RB);
    add_wheels(root, model, config, X_RB);
  }
  if (mjs_fuseStatic(robot.get(), nullptr) < 0) {
    throw ModelError(model.urdf_path().string() + ": " + mjs_getError(robot.get()));
  }
  mjsFrame* frame = mjs_addFrame(mjs_findBody(&spec, "world"), nullptr);
  const Pose X_WR = to_pose(start) * X_RB.inverse(Eigen::Isometry);
  copy_to(frame->pos, X_WR.translation());
  copy_quaternion(frame->quat, X_WR.linear());
  mjsElement* attached = mjs_attach(frame->element, root.element, kRobotPrefix, "");
  if (attached == nullptr) throw ModelError(model.urdf_path().string() + ": " + mjs_getError(&spec));
  if (model.base_type() == BaseType::Differential) {
    mjsJoint* free = mjs_addFreeJoint(mjs_asBody(attached));
    mjs_setName(free->element, kBaseJoint);
  }
  add_actuators(spec, model, config);
  add_wrist_sensor(spec);
  return X_RB;
}

}  // namespace ajar::scene
