// The world as bodies: floor, leaf and its joint, walls, and the spring between hand and handle.
#include <algorithm>
#include <cmath>
#include <mutex>

#include "scene.hpp"

#include "ajar/core/error.hpp"
#include "ajar/plant/sensor_models.hpp"

namespace ajar::scene {
namespace {

// A massless-looking ring round the bar, free to turn: mass [kg], inertia [kg m²], and the dry and viscous friction of
// rubber pads on a bar [N m, N m s/rad]. The armature [kg m²] keeps its fast motion resolved at 2 ms.
constexpr double kSleeveMass = 1e-3;
constexpr double kSleeveInertia = 1e-6;
constexpr double kSleeveFriction = 0.1;
constexpr double kSleeveDamping = 0.05;
constexpr double kSleeveArmature = 0.01;
// Impedance of the grasp: it acts as extra mass d / ((1 - d) w); 0.2 stays stable to 3e4 N/m at 1 ms.
constexpr double kGraspImpedance = 0.2;
// Time constant of locks [s]; the stiffest that a step of 2 ms allows (MuJoCo asks for two steps).
constexpr double kLockTime = 0.004;

void add_box(mjsBody& body, const Box& box, const Vector3d& origin, int bits, const std::string& name) {
  mjsGeom* geom = mjs_addGeom(&body, nullptr);
  mjs_setName(geom->element, name.c_str());
  geom->type = mjGEOM_BOX;
  copy_to(geom->pos, box.pose.translation() - origin);
  copy_quaternion(geom->quat, box.pose.linear());
  copy_to(geom->size, box.half_extents);
  geom->mass = geom->density = 0.0;
  geom->contype = 0;
  geom->conaffinity = bits;
}

/// Mass distribution whose inertia about the axis is the mechanism's: an isotropic body at the centre of mass, drawn nearer
/// to the axis where the parallel-axis part alone would exceed it.
void set_inertia(mjsBody& body, const Mechanism& mechanism) {
  body.explicitinertial = 1;
  if (mechanism.kind == JointKind::Slide) {
    body.mass = mechanism.inertia;
    for (double& value : body.inertia) value = 0.1 * mechanism.inertia;  // never turns
    return;
  }
  const Vector3d to_com = mechanism.com - mechanism.point;
  const Vector3d arm = to_com - mechanism.axis * mechanism.axis.dot(to_com);
  const double parallel = mechanism.mass * arm.squaredNorm();
  const double share = parallel > 0.0 ? std::min(1.0, std::sqrt(0.9 * mechanism.inertia / parallel)) : 0.0;
  body.mass = mechanism.mass;
  copy_to(body.ipos, share * arm);
  for (double& value : body.inertia) value = mechanism.inertia - share * share * parallel;
}

void add_lock(mjSpec& spec, const std::string& joint, const char* name) {
  mjsEquality* lock = mjs_addEquality(&spec, nullptr);
  mjs_setName(lock->element, name);
  lock->type = mjEQ_JOINT;
  lock->objtype = mjOBJ_JOINT;
  lock->active = 0;
  lock->solref[0] = kLockTime;
  mjs_setString(lock->name1, joint.c_str());
}

mjsBody& add_sleeve(mjsBody& leaf, const Vector3d& position, const Vector3d& axis) {
  mjsBody* sleeve = mjs_addBody(&leaf, nullptr);
  mjs_setName(sleeve->element, kSleeveBody);
  copy_to(sleeve->pos, position);
  sleeve->explicitinertial = 1;
  sleeve->mass = kSleeveMass;
  for (double& value : sleeve->inertia) value = kSleeveInertia;
  sleeve->gravcomp = 1.0;
  mjsJoint* joint = mjs_addJoint(sleeve, nullptr);
  mjs_setName(joint->element, kSleeveBody);
  joint->type = mjJNT_HINGE;
  copy_to(joint->axis, axis);
  joint->frictionloss = kSleeveFriction;
  joint->damping[0] = kSleeveDamping;
  joint->armature = kSleeveArmature;
  return *sleeve;
}

}  // namespace

void set_options(mjSpec& spec, const PlantConfig& config) {
  spec.option.timestep = config.time_step;
  spec.option.integrator = mjINT_IMPLICITFAST;
  spec.option.cone = mjCONE_ELLIPTIC;
  spec.option.impratio = 10.0;  // with elliptic cones the wheels do not creep under a steady pull
  spec.option.iterations = 50;
  spec.option.gravity[0] = spec.option.gravity[1] = 0.0;
  spec.option.gravity[2] = -kGravity;
  // A diverged run must stay visible as such instead of jumping back to its start.
  spec.option.disableflags |= mjDSBL_AUTORESET;
}

SpecPtr empty_world(const PlantConfig& config) {
  SpecPtr spec(mj_makeSpec());
  if (!spec) throw PlantError("MuJoCo: no memory for a model");
  spec->compiler.degree = 0;
  set_options(*spec, config);
  return spec;
}

void add_floor(mjSpec& spec, const PlantConfig& config) {
  mjsGeom* floor = mjs_addGeom(mjs_findBody(&spec, "world"), nullptr);
  mjs_setName(floor->element, "ajar/floor");
  floor->type = mjGEOM_PLANE;
  floor->size[2] = 0.1;
  floor->contype = 0;
  floor->conaffinity = kFloorBit | kWorldBit;
  floor->friction[0] = config.base.friction;
}

LeafSlot add_mechanism(mjSpec& spec, const Mechanism& mechanism) {
  mjsBody* world = mjs_findBody(&spec, "world");
  LeafSlot slot;
  const Vector3d origin = mechanism.kind == JointKind::Hinge ? mechanism.point : mechanism.handle.position;
  slot.X_WL.translation() = origin;
  slot.joint = kMechanismJoint;
  slot.body = mjs_addBody(world, nullptr);
  mjs_setName(slot.body->element, "leaf");
  copy_to(slot.body->pos, origin);
  set_inertia(*slot.body, mechanism);
  // Weight, springs, closer and seal come from the mechanism's own law as one generalised force (see the plant).
  slot.body->gravcomp = 1.0;
  mjsJoint* joint = mjs_addJoint(slot.body, nullptr);
  mjs_setName(joint->element, kMechanismJoint);
  joint->type = mechanism.kind == JointKind::Hinge ? mjJNT_HINGE : mjJNT_SLIDE;
  copy_to(joint->axis, mechanism.axis);
  joint->limited = mjLIMITED_TRUE;
  joint->range[1] = mechanism.travel;
  joint->solref_limit[0] = mechanism.stop_time_constant;
  joint->solref_limit[1] = 1.0;
  joint->armature = mechanism.armature;
  joint->frictionloss = mechanism.coulomb;
  joint->damping[0] = mechanism.viscous;
  for (std::size_t i = 0; i < mechanism.leaf.size(); ++i) {
    add_box(*slot.body, mechanism.leaf[i], origin, kLeafBit, "leaf " + std::to_string(i));
  }
  for (std::size_t i = 0; i < mechanism.world.size(); ++i) {
    add_box(*world, mechanism.world[i], Vector3d::Zero(), kWorldBit, "wall " + std::to_string(i));
  }
  return slot;
}

void add_grasp(mjSpec& spec, const RobotModel& model, const Mechanism& mechanism, const GraspConfig& grasp,
               const LeafSlot& slot) {
  const Pose X_LW = slot.X_WL.inverse(Eigen::Isometry);
  const Vector3d grip = X_LW * mechanism.handle.position;
  mjsSite* site = mjs_addSite(slot.body, nullptr);
  mjs_setName(site->element, kGripSite);
  copy_to(site->pos, grip);
  mjsBody* held = slot.body;
  if (grasp.pivots && mechanism.handle.kind == HandleKind::Bar) {
    held = &add_sleeve(*slot.body, grip, X_LW.linear() * mechanism.handle.bar);
  }
  mjsEquality* weld = mjs_addEquality(&spec, nullptr);
  mjs_setName(weld->element, kGrasp);
  weld->type = mjEQ_WELD;
  weld->objtype = mjOBJ_BODY;
  weld->active = 0;
  mjs_setString(weld->name1, (kRobotPrefix + model.hand_frame()).c_str());
  mjs_setString(weld->name2, mjs_getString(mjs_getName(held->element)));
  for (int i = 0; i < mjNEQDATA; ++i) weld->data[i] = 0.0;
  weld->data[6] = 1.0;
  weld->data[10] = 1.0;
  add_lock(spec, slot.joint, kMechanismLock);
}

void set_grasp_spring(mjModel& model, int equality, int hand_body, int handle_body, const GraspConfig& grasp) {
  const double* w = model.body_invweight0;
  const double translation = w[2 * hand_body] + w[2 * handle_body];
  const double rotation = w[2 * hand_body + 1] + w[2 * handle_body + 1];
  const double d = kGraspImpedance;
  double* impedance = model.eq_solimp + mjNIMP * equality;
  impedance[0] = impedance[1] = d;
  double* reference = model.eq_solref + mjNREF * equality;
  reference[0] = -grasp.stiffness * (1.0 - d) * translation;
  reference[1] = -grasp.damping * (1.0 - d) * translation;
  // The rotation residual is the vector part of a quaternion, half the angle: hence the 2.
  model.eq_data[mjNEQDATA * equality + 10] =
      2.0 * std::sqrt(grasp.rotational_stiffness * rotation / (grasp.stiffness * translation));
}

ModelPtr compile(mjSpec& spec, const std::string& what) {
  // MuJoCo would append its warnings to a file in the working directory.
  static std::once_flag quiet;
  std::call_once(quiet, [] { mju_user_warning = [](const char*) {}; });
  ModelPtr model(mj_compile(&spec, nullptr));
  if (!model) throw ModelError(what + ": " + mjs_getError(&spec));
  return model;
}

}  // namespace ajar::scene
