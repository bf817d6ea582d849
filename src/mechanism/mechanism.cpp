#include "ajar/mechanism/mechanism.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string_view>

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

constexpr double kGravity = 9.81;  // [m/s²], the value that the door tables were computed with
// A handle nearer to its axis than this moves too little to be pulled and its curvature has no bound [m].
constexpr double kMinHandleRadius = 0.01;
// Unit vectors typed with six digits pass, everything else is a mistake [-].
constexpr double kUnitTolerance = 1e-4;

double finite_or_zero(double value) noexcept { return std::isfinite(value) ? value : 0.0; }

// Energy gained per unit of q by lifting the centre of mass.
double gravity_force(const Mechanism& mechanism, double q) noexcept {
  const double weight = mechanism.gravity_share * mechanism.mass * kGravity;
  if (mechanism.kind == JointKind::Slide) return weight * mechanism.axis.z();
  const Vector3d arm = exp_so3(mechanism.axis * q) * (mechanism.com - mechanism.point);
  return weight * mechanism.axis.cross(arm).z();
}

double seal_force(const Seal& seal, double q) noexcept {
  if (seal.range <= 0.0) return 0.0;
  return seal.force * std::clamp(1.0 - q / seal.range, 0.0, 1.0);
}

class Checker {
 public:
  explicit Checker(const std::string& name) : name_(name) {}

  void number(std::string_view field, double value, bool allowed, std::string_view rule) const {
    if (std::isfinite(value) && allowed) return;
    std::ostringstream text;
    text << value;
    fail(field, text.str(), rule);
  }
  void positive(std::string_view field, double value) const { number(field, value, value > 0.0, "> 0"); }
  void not_negative(std::string_view field, double value) const { number(field, value, value >= 0.0, ">= 0"); }
  void finite(std::string_view field, double value) const { number(field, value, true, "a finite number"); }
  void finite(std::string_view field, const Vector3d& v) const {
    if (!v.allFinite()) fail(field, text_of(v), "finite numbers");
  }
  void unit(std::string_view field, const Vector3d& v) const {
    if (!v.allFinite() || std::abs(v.norm() - 1.0) > kUnitTolerance) fail(field, text_of(v), "a vector of length 1");
  }
  [[noreturn]] void fail(std::string_view field, const std::string& value, std::string_view rule) const {
    std::ostringstream text;
    text << "mechanism '" << name_ << "': " << field << ": " << value << ": allowed: " << rule;
    throw ConfigError(text.str());
  }
  static std::string text_of(const Vector3d& v) {
    std::ostringstream text;
    text << '(' << v.x() << ", " << v.y() << ", " << v.z() << ')';
    return text.str();
  }

 private:
  const std::string& name_;
};

void check_dynamics(const Mechanism& m, const Checker& check) {
  check.positive("travel", m.travel);
  check.positive("stop_time_constant", m.stop_time_constant);
  check.positive("mass", m.mass);
  check.positive("inertia", m.inertia);
  check.finite("com", m.com);
  check.finite("gravity_share", m.gravity_share);
  check.not_negative("armature", m.armature);
  check.not_negative("coulomb", m.coulomb);
  check.number("breakaway", m.breakaway, m.breakaway >= 1.0, ">= 1");
  check.not_negative("viscous", m.viscous);
  check.not_negative("stiffness", m.stiffness);
  check.finite("spring_reference", m.spring_reference);
  check.finite("constant_closing", m.constant_closing);
  check.not_negative("closer.moment", m.closer.moment);
  check.not_negative("closer.stiffness", m.closer.stiffness);
  check.not_negative("closer.closing_damping", m.closer.closing_damping);
  check.not_negative("seal.force", m.seal.force);
  check.not_negative("seal.range", m.seal.range);
}

void check_handle(const Mechanism& m, const Checker& check) {
  check.finite("handle.position", m.handle.position);
  check.unit("handle.normal", m.handle.normal);
  if (m.handle.kind == HandleKind::Bar) check.unit("handle.bar", m.handle.bar);
  check.not_negative("handle.standoff", m.handle.standoff);
  check.not_negative("handle.thickness", m.handle.thickness);
  check.not_negative("handle.length", m.handle.length);
  if (m.kind == JointKind::Hinge) {
    const double radius = m.axis.cross(m.handle.position - m.point).norm();
    check.number("distance handle - axis", radius, radius >= kMinHandleRadius, ">= 0.01 m");
  }
  for (const Box& box : m.world) {
    const Vector3d p = box.pose.inverse() * m.handle.position;
    if ((p.cwiseAbs() - box.half_extents).maxCoeff() < 0.0) {
      check.fail("handle.position", Checker::text_of(m.handle.position), "outside of walls and furniture");
    }
  }
}

void check_boxes(std::string_view field, const std::vector<Box>& boxes, const Checker& check) {
  for (const Box& box : boxes) {
    if (!box.half_extents.allFinite() || box.half_extents.minCoeff() <= 0.0 || !box.pose.matrix().allFinite()) {
      check.fail(field, Checker::text_of(box.half_extents), "boxes with finite pose and half extents > 0");
    }
  }
}

}  // namespace

void Mechanism::validate() const {
  const Checker check(name);
  check.unit("axis", axis);
  check.finite("point", point);
  check_dynamics(*this, check);
  check_boxes("leaf", leaf, check);
  check_boxes("world", world, check);
  check_handle(*this, check);
}

Pose leaf_motion(const Mechanism& mechanism, double q) noexcept {
  const double opening = finite_or_zero(q);
  Pose motion = Pose::Identity();
  if (mechanism.kind == JointKind::Slide) {
    motion.translation() = mechanism.axis * opening;
    return motion;
  }
  motion.linear() = exp_so3(mechanism.axis * opening);
  motion.translation() = mechanism.point - motion.linear() * mechanism.point;
  return motion;
}

HandleMotion handle_motion(const Mechanism& mechanism, double q) noexcept {
  HandleMotion out;
  out.position = leaf_motion(mechanism, q) * mechanism.handle.position;
  if (mechanism.kind == JointKind::Slide) {
    out.direction = mechanism.axis;
    out.curvature = Vector3d::Zero();
    out.radius = 1.0;
    return out;
  }
  const Vector3d velocity = mechanism.axis.cross(out.position - mechanism.point);
  out.radius = std::max(velocity.norm(), kMinHandleRadius);
  out.direction = velocity / out.radius;
  out.curvature = mechanism.axis / out.radius;
  return out;
}

double resisting_force(const Mechanism& mechanism, double q, double dq) noexcept {
  const double x = finite_or_zero(q);
  const double v = finite_or_zero(dq);
  const double damping = mechanism.viscous + (v < 0.0 ? mechanism.closer.closing_damping : 0.0);
  return damping * v + mechanism.stiffness * (x - mechanism.spring_reference) + mechanism.constant_closing +
         mechanism.closer.moment + mechanism.closer.stiffness * x + seal_force(mechanism.seal, x) +
         gravity_force(mechanism, x);
}

double handle_force_needed(const Mechanism& mechanism, double q) noexcept {
  // At the closed end the mechanism rests and its friction must first be broken; beyond it slides.
  const double friction = mechanism.coulomb * (q > 0.0 ? 1.0 : mechanism.breakaway);
  return (resisting_force(mechanism, q, 0.0) + friction) / handle_motion(mechanism, q).radius;
}

}  // namespace ajar
