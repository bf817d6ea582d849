#include "urdf_description.hpp"

#include <console_bridge/console.h>
#include <urdf_parser/urdf_parser.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "ajar/core/error.hpp"
#include "robot_config.hpp"

namespace ajar {
namespace {

// Keeps what the parser would print, so that it ends up in the message of the exception.
class ErrorCollector : public console_bridge::OutputHandler {
 public:
  ErrorCollector() { console_bridge::useOutputHandler(this); }
  ~ErrorCollector() override { console_bridge::restorePreviousOutputHandler(); }
  ErrorCollector(const ErrorCollector&) = delete;
  ErrorCollector& operator=(const ErrorCollector&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char*, int) override {
    if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR && first_.empty()) {
      first_ = text;
      std::replace(first_.begin(), first_.end(), '\n', ' ');
    }
  }
  [[nodiscard]] const std::string& first() const { return first_; }

 private:
  std::string first_;
};

Pose to_eigen(const urdf::Pose& pose) {
  Pose X = Pose::Identity();
  X.linear() =
      Eigen::Quaterniond(pose.rotation.w, pose.rotation.x, pose.rotation.y, pose.rotation.z).normalized().toRotationMatrix();
  X.translation() = Vector3d(pose.position.x, pose.position.y, pose.position.z);
  return X;
}

// The parser keeps no line numbers; names of links are unique, so the text tells them.
int line_of_link(const std::string& text, const std::string& name) {
  for (std::size_t at = text.find("<link"); at != std::string::npos; at = text.find("<link", at + 1)) {
    const std::string tag = text.substr(at, text.find('>', at) - at);
    if (tag.find("\"" + name + "\"") != std::string::npos || tag.find("'" + name + "'") != std::string::npos) {
      return 1 + static_cast<int>(std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n'));
    }
  }
  return 0;
}

UrdfDescription::Motion motion_of(const urdf::Joint& joint) {
  switch (joint.type) {
    case urdf::Joint::FIXED: return UrdfDescription::Motion::Fixed;
    case urdf::Joint::REVOLUTE: return UrdfDescription::Motion::Revolute;
    case urdf::Joint::CONTINUOUS: return UrdfDescription::Motion::Continuous;
    case urdf::Joint::PRISMATIC: return UrdfDescription::Motion::Prismatic;
    default: return UrdfDescription::Motion::Other;
  }
}

void read_joint(const urdf::Joint& joint, UrdfDescription::Link& link) {
  link.joint = joint.name;
  link.motion = motion_of(joint);
  link.X_PL = to_eigen(joint.parent_to_joint_origin_transform);
  const Vector3d axis(joint.axis.x, joint.axis.y, joint.axis.z);
  if (axis.norm() > 0.0) link.axis = axis.normalized();
  if (joint.limits) {
    link.lower = joint.limits->lower;
    link.upper = joint.limits->upper;
    link.velocity = joint.limits->velocity;
    link.effort = joint.limits->effort;
  }
}

void read_collisions(const urdf::Link& source, UrdfDescription::Link& link) {
  for (const auto& collision : source.collision_array) {
    if (!collision || !collision->geometry) {
      continue;
    }
    CollisionShape shape;
    shape.link = source.name;
    shape.pose_in_joint = to_eigen(collision->origin);
    if (const auto* box = dynamic_cast<const urdf::Box*>(collision->geometry.get())) {
      shape.kind = CollisionShape::Kind::Box;
      shape.half_extents = 0.5 * Vector3d(box->dim.x, box->dim.y, box->dim.z);
    } else if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(collision->geometry.get())) {
      shape.radius = cylinder->radius;
      shape.half_length = 0.5 * cylinder->length;
    } else if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(collision->geometry.get())) {
      shape.radius = sphere->radius;
    } else {
      link.has_mesh = true;
      continue;
    }
    link.shapes.push_back(shape);
  }
}

void read_visuals(const urdf::Link& source, UrdfDescription::Link& link) {
  for (const auto& visual : source.visual_array) {
    if (!visual || !visual->geometry) {
      continue;
    }
    DrawnShape shape;
    shape.link = source.name;
    shape.pose_in_joint = to_eigen(visual->origin);
    if (const auto* box = dynamic_cast<const urdf::Box*>(visual->geometry.get())) {
      shape.size = Vector3d(box->dim.x, box->dim.y, box->dim.z);
    } else if (const auto* cylinder = dynamic_cast<const urdf::Cylinder*>(visual->geometry.get())) {
      shape.kind = DrawnShape::Kind::Cylinder;
      shape.size = Vector3d(cylinder->radius, cylinder->radius, cylinder->length);
    } else if (const auto* sphere = dynamic_cast<const urdf::Sphere*>(visual->geometry.get())) {
      shape.kind = DrawnShape::Kind::Sphere;
      shape.size = Vector3d(sphere->radius, sphere->radius, 0.0);
    } else {
      link.has_visual_mesh = true;
      continue;
    }
    if (visual->material) {
      const urdf::Color& color = visual->material->color;
      shape.rgba = {double{color.r}, double{color.g}, double{color.b}, double{color.a}};
    }
    link.visuals.push_back(shape);
  }
}

void check_link(const UrdfDescription& description, const UrdfDescription::Link& link) {
  const std::string where = description.where(link);
  if (!(link.mass >= 0.0) || !std::isfinite(link.mass)) {
    throw ModelError(where + ": mass: " + std::to_string(link.mass) + "; allowed: a finite number >= 0 [kg]");
  }
  const bool finite = link.com.allFinite() && link.X_PL.matrix().allFinite() && std::isfinite(link.lower) &&
                      std::isfinite(link.upper) && std::isfinite(link.velocity) && std::isfinite(link.effort);
  if (!finite) {
    throw ModelError(where + ": a value is not finite; allowed: finite numbers");
  }
  for (const CollisionShape& shape : link.shapes) {
    const bool box = shape.kind == CollisionShape::Kind::Box;
    const bool good =
        box ? shape.half_extents.minCoeff() > 0.0 && shape.half_extents.allFinite()
            : shape.radius > 0.0 && shape.half_length >= 0.0 && std::isfinite(shape.radius + shape.half_length);
    if (!good || !shape.pose_in_joint.matrix().allFinite()) {
      throw ModelError(where + ": collision: sizes must be positive and finite, the origin finite");
    }
  }
}

void append(const urdf::Link& source, int parent, const std::string& text, UrdfDescription& description) {
  UrdfDescription::Link link;
  link.name = source.name;
  link.parent = parent;
  link.line = line_of_link(text, source.name);
  if (source.parent_joint) {
    read_joint(*source.parent_joint, link);
  }
  if (source.inertial) {
    link.mass = source.inertial->mass;
    link.com = to_eigen(source.inertial->origin).translation();
  }
  read_collisions(source, link);
  read_visuals(source, link);
  check_link(description, link);
  const int index = static_cast<int>(description.links.size());
  description.links.push_back(std::move(link));
  for (const auto& child : source.child_links) {
    append(*child, index, text, description);
  }
}

}  // namespace

int UrdfDescription::find_link(const std::string& name) const noexcept {
  const auto found = std::find_if(links.begin(), links.end(), [&](const Link& link) { return link.name == name; });
  return found == links.end() ? -1 : static_cast<int>(found - links.begin());
}

int UrdfDescription::find_joint(const std::string& name) const noexcept {
  const auto found =
      std::find_if(links.begin(), links.end(), [&](const Link& link) { return link.parent >= 0 && link.joint == name; });
  return found == links.end() ? -1 : static_cast<int>(found - links.begin());
}

bool UrdfDescription::descends(int link, int ancestor) const noexcept {
  for (; link >= 0; link = links[static_cast<std::size_t>(link)].parent) {
    if (link == ancestor) {
      return true;
    }
  }
  return false;
}

std::string UrdfDescription::where(const Link& link) const {
  std::string text = file;
  if (link.line > 0) {
    text.append(":").append(std::to_string(link.line));
  }
  return text.append(": link ").append(link.name);
}

UrdfDescription read_urdf(const std::filesystem::path& path) {
  const std::string text = read_text(path);
  urdf::ModelInterfaceSharedPtr parsed;
  std::string reason;
  {
    const ErrorCollector errors;
    parsed = urdf::parseURDF(text);
    reason = errors.first();
  }
  if (!parsed || !parsed->getRoot()) {
    throw ModelError(path.string() + ": not a URDF: " + (reason.empty() ? "no root link" : reason));
  }
  UrdfDescription description;
  description.file = path.string();
  append(*parsed->getRoot(), -1, text, description);
  return description;
}

}  // namespace ajar
