#include "scene.hpp"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

namespace ajar {
namespace {

using Json = nlohmann::ordered_json;

Json array_of(const Vector3d& v) { return Json::array({v.x(), v.y(), v.z()}); }

Json joint_array(const JointVector& v) {
  Json json = Json::array();
  for (Eigen::Index i = 0; i < v.size(); ++i) json.push_back(v[i]);
  return json;
}

/// Centre, axes (columns) and half extents, world.
Json json_of(const Box& box) {
  const Matrix3d R = box.pose.linear();
  return {{"centre", array_of(box.pose.translation())},
          {"axes", Json::array({array_of(R.col(0)), array_of(R.col(1)), array_of(R.col(2))})},
          {"half_extents", array_of(box.half_extents)}};
}

/// Rectangle around what the base carries, base frame: x from, x to, y from, y to [m].
Json footprint(const RobotModel& model) {
  const double far = std::numeric_limits<double>::max();
  Vector2d lower(far, far), upper(-far, -far);
  for (const CollisionShape& shape : model.shapes()) {
    if (shape.joint >= 0) continue;
    const Matrix3d R = shape.pose_in_joint.linear();
    Vector3d half = R.cwiseAbs() * shape.half_extents;
    if (shape.kind == CollisionShape::Kind::Capsule)
      half = R.col(2).cwiseAbs() * shape.half_length + Vector3d::Constant(shape.radius);
    const Vector3d p = shape.pose_in_joint.translation();
    lower = lower.cwiseMin((p - half).head<2>());
    upper = upper.cwiseMax((p + half).head<2>());
  }
  if (lower.x() > upper.x()) return nullptr;
  return Json::array({lower.x(), upper.x(), lower.y(), upper.y()});
}

Json json_of(const Pose& pose) {
  const Eigen::Quaterniond turn(pose.linear());
  return {{"position", array_of(pose.translation())},
          {"turn", {{"w", turn.w()}, {"x", turn.x()}, {"y", turn.y()}, {"z", turn.z()}}}};
}

const char* name_of(DrawnShape::Kind kind) {
  switch (kind) {
    case DrawnShape::Kind::Box: break;
    case DrawnShape::Kind::Cylinder: return "cylinder";
    case DrawnShape::Kind::Sphere: return "sphere";
    case DrawnShape::Kind::Capsule: return "capsule";
  }
  return "box";
}

Json json_of(const RobotDrawing& drawing) {
  Json joints = Json::array(), shapes = Json::array();
  for (const DrawnJoint& joint : drawing.joints) {
    joints.push_back({{"slides", joint.slides}, {"axis", array_of(joint.axis)}, {"pose", json_of(joint.pose_in_before)}});
  }
  for (const DrawnShape& shape : drawing.shapes) {
    shapes.push_back({{"kind", name_of(shape.kind)},
                      {"joint", shape.joint},
                      {"pose", json_of(shape.pose_in_joint)},
                      {"size", array_of(shape.size)},
                      {"rgba", shape.rgba}});
  }
  return {{"joints", joints}, {"shapes", shapes}, {"hand", json_of(drawing.hand_in_last)}};
}

const char* name_of(HandleKind kind) {
  switch (kind) {
    case HandleKind::Bar: break;
    case HandleKind::Knob: return "knob";
    case HandleKind::Recess: return "recess";
    case HandleKind::None: return "none";
  }
  return "bar";
}

}  // namespace

std::string scene_json(const RobotModel& model, const Mechanism& mechanism, const MissionConfig& mission) {
  const RobotLimits& limits = model.limits();
  Json json;
  json["robot"] = {{"name", model.name()},
                   {"footprint_m", footprint(model)},
                   {"joint_names", model.joint_names()},
                   {"joint_rate_limit", joint_array(limits.velocity)},
                   {"base_forward", limits.base_forward},
                   {"base_reverse", limits.base_reverse},
                   {"base_yaw_rate", limits.base_yaw_rate},
                   {"drawing", json_of(model.drawing())}};
  Json leaf = Json::array(), world = Json::array();
  for (const Box& box : mechanism.leaf) leaf.push_back(json_of(box));
  for (const Box& box : mechanism.world) world.push_back(json_of(box));
  json["mechanism"] = {{"name", mechanism.name},
                       {"type", mechanism.kind == JointKind::Hinge ? "hinge" : "slide"},
                       {"axis", array_of(mechanism.axis)},
                       {"point", array_of(mechanism.point)},
                       {"travel", mechanism.travel},
                       {"handle", array_of(mechanism.handle.position)},
                       {"normal", array_of(mechanism.handle.normal)},
                       {"handle_kind", name_of(mechanism.handle.kind)},
                       {"handle_bar", array_of(mechanism.handle.bar)},
                       {"handle_standoff", mechanism.handle.standoff},
                       {"handle_thickness", mechanism.handle.thickness},
                       {"handle_length", mechanism.handle.length},
                       {"leaf", leaf},
                       {"world", world}};
  const bool hinge = mechanism.kind == JointKind::Hinge;
  json["mission"] = {{"goal", hinge ? mission.goal.opening_angle : mission.goal.opening_length},
                     {"to_the_stop", mission.goal.to_the_stop},
                     {"force_limit_N", mission.limits.force},
                     {"abort_force_N", mission.limits.abort_force},
                     {"time_limit_s", mission.limits.time},
                     {"period_s", mission.period}};
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace ajar
