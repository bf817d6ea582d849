#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "ajar/core/error.hpp"
#include "robot_config.hpp"
#include "robot_impl.hpp"
#include "urdf_description.hpp"

namespace ajar {
namespace {

// Stands for "no limit" of a continuous joint: finite, so that differences of limits stay finite.
constexpr double kNoLimit = 1e3;

const UrdfDescription::Link& link_at(const UrdfDescription& urdf, int index) {
  return urdf.links[static_cast<std::size_t>(index)];
}

std::vector<std::string> link_names(const UrdfDescription& urdf) {
  std::vector<std::string> names;
  names.reserve(urdf.links.size());
  for (const auto& link : urdf.links) {
    names.push_back(link.name);
  }
  return names;
}

std::vector<std::string> movable_joints(const UrdfDescription& urdf) {
  std::vector<std::string> names;
  for (const auto& link : urdf.links) {
    if (link.motion != UrdfDescription::Motion::Fixed) {
      names.push_back(link.joint);
    }
  }
  return names;
}

int required_link(const UrdfDescription& urdf, const RobotConfig& config, const std::string& key, const std::string& name) {
  const int link = urdf.find_link(name);
  if (link < 0) {
    throw ModelError(config.where(key) + ": " + name + "; allowed: a link of " + urdf.file + ": " +
                     join_names(link_names(urdf)));
  }
  return link;
}

// Links carried by the arm joints, from the base to the hand.
std::vector<int> arm_links(const UrdfDescription& urdf, const RobotConfig& config, int base, int hand) {
  std::vector<int> links;
  int below = base;
  for (const std::string& joint : config.joints) {
    const int link = urdf.find_joint(joint);
    if (link < 0 || link_at(urdf, link).motion == UrdfDescription::Motion::Fixed ||
        link_at(urdf, link).motion == UrdfDescription::Motion::Other) {
      throw ModelError(config.where("arm.joints") + ": " + joint +
                       "; allowed: revolute, continuous and prismatic joints of " + urdf.file + ": " +
                       join_names(movable_joints(urdf)));
    }
    const bool in_order = links.empty() || (link != below && urdf.descends(link, below));
    if (!in_order || !urdf.descends(hand, link) || urdf.descends(base, link)) {
      throw ModelError(config.where("arm.joints") + ": " + joint +
                       "; allowed: joints between base.frame and hand.frame, from the base to the hand");
    }
    links.push_back(link);
    below = link;
  }
  return links;
}

struct Placement {
  int joint = -1;             // arm joint that moves the link, -1 = the base
  Pose X = Pose::Identity();  // in that joint's frame or in the base frame
};

// Where each link sits, all joints but the arm's at zero.
std::vector<Placement> place_links(const UrdfDescription& urdf, const std::vector<int>& arm, int base) {
  std::vector<Placement> placements(urdf.links.size());
  for (std::size_t i = 0; i < urdf.links.size(); ++i) {
    const auto& link = urdf.links[i];
    const auto joint = std::find(arm.begin(), arm.end(), static_cast<int>(i));
    if (joint != arm.end()) {
      placements[i].joint = static_cast<int>(joint - arm.begin());
    } else if (link.parent >= 0) {
      const Placement& parent = placements[static_cast<std::size_t>(link.parent)];
      placements[i] = {parent.joint, parent.X * link.X_PL};
    }
  }
  const Pose X_BR = placements[static_cast<std::size_t>(base)].X.inverse();
  for (Placement& placement : placements) {
    if (placement.joint < 0) {
      placement.X = X_BR * placement.X;
    }
  }
  return placements;
}

void collect_shapes(const UrdfDescription& urdf, const RobotConfig& config, const std::vector<Placement>& placements,
                    RobotParts& parts) {
  for (std::size_t i = 0; i < urdf.links.size(); ++i) {
    if (urdf.links[i].has_mesh && !config.ignore_meshes) {
      throw ModelError(urdf.where(urdf.links[i]) +
                       ": collision: a mesh; allowed: box, cylinder, sphere, or collision.meshes = \"ignore\" in " +
                       config.file);
    }
    for (CollisionShape shape : urdf.links[i].shapes) {
      shape.joint = placements[i].joint;
      shape.pose_in_joint = placements[i].X * shape.pose_in_joint;
      parts.shapes.push_back(std::move(shape));
    }
  }
  for (const auto& pair : config.never_checked) {
    required_link(urdf, config, "collision.never_checked", pair[0]);
    required_link(urdf, config, "collision.never_checked", pair[1]);
    for (std::size_t a = 0; a < parts.shapes.size(); ++a) {
      for (std::size_t b = 0; b < parts.shapes.size(); ++b) {
        if (parts.shapes[a].link == pair[0] && parts.shapes[b].link == pair[1]) {
          parts.unchecked_pairs.push_back({static_cast<int>(a), static_cast<int>(b)});
        }
      }
    }
  }
}

// The shape that stands for a mesh: the capsule or box that is checked for contact.
DrawnShape drawn(const CollisionShape& collision) {
  DrawnShape shape;
  shape.link = collision.link;
  shape.pose_in_joint = collision.pose_in_joint;
  if (collision.kind == CollisionShape::Kind::Box) {
    shape.size = 2.0 * collision.half_extents;
  } else {
    shape.kind = DrawnShape::Kind::Capsule;
    shape.size = Vector3d(collision.radius, collision.radius, 2.0 * collision.half_length);
  }
  return shape;
}

void collect_drawing(const UrdfDescription& urdf, const std::vector<int>& arm, const std::vector<Placement>& placements,
                     RobotDrawing& drawing) {
  for (const int index : arm) {
    const auto& link = link_at(urdf, index);
    drawing.joints.push_back({link.motion == UrdfDescription::Motion::Prismatic, link.axis,
                              placements[static_cast<std::size_t>(link.parent)].X * link.X_PL});
  }
  for (std::size_t i = 0; i < urdf.links.size(); ++i) {
    const auto& link = urdf.links[i];
    std::vector<DrawnShape> shapes = link.visuals;
    if (link.has_visual_mesh) {
      for (const CollisionShape& collision : link.shapes) shapes.push_back(drawn(collision));
    }
    for (DrawnShape& shape : shapes) {
      shape.joint = placements[i].joint;
      shape.pose_in_joint = placements[i].X * shape.pose_in_joint;
      drawing.shapes.push_back(std::move(shape));
    }
  }
}

// Mass and centre of everything that hangs on the sensor, in the sensor's frame.
void weigh_tool(const UrdfDescription& urdf, const std::vector<Placement>& placements, int sensor, RobotParts& parts) {
  const Pose X_FJ = placements[static_cast<std::size_t>(sensor)].X.inverse();
  Vector3d moment = Vector3d::Zero();
  for (std::size_t i = 0; i < urdf.links.size(); ++i) {
    const auto& link = urdf.links[i];
    if (link.mass > 0.0 && urdf.descends(static_cast<int>(i), sensor)) {
      parts.tool_mass += link.mass;
      moment += link.mass * (X_FJ * placements[i].X * link.com);
    }
  }
  parts.tool_com = parts.tool_mass > 0.0 ? Vector3d(moment / parts.tool_mass) : Vector3d(Vector3d::Zero());
}

void set_joint_limits(const UrdfDescription& urdf, const RobotConfig& config, const std::vector<int>& arm,
                      RobotParts& parts) {
  const auto n = static_cast<Eigen::Index>(arm.size());
  RobotLimits& limits = parts.limits;
  for (JointVector* v : {&limits.position_lower, &limits.position_upper, &limits.velocity, &limits.acceleration,
                         &limits.effort, &parts.home}) {
    v->resize(n);
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto k = static_cast<std::size_t>(i);
    const auto& link = link_at(urdf, arm[k]);
    const bool continuous = link.motion == UrdfDescription::Motion::Continuous;
    limits.position_lower[i] = continuous ? -kNoLimit : link.lower;
    limits.position_upper[i] = continuous ? kNoLimit : link.upper;
    limits.velocity[i] = config.velocity.empty() ? link.velocity : config.velocity[k];
    limits.acceleration[i] = config.acceleration[k];
    limits.effort[i] = link.effort;
    parts.home[i] = config.home[k];
    const double range = limits.position_upper[i] - limits.position_lower[i];
    const bool turns = link.motion != UrdfDescription::Motion::Prismatic;
    parts.free_turning.push_back(turns && range >= 2.0 * std::numbers::pi - 1e-6);
    if (!(range > 0.0)) {
      throw ModelError(urdf.where(link) + ": joint " + link.joint + ": limits [" + std::to_string(link.lower) + ", " +
                       std::to_string(link.upper) + "]; allowed: lower < upper");
    }
    if (!(limits.velocity[i] > 0.0)) {
      throw ModelError(urdf.where(link) + ": joint " + link.joint + ": velocity " + std::to_string(limits.velocity[i]) +
                       "; allowed: > 0 here or in arm.velocity of " + config.file);
    }
    if (parts.home[i] < limits.position_lower[i] || parts.home[i] > limits.position_upper[i]) {
      throw ModelError(config.where("arm.home") + ": " + std::to_string(parts.home[i]) + " for " + link.joint +
                       "; allowed: " + std::to_string(limits.position_lower[i]) + " to " +
                       std::to_string(limits.position_upper[i]));
    }
  }
}

}  // namespace

RobotParts assemble_robot(const std::filesystem::path& urdf_path, const std::filesystem::path& toml_path) {
  const UrdfDescription urdf = read_urdf(urdf_path);
  const RobotConfig config = read_robot_config(toml_path);
  const int base = required_link(urdf, config, "base.frame", config.base_frame);
  const int hand = required_link(urdf, config, "hand.frame", config.hand_frame);
  const int sensor = required_link(urdf, config, "hand.sensor_frame", config.sensor_frame);
  const std::vector<int> arm = arm_links(urdf, config, base, hand);
  const std::vector<Placement> placements = place_links(urdf, arm, base);
  if (placements[static_cast<std::size_t>(sensor)].joint != static_cast<int>(arm.size()) - 1) {
    throw ModelError(config.where("hand.sensor_frame") + ": " + config.sensor_frame +
                     "; allowed: a link beyond the last arm joint");
  }

  RobotParts parts;
  parts.name = config.name;
  parts.urdf = urdf_path;
  parts.base_type = config.base_type;
  parts.wheel_radius = config.wheel_radius;
  parts.wheel_track = config.wheel_track;
  parts.limits = config.limits;
  parts.gripper_stroke = config.gripper_stroke;
  parts.names = {config.joints, config.base_frame, config.hand_frame, config.sensor_frame};
  set_joint_limits(urdf, config, arm, parts);
  collect_shapes(urdf, config, placements, parts);
  weigh_tool(urdf, placements, sensor, parts);
  collect_drawing(urdf, arm, placements, parts.drawing);
  parts.drawing.hand_in_last = placements[static_cast<std::size_t>(hand)].X;
  return parts;
}

}  // namespace ajar
