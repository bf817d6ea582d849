// What the robot touches: the handle through the spring of its grasp, everything else as a recorded contact.
#include "touch.hpp"

#include <algorithm>
#include <cmath>

#include "ajar/core/error.hpp"

namespace ajar::scene {
namespace {

// The hand round a handle is nearer to the leaf than its coarse capsules allow, so the last link and the tool do not collide
// with the leaf within this distance of the grip, or while they hold it [m].
constexpr double kHandRoom = 0.05;

int need(int id, const char* name) {
  if (id < 0) throw PlantError(std::string("scene: part '") + name + "' is missing");
  return id;
}

bool begins_with(const char* text, const char* start) { return text != nullptr && std::string(text).rfind(start, 0) == 0; }

/// Name of what a geom belongs to, as the result reports it.
std::string part_name(const mjModel& model, int geom) {
  const char* name = mj_id2name(&model, mjOBJ_GEOM, geom);
  if (begins_with(name, kRobotPrefix)) {
    const std::string link = std::string(name).substr(std::string(kRobotPrefix).size());
    return link.substr(0, link.find('#'));
  }
  if (begins_with(name, "leaf ")) return "leaf";
  if (name != nullptr) return name;
  const char* body = mj_id2name(&model, mjOBJ_BODY, model.geom_bodyid[geom]);
  return body != nullptr ? body : "geom " + std::to_string(geom);
}

}  // namespace

Grasp::Grasp(mjModel& model, const RobotModel& robot, const Handle& handle, const GraspConfig& config)
    : model_(model),
      config_(config),
      gripper_(robot.gripper_stroke()),
      thickness_(grip_thickness(handle, robot.gripper_stroke())),
      drop_reach_(std::max(2.0 * config.reach_tolerance, 0.5 * handle.length)),
      equality_(need(mj_name2id(&model, mjOBJ_EQUALITY, kGrasp), kGrasp)),
      hand_site_(need(mj_name2id(&model, mjOBJ_SITE, (std::string(kRobotPrefix) + kHandSite).c_str()), kHandSite)),
      grip_site_(need(mj_name2id(&model, mjOBJ_SITE, kGripSite), kGripSite)),
      hand_body_(model.eq_obj1id[equality_]),
      held_body_(model.eq_obj2id[equality_]) {
  set_grasp_spring(model, equality_, hand_body_, held_body_, config);
  const std::string last = std::string(kRobotPrefix) + robot.joint_names().back();
  const int joint = need(mj_name2id(&model, mjOBJ_JOINT, last.c_str()), last.c_str());
  for (int g = 0; g < model.ngeom; ++g) {
    const int body = model.body_weldid[model.geom_bodyid[g]];
    if (body == model.body_weldid[model.jnt_bodyid[joint]]) tool_geoms_.push_back(g);
  }
}

void Grasp::reset(mjData& data) noexcept {
  gripper_.reset();
  release(data);
  allow_tool_on_leaf(grip_distance(data) > kHandRoom);
}

double Grasp::grip_distance(const mjData& data) const noexcept {
  return (vector3(data.site_xpos + 3 * hand_site_) - vector3(data.site_xpos + 3 * grip_site_)).norm();
}

void Grasp::allow_tool_on_leaf(bool allowed) noexcept {
  if (allowed == tool_on_leaf_) return;
  tool_on_leaf_ = allowed;
  for (const int g : tool_geoms_) {
    if (allowed) {
      model_.geom_contype[g] |= kLeafBit;
    } else {
      model_.geom_contype[g] &= ~kLeafBit;
    }
  }
}

void Grasp::take(mjData& data) noexcept {
  // Held as it is met: the spring is at rest where the fingers closed.
  double* relation = model_.eq_data + mjNEQDATA * equality_;
  const Vector3d point = vector3(data.site_xpos + 3 * hand_site_);
  const Matrix3d R_hand = matrix3(data.xmat + 9 * hand_body_);
  const Matrix3d R_held = matrix3(data.xmat + 9 * held_body_);
  copy_to(relation, R_held.transpose() * (point - vector3(data.xpos + 3 * held_body_)));
  copy_to(relation + 3, R_hand.transpose() * (point - vector3(data.xpos + 3 * hand_body_)));
  copy_quaternion(relation + 6, R_hand.transpose() * R_held);
  data.eq_active[equality_] = 1;
  grasped_ = true;
}

void Grasp::release(mjData& data) noexcept {
  data.eq_active[equality_] = 0;
  grasped_ = false;
  force_.setZero();
  torque_.setZero();
}

void Grasp::read_force(const mjData& data) noexcept {
  force_.setZero();
  torque_.setZero();
  for (int row = 0; row + 6 <= data.ne; ++row) {
    if (data.efc_type[row] != mjCNSTR_EQUALITY || data.efc_id[row] != equality_) continue;
    // Rows: hand against handle, world axes; then half the angle of the handle against the hand, the handle's axes, scaled.
    force_ = -vector3(data.efc_force + row);
    const double scale = 0.5 * model_.eq_data[mjNEQDATA * equality_ + 10];
    torque_ = scale * (matrix3(data.xmat + 9 * held_body_) * vector3(data.efc_force + row + 3));
    return;
  }
}

void Grasp::creep(const mjData& data) noexcept {
  const double size = force_.norm();
  const double way = grip_creep(config_, size, model_.opt.timestep);
  if (!(way > 0.0)) return;
  const Vector3d shift = way / size * force_;
  Eigen::Map<Vector3d> anchor(model_.eq_data + mjNEQDATA * equality_);
  anchor += matrix3(data.xmat + 9 * held_body_).transpose() * shift;
}

void Grasp::step(mjData& data, bool closed, bool may_hold) noexcept {
  const double distance = grip_distance(data);
  if (grasped_) {
    read_force(data);
    const bool lost = !may_hold || force_.norm() > config_.break_force || distance > drop_reach_;
    if (lost || !closed) {
      release(data);
    } else {
      creep(data);
    }
  }
  const bool between = may_hold && (grasped_ || distance <= config_.reach_tolerance);
  gripper_.step(closed, between ? thickness_ : 0.0, model_.opt.timestep);
  if (!grasped_ && closed && between && gripper_.holds(thickness_)) take(data);
  allow_tool_on_leaf(!grasped_ && distance > kHandRoom);
}

ContactLog::ContactLog(const mjModel& model, const std::vector<int>& hand)
    : hand_geom_(static_cast<std::size_t>(model.ngeom), false) {
  for (const int g : hand) hand_geom_[static_cast<std::size_t>(g)] = true;
  for (int g = 0; g < model.ngeom; ++g) {
    const std::string name = part_name(model, g);
    const auto found = std::find(parts_.begin(), parts_.end(), name);
    part_of_geom_.push_back(static_cast<int>(found - parts_.begin()));
    if (found == parts_.end()) parts_.push_back(name);
    leaf_geom_.push_back((model.geom_contype[g] & kLeafBit) == 0 && (model.geom_conaffinity[g] & kLeafBit) != 0);
    robot_of_geom_.push_back((model.geom_contype[g] & (kWorldBit | kSelfBit)) != 0);
  }
  keys_.reserve(64);
  contacts_.reserve(64);
}

void ContactLog::reset() noexcept {
  keys_.clear();
  contacts_.clear();
}

void ContactLog::record(const mjModel& model, const mjData& data, double time, bool leans) noexcept {
  for (int i = 0; i < data.ncon; ++i) {
    const mjContact& contact = data.contact[i];
    int a = contact.geom[0];
    int b = contact.geom[1];
    if (a < 0 || b < 0 || contact.efc_address < 0) continue;
    if (!robot_of_geom_[static_cast<std::size_t>(a)]) std::swap(a, b);
    if (!robot_of_geom_[static_cast<std::size_t>(a)]) continue;
    if (leans && hand_geom_[static_cast<std::size_t>(a)] && leaf_geom_[static_cast<std::size_t>(b)]) continue;
    double force[6] = {0.0};
    mj_contactForce(&model, &data, i, force);
    if (!(force[0] > 0.0)) continue;
    int first = part_of_geom_[static_cast<std::size_t>(a)];
    int second = part_of_geom_[static_cast<std::size_t>(b)];
    if (robot_of_geom_[static_cast<std::size_t>(b)] && first > second) std::swap(first, second);
    const int key = first * static_cast<int>(parts_.size()) + second;
    const auto found = std::find(keys_.begin(), keys_.end(), key);
    if (found != keys_.end()) {
      Contact& known = contacts_[static_cast<std::size_t>(found - keys_.begin())];
      known.force = std::max(known.force, force[0]);
      continue;
    }
    keys_.push_back(key);
    contacts_.push_back(
        {time, parts_[static_cast<std::size_t>(first)] + " + " + parts_[static_cast<std::size_t>(second)], force[0]});
  }
}

}  // namespace ajar::scene
