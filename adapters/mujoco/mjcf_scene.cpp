// Worlds that somebody else wrote: the truth about one of their mechanisms, and room for the robot.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "scene.hpp"

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"
#include "ajar/plant/sensor_models.hpp"

namespace ajar {
namespace {

using scene::DataPtr;
using scene::matrix3;
using scene::ModelPtr;
using scene::vector3;

// Travel of a joint without limits: half a turn, or 1 m.
constexpr double kFreeTurn = std::numbers::pi;
constexpr double kFreeSlide = 1.0;
// A geom whose largest half extent reaches this is a panel, not a part of the handle [m].
constexpr double kPanelSize = 0.1;
// In front of a handle there must be this much free space [m].
constexpr double kFreeFront = 0.3;
// Farther behind the grip than this there is no leaf to speak of [m].
constexpr double kDeepestLeaf = 0.3;
// Handles farther from the site than this belong to something else [m].
constexpr double kHandleReach = 0.05;
// A bar is at least this much longer than it is wide [-].
constexpr double kBarShape = 1.5;
// What a hand can close on [m], and what a grip is taken for when the model has a site but no body there [m].
constexpr double kThickestGrip = 0.12;
constexpr double kUnknownThickness = 0.02;
constexpr double kUnknownLength = 0.12;

struct Compiled {
  ModelPtr model;
  DataPtr data;
  int joint = -1;
  int site = -1;
};

std::string names_of(const mjModel& model, mjtObj type, int count) {
  std::string list;
  for (int i = 0; i < count; ++i) {
    const char* name = mj_id2name(&model, type, i);
    if (name == nullptr) continue;
    if (type == mjOBJ_JOINT && model.jnt_type[i] != mjJNT_HINGE && model.jnt_type[i] != mjJNT_SLIDE) continue;
    list += (list.empty() ? "" : ", ") + std::string(name);
  }
  return list.empty() ? "none with a name" : list;
}

Compiled open_world(const MjcfWorld& world) {
  Compiled out;
  const scene::SpecPtr spec = scene::read_mjcf(world.path);
  out.model = scene::compile(*spec, world.path.string());
  const mjModel& model = *out.model;
  out.joint = mj_name2id(&model, mjOBJ_JOINT, world.joint.c_str());
  if (out.joint < 0 || (model.jnt_type[out.joint] != mjJNT_HINGE && model.jnt_type[out.joint] != mjJNT_SLIDE)) {
    throw ModelError(world.path.string() + ": joint '" + world.joint + "': no hinge or slide of that name; there are: " +
                     names_of(model, mjOBJ_JOINT, static_cast<int>(model.njnt)));
  }
  out.site = mj_name2id(&model, mjOBJ_SITE, world.handle_site.c_str());
  if (out.site < 0) {
    throw ModelError(world.path.string() + ": handle site '" + world.handle_site +
                     "': no site of that name; there are: " + names_of(model, mjOBJ_SITE, static_cast<int>(model.nsite)));
  }
  out.data.reset(mj_makeData(&model));
  if (!out.data) throw PlantError(world.path.string() + ": MuJoCo: no memory for the state");
  mj_forward(&model, out.data.get());
  return out;
}

bool in_subtree(const mjModel& model, int body, int root) {
  while (body > root) body = model.body_parentid[body];
  return body == root;
}

/// Bounding box of a geom in the world.
Box geom_box(const Compiled& world, int geom) {
  const double* aabb = world.model->geom_aabb + 6 * geom;
  Box box;
  box.pose.linear() = matrix3(world.data->geom_xmat + 9 * geom);
  box.pose.translation() = vector3(world.data->geom_xpos + 3 * geom) + box.pose.linear() * vector3(aabb);
  box.half_extents = vector3(aabb + 3).cwiseMax(1e-4);
  return box;
}

double distance_to(const Box& box, const Vector3d& point) {
  const Vector3d p = box.pose.inverse(Eigen::Isometry) * point;
  return (p.cwiseAbs() - box.half_extents).cwiseMax(0.0).norm();
}

/// The geom that the fingers close on: nearest to the site, the smallest of those that contain it; -1 = none near.
int handle_geom(const Compiled& world, int leaf) {
  const Vector3d grip = vector3(world.data->site_xpos + 3 * world.site);
  int best = -1;
  double best_distance = kHandleReach;
  double best_volume = std::numeric_limits<double>::infinity();
  for (int g = 0; g < world.model->ngeom; ++g) {
    if (!in_subtree(*world.model, world.model->geom_bodyid[g], leaf)) continue;
    const Box box = geom_box(world, g);
    const double distance = distance_to(box, grip);
    const double volume = box.half_extents.prod();
    if (distance < best_distance - 1e-6 || (distance < best_distance + 1e-6 && volume < best_volume)) {
      best = g;
      best_distance = distance;
      best_volume = volume;
    }
  }
  return best;
}

/// Hides what is not a panel, so that rays meet the leaf's face and not the handle or its posts.
void hide_small_parts(Compiled& world, int leaf, int handle) {
  for (int g = 0; g < world.model->ngeom; ++g) {
    if (!in_subtree(*world.model, world.model->geom_bodyid[g], leaf)) continue;
    const bool panel = g != handle && geom_box(world, g).half_extents.maxCoeff() >= kPanelSize;
    if (panel) continue;
    world.model->geom_rgba[4 * g + 3] = 0.0F;
    world.model->geom_matid[g] = -1;
  }
}

struct Face {
  Vector3d normal = Vector3d::Zero();
  double distance = std::numeric_limits<double>::infinity();
};

/// The face of the leaf behind the grip: over directions, the nearest panel opposite to free space.
Face leaf_face(const Compiled& world, const Vector3d& grip, const std::vector<Vector3d>& directions) {
  Face best;
  for (const Vector3d& direction : directions) {
    const Vector3d back = -direction;
    int geom = -1;
    double surface[3] = {0.0, 0.0, 0.0};
    const double front =
        mj_ray(world.model.get(), world.data.get(), grip.data(), direction.data(), nullptr, 1, -1, &geom, nullptr);
    if (front >= 0.0 && front < kFreeFront) continue;
    const double behind =
        mj_ray(world.model.get(), world.data.get(), grip.data(), back.data(), nullptr, 1, -1, &geom, surface);
    if (behind < 0.0 || behind > kDeepestLeaf || behind >= best.distance) continue;
    const Vector3d normal = vector3(surface);
    best.distance = behind;
    best.normal = normal.dot(direction) > 0.5 ? normal.normalized() : direction;
  }
  return best;
}

std::vector<Vector3d> outward_candidates() {
  std::vector<Vector3d> directions;
  constexpr int kAround = 24;  // 15 degrees apart; the face's own normal refines the best
  for (int i = 0; i < kAround; ++i) {
    const double angle = 2.0 * std::numbers::pi * i / kAround;
    directions.emplace_back(std::cos(angle), std::sin(angle), 0.0);
  }
  directions.push_back(Vector3d::UnitZ());
  return directions;
}

void describe_bar(const Compiled& world, const MjcfWorld& request, int geom, Handle& handle) {
  handle.bar = any_perpendicular(handle.normal);
  handle.thickness = kUnknownThickness;
  handle.length = kUnknownLength;
  // A site well in front of a plain panel stands for a handle that the model does not draw.
  if (geom >= 0 && geom_box(world, geom).half_extents.maxCoeff() > 0.0) {
    const Box box = geom_box(world, geom);
    int longest = 0;
    box.half_extents.maxCoeff(&longest);
    const Vector3d axis = box.pose.linear().col(longest);
    double across = std::numeric_limits<double>::infinity();
    double second = 0.0;
    for (int i = 0; i < 3; ++i) {
      if (i == longest) continue;
      across = std::min(across, 2.0 * box.half_extents(i));
      second = std::max(second, box.half_extents(i));
    }
    handle.bar = axis;
    handle.thickness = across;
    handle.length = 2.0 * box.half_extents(longest);
    if (box.half_extents(longest) < kBarShape * second) handle.kind = HandleKind::Knob;
    if (2.0 * second > kThickestGrip) handle.kind = HandleKind::None;
  }
  if (request.bar) handle.bar = request.bar->normalized();
}

Handle describe_handle(Compiled& world, const MjcfWorld& request, int leaf) {
  Handle handle;
  handle.position = vector3(world.data->site_xpos + 3 * world.site);
  const int geom = handle_geom(world, leaf);
  hide_small_parts(world, leaf, geom);
  const Face face = leaf_face(world, handle.position,
                              request.normal ? std::vector<Vector3d>{request.normal->normalized()} : outward_candidates());
  if (request.normal) {
    handle.normal = request.normal->normalized();
  } else if (std::isfinite(face.distance)) {
    handle.normal = face.normal;
  } else {
    throw ModelError(request.path.string() + ": handle site '" + request.handle_site +
                     "': no free side found in front of a leaf; give the outward normal");
  }
  handle.standoff = std::isfinite(face.distance) ? face.distance : 0.0;
  describe_bar(world, request, geom, handle);
  return handle;
}

void describe_dynamics(const Compiled& world, int leaf, double sign, Mechanism& mechanism) {
  const mjModel& model = *world.model;
  const int dof = model.jnt_dofadr[world.joint];
  mechanism.mass = std::max(model.body_subtreemass[leaf], 1e-3);
  mechanism.com = vector3(world.data->subtree_com + 3 * leaf);
  std::vector<double> unit(static_cast<std::size_t>(model.nv), 0.0);
  std::vector<double> column(static_cast<std::size_t>(model.nv), 0.0);
  unit[static_cast<std::size_t>(dof)] = 1.0;
  mj_mulM(&model, world.data.get(), column.data(), unit.data());
  mechanism.armature = model.dof_armature[dof];
  mechanism.inertia = std::max(column[static_cast<std::size_t>(dof)] - mechanism.armature, 1e-6);
  mechanism.gravity_share = 1.0 - std::clamp(model.body_gravcomp[leaf], 0.0, 1.0);
  mechanism.coulomb = model.dof_frictionloss[dof];
  mechanism.viscous = model.dof_damping[dof];
  mechanism.stiffness = model.jnt_stiffness[world.joint];
  const int address = model.jnt_qposadr[world.joint];
  mechanism.spring_reference = sign * (model.qpos_spring[address] - model.qpos0[address]);
}

/// Bounding boxes of what can be touched; those round the grip itself (hollow meshes) say nothing.
void describe_boxes(const Compiled& world, int leaf, Mechanism& mechanism) {
  const mjModel& model = *world.model;
  for (int g = 0; g < model.ngeom; ++g) {
    if (model.geom_type[g] == mjGEOM_PLANE || model.geom_type[g] == mjGEOM_HFIELD) continue;
    if (model.geom_contype[g] == 0 && model.geom_conaffinity[g] == 0) continue;
    const Box box = geom_box(world, g);
    if (in_subtree(model, model.geom_bodyid[g], leaf)) {
      mechanism.leaf.push_back(box);
    } else if (distance_to(box, mechanism.handle.position) > 0.0) {
      mechanism.world.push_back(box);
    }
  }
}

}  // namespace

Mechanism load_mjcf_mechanism(const MjcfWorld& request) {
  Compiled world = open_world(request);
  const mjModel& model = *world.model;
  const int leaf = model.jnt_bodyid[world.joint];
  const double closed = model.qpos0[model.jnt_qposadr[world.joint]];
  const bool hinge = model.jnt_type[world.joint] == mjJNT_HINGE;
  Mechanism mechanism;
  mechanism.name = request.path.stem().string() + ":" + request.joint;
  mechanism.kind = hinge ? JointKind::Hinge : JointKind::Slide;
  double sign = 1.0;
  mechanism.travel = hinge ? kFreeTurn : kFreeSlide;
  if (model.jnt_limited[world.joint] != 0) {
    const double up = model.jnt_range[2 * world.joint + 1] - closed;
    const double down = closed - model.jnt_range[2 * world.joint];
    sign = up >= down ? 1.0 : -1.0;  // it opens where there is more way to go
    mechanism.travel = std::max(up, down);
  }
  mechanism.axis = sign * vector3(world.data->xaxis + 3 * world.joint);
  mechanism.point = vector3(world.data->xanchor + 3 * world.joint);
  describe_dynamics(world, leaf, sign, mechanism);
  mechanism.handle = describe_handle(world, request, leaf);
  describe_boxes(world, leaf, mechanism);
  try {
    mechanism.validate();
  } catch (const ConfigError& error) {
    throw ModelError(request.path.string() + ": " + error.what());
  }
  return mechanism;
}

void check_mjcf(const std::filesystem::path& path) {
  const scene::SpecPtr spec = scene::read_mjcf(path);
  static_cast<void>(scene::compile(*spec, path.string()));
}

namespace scene {

SpecPtr read_mjcf(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::is_regular_file(path, ignored)) throw IoError(path.string() + ": no such file");
  char message[512] = "";
  SpecPtr spec(mj_parseXML(path.string().c_str(), nullptr, message, sizeof message));
  if (!spec) throw ModelError(path.string() + ": " + message);
  return spec;
}

LeafSlot adopt_world(mjSpec& spec, const MjcfWorld& world, const PlantConfig& config) {
  set_options(spec, config);
  // Their key frames have the wrong length once the robot stands in the model.
  while (mjsElement* key = mjs_firstElement(&spec, mjOBJ_KEY)) mjs_delete(&spec, key);
  bool floor = false;
  for (mjsElement* e = mjs_firstElement(&spec, mjOBJ_GEOM); e != nullptr; e = mjs_nextElement(&spec, e)) {
    mjsGeom& geom = *mjs_asGeom(e);
    if (geom.contype == 0 && geom.conaffinity == 0) continue;  // only to look at
    const bool on_ground = geom.type == mjGEOM_PLANE && std::abs(geom.pos[2]) < 1e-6 &&
                           std::abs(std::abs(geom.quat[0]) - 1.0) < 1e-6 && mjs_getParent(e) == mjs_findBody(&spec, "world");
    geom.conaffinity |= on_ground ? kFloorBit | kWorldBit : kWorldBit;
    floor = floor || on_ground;
  }
  if (!floor) add_floor(spec, config);
  mjsElement* joint = mjs_findElement(&spec, mjOBJ_JOINT, world.joint.c_str());
  mjsElement* site = mjs_findElement(&spec, mjOBJ_SITE, world.handle_site.c_str());
  if (joint == nullptr || site == nullptr) throw ModelError(world.path.string() + ": joint or handle site is gone");
  mjsBody* leaf = mjs_getParent(joint);
  for (mjsElement* e = mjs_firstChild(leaf, mjOBJ_GEOM, 1); e != nullptr; e = mjs_nextChild(leaf, e, 1)) {
    mjsGeom& geom = *mjs_asGeom(e);
    if ((geom.conaffinity & kWorldBit) != 0) geom.conaffinity ^= kWorldBit | kLeafBit;
  }
  LeafSlot slot;
  slot.joint = world.joint;
  slot.body = mjs_getParent(site);
  if (*mjs_getString(mjs_getName(slot.body->element)) == '\0') mjs_setName(slot.body->element, "ajar/handle_body");
  // Only the body's pose is missing: compile the world as it is and look.
  const ModelPtr model = compile(spec, world.path.string());
  const DataPtr data(mj_makeData(model.get()));
  mj_forward(model.get(), data.get());
  const int body = model->site_bodyid[mj_name2id(model.get(), mjOBJ_SITE, world.handle_site.c_str())];
  slot.X_WL.linear() = matrix3(data->xmat + 9 * body);
  slot.X_WL.translation() = vector3(data->xpos + 3 * body);
  return slot;
}

}  // namespace scene
}  // namespace ajar
