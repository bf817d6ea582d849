#include "ajar/mechanism/builders.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string_view>

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"
#include "closers.hpp"

namespace ajar {
namespace {

constexpr double kHalfPi = std::numbers::pi / 2.0;

// Sizes of the surroundings [m]. Leaf 40 mm (Swedish interior door), front 20 mm (cabinet board).
constexpr double kLeafThickness = 0.04;
constexpr double kFrontThickness = 0.02;
constexpr double kLeafBeyondHandle = 0.05;  // backset of a usual lock, 50-65 mm
constexpr double kAxisGap = 0.01;           // axis to leaf edge
constexpr double kWallFromAxis = 0.03;      // axis to the jamb on the hinge side
constexpr double kWallFromHandle = 0.09;    // handle to the strike jamb
constexpr double kWallWidth = 1.6;
constexpr double kWallThickness = 0.10;
constexpr double kLeafBottom = 0.02;
constexpr double kLeafTop = 2.0;
constexpr double kWallHeight = 2.1;
constexpr double kFlapHalfWidth = 0.28;  // 60 cm built-in oven less its gaps
constexpr double kBodyHalfWidth = 0.3;   // 60 cm cabinet
constexpr double kBodyDepth = 0.6;
constexpr double kBodyGap = 0.01;    // leaf to cabinet
constexpr double kBodyHeight = 0.9;  // kitchen worktop
// Tilts up to a few degrees are doors that hang askew: they keep their full height.
constexpr double kAskew = 0.1;
// Within this of horizontal the side says above or below, not left or right [rad].
constexpr double kHorizontal = 0.01;

// EN 1154 by size: closing moment (middle of the band at 0-4 deg) and largest opening moment [N m].
struct CloserSize {
  double closing, opening;
};
constexpr std::array<CloserSize, 7> kCloserSizes{
    {{11.0, 26.0}, {15.5, 36.0}, {22.0, 47.0}, {31.5, 62.0}, {45.5, 83.0}, {70.5, 134.0}, {113.5, 215.0}}};

[[noreturn]] void fail(std::string_view field, double value, std::string_view rule) {
  std::ostringstream text;
  text << "mechanism." << field << ": " << value << ": allowed: " << rule;
  throw ConfigError(text.str());
}

void require(bool allowed, std::string_view field, double value, std::string_view rule) {
  if (!allowed || !std::isfinite(value)) fail(field, value, rule);
}

void check_config(const MechanismConfig& c) {
  if (c.type != "hinge" && c.type != "slide") {
    throw ConfigError("mechanism.type: \"" + c.type + "\": allowed: hinge, slide");
  }
  require(c.radius >= 0.05 && c.radius <= 3.0, "radius", c.radius, "0.05 .. 3 m");
  require(std::abs(c.tilt) <= kHalfPi + kHorizontal, "tilt", c.tilt, "-pi/2 .. pi/2");
  require(c.travel > 0.0, "travel", c.travel, "> 0");
  if (c.type == "hinge") require(c.travel <= std::numbers::pi, "travel", c.travel, "0 .. pi for a hinge");
  const double length = c.slide_direction.norm();
  require(length > 1e-6, "slide_direction (length)", length, "a finite vector that is not zero");
  require(c.at.allFinite(), "at", c.at.norm(), "finite numbers");
  require(true, "yaw", c.yaw, "a finite number");
  require(c.handle_height > 0.0 && c.handle_height < 2.5, "handle_height", c.handle_height, "0 .. 2.5 m");
  require(c.standoff >= 0.0, "standoff", c.standoff, ">= 0");
  require(c.handle_thickness >= 0.0, "handle_thickness", c.handle_thickness, ">= 0");
  require(c.handle_length >= 0.0, "handle_length", c.handle_length, ">= 0");
  require(c.mass > 0.0, "mass", c.mass, "> 0");
  if (c.inertia) require(*c.inertia > 0.0, "inertia", *c.inertia, "> 0");
  require(c.coulomb >= 0.0, "coulomb", c.coulomb, ">= 0");
  require(c.breakaway >= 1.0, "breakaway", c.breakaway, ">= 1");
  require(c.viscous >= 0.0, "viscous", c.viscous, ">= 0");
  require(c.stiffness >= 0.0, "stiffness", c.stiffness, ">= 0");
  require(true, "spring_reference", c.spring_reference, "a finite number");
  require(true, "gravity_share", c.gravity_share, "a finite number");
  require(c.closer_size >= 0 && c.closer_size <= 7, "closer_size", c.closer_size, "0 (none) .. 7");
  if (c.closer_size > 0 && c.closer.moment != 0.0) {
    fail("closer.moment", c.closer.moment, "0 when closer_size is given, or closer_size 0");
  }
  require(c.front_width > 0.0, "front_width", c.front_width, "> 0");
  require(c.front_height > 0.0, "front_height", c.front_height, "> 0");
}

// Closing moment at rest and its growth to the largest opening moment at 90 deg; closing damping 40-120 N m s/rad
// over the sizes, as the closers of the door table have. (docs/equations.md#closer)
Closer closer_of_size(int size) {
  const CloserSize& row = kCloserSizes[static_cast<std::size_t>(size - 1)];
  return {row.closing, (row.opening - row.closing) / kHalfPi, closing_damping_of_size(size)};
}

// What the geometry of one mechanism is made of; L = leaf frame.
struct Layout {
  Pose X_WL = Pose::Identity();
  Vector3d handle_foot = Vector3d::Zero();  // L
};

Box box_between(const Layout& layout, const Vector3d& lower, const Vector3d& upper) {
  Box box;
  box.pose = layout.X_WL * Eigen::Translation3d(0.5 * (lower + upper));
  box.half_extents = 0.5 * (upper - lower);
  return box;
}

// A hinge in the wall plane: which way the axis lies from the handle, and how the axis line runs. L axes.
struct HingeFrame {
  Vector3d to_axis;  // unit
  Vector3d line;     // unit
  bool horizontal;
};

HingeFrame hinge_frame(const MechanismConfig& config) {
  const bool horizontal = std::abs(config.tilt) > kHalfPi - kHorizontal;
  // +pi/2 and -pi/2 name the same line; the second one puts Right below the handle.
  const double tilt = horizontal && config.tilt > 0.0 ? config.tilt - std::numbers::pi : config.tilt;
  const Matrix3d R = exp_so3(-Vector3d::UnitY() * tilt);
  const double h = config.side == Side::Right ? 1.0 : -1.0;
  return {R * Vector3d(h, 0.0, 0.0), R * Vector3d(0.0, 0.0, h), horizontal};
}

void add_door_walls(const MechanismConfig& config, const Layout& layout, Mechanism& out) {
  const double h = config.side == Side::Right ? 1.0 : -1.0;
  const std::array<Vector2d, 2> spans{
      Vector2d(h * (config.radius + kWallFromAxis), h * (config.radius + kWallFromAxis + kWallWidth)),
      Vector2d(-h * kWallFromHandle, -h * (kWallFromHandle + kWallWidth))};
  for (const Vector2d& span : spans) {
    out.world.push_back(box_between(layout, {span.minCoeff(), 0.0, 0.0}, {span.maxCoeff(), kWallThickness, kWallHeight}));
  }
  const double hinge = h * (config.radius + kWallFromAxis);
  const double strike = -h * kWallFromHandle;
  out.doorway = Doorway{layout.X_WL * Vector3d(std::min(hinge, strike), 0.0, 0.0),
                        layout.X_WL * Vector3d(std::max(hinge, strike), 0.0, 0.0)};
}

// The body of an oven or a cabinet behind a front whose back is at y = back.
void add_body(const MechanismConfig& config, const Layout& layout, const Vector3d& size, Mechanism& out) {
  if (!config.walls) return;
  const double front = size.y() + kBodyGap;
  out.world.push_back(box_between(layout, {-size.x(), front, 0.0}, {size.x(), front + kBodyDepth, size.z()}));
}

// A leaf whose axis is not vertical: a flap of 0.56 m along the axis about the handle, on a closed body.
void add_flap(const MechanismConfig& config, const Layout& layout, const HingeFrame& frame, Mechanism& out) {
  Matrix3d R_LB;  // box axes: from axis to handle, into the wall, along the axis line
  R_LB.col(0) = -frame.to_axis;
  R_LB.col(1) = Vector3d::UnitY();
  R_LB.col(2) = R_LB.col(0).cross(R_LB.col(1));
  const double half_width = 0.5 * (config.radius + kLeafBeyondHandle - kAxisGap);
  Box leaf;
  leaf.pose.linear() = R_LB;
  leaf.pose.translation() =
      layout.handle_foot + frame.to_axis * (half_width - kLeafBeyondHandle) + Vector3d(0.0, 0.5 * kLeafThickness, 0.0);
  leaf.half_extents = {half_width, 0.5 * kLeafThickness, kFlapHalfWidth};
  leaf.pose = layout.X_WL * leaf.pose;
  out.leaf.push_back(leaf);
  const double sideways = std::abs(frame.to_axis.x()) * config.radius;
  const double top = config.handle_height + std::max(0.0, frame.to_axis.z()) * config.radius + kLeafBeyondHandle;
  add_body(config, layout, {kBodyHalfWidth + sideways, kLeafThickness, top + 0.05}, out);
}

void add_door_leaf(const MechanismConfig& config, const Layout& layout, Mechanism& out) {
  const double h = config.side == Side::Right ? 1.0 : -1.0;
  const double hinge_edge = h * (config.radius - kAxisGap);
  const double latch_edge = -h * kLeafBeyondHandle;
  const double width = std::abs(hinge_edge - latch_edge);
  const double bottom = kLeafBottom + width * std::sin(std::abs(config.tilt));
  Box leaf = box_between(layout, {std::min(hinge_edge, latch_edge), 0.0, bottom},
                         {std::max(hinge_edge, latch_edge), kLeafThickness, kLeafTop});
  const Vector3d pivot = layout.X_WL * layout.handle_foot;
  const Matrix3d R = exp_so3(layout.X_WL.linear() * (-Vector3d::UnitY()) * config.tilt);
  leaf.pose.pretranslate(-pivot).prerotate(R).pretranslate(pivot);
  out.leaf.push_back(leaf);
  if (config.walls) add_door_walls(config, layout, out);
}

// Moment of inertia of a uniform slab about the hinge: m ((w² + t²) / 12 + d²). (docs/equations.md#slab)
double slab_inertia(const Mechanism& mechanism, double width) {
  const Vector3d arm = mechanism.axis.cross(mechanism.com - mechanism.point);
  return mechanism.mass * ((width * width + kLeafThickness * kLeafThickness) / 12.0 + arm.squaredNorm());
}

void build_hinge(const MechanismConfig& config, const Layout& layout, Mechanism& out) {
  const HingeFrame frame = hinge_frame(config);
  const double sense = config.sense == Sense::Pull ? 1.0 : -1.0;
  out.kind = JointKind::Hinge;
  out.axis = layout.X_WL.linear() * (sense * frame.line);
  // Pins stand on the face towards which the leaf opens, otherwise its edge would turn into the wall.
  const double pin = config.sense == Sense::Pull ? 0.0 : kLeafThickness;
  out.point = layout.X_WL * (layout.handle_foot + config.radius * frame.to_axis + Vector3d(0.0, pin, 0.0));
  if (std::abs(config.tilt) <= kAskew) {
    add_door_leaf(config, layout, out);
  } else {
    add_flap(config, layout, frame, out);
  }
  out.com = out.leaf.front().pose.translation();
  const double width = 2.0 * out.leaf.front().half_extents.x();
  out.inertia = config.inertia.value_or(slab_inertia(out, width));
}

void build_slide(const MechanismConfig& config, const Layout& layout, Mechanism& out) {
  const Vector3d direction = config.slide_direction.normalized();
  out.kind = JointKind::Slide;
  out.axis = layout.X_WL.linear() * direction;
  out.point = layout.X_WL * layout.handle_foot;
  const double z = config.handle_height;
  // Opening along the wall makes a sliding door; towards the robot a drawer; upwards a sash of the drawer's front.
  if (std::abs(direction.x()) > 0.5) {
    const double centre = -std::copysign(0.35, direction.x());  // handle 10 cm from the edge of a 0.9 m leaf
    out.leaf.push_back(box_between(layout, {centre - 0.45, 0.0, kLeafBottom}, {centre + 0.45, kFrontThickness, kLeafTop}));
    if (config.walls) out.world.push_back(box_between(layout, {-2.5, 0.05, 0.0}, {2.5, 0.15, kWallHeight}));
  } else {
    const double w = 0.5 * config.front_width;
    const double half = 0.5 * config.front_height;
    out.leaf.push_back(box_between(layout, {-w, 0.0, z - half}, {w, kFrontThickness, z + half}));
    add_body(config, layout, {std::max(kBodyHalfWidth, w + 0.02), kFrontThickness, std::max(kBodyHeight, z + half + 0.02)},
             out);
  }
  out.com = out.leaf.front().pose.translation();
  out.inertia = config.inertia.value_or(config.mass);
}

Handle build_handle(const MechanismConfig& config, const Layout& layout) {
  Handle handle;
  handle.kind = config.handle;
  handle.position = layout.X_WL * (layout.handle_foot - Vector3d(0.0, config.standoff, 0.0));
  handle.normal = -layout.X_WL.linear().col(1);
  handle.bar = config.bar == BarOrientation::Vertical ? Vector3d::UnitZ() : Vector3d(layout.X_WL.linear().col(0));
  handle.standoff = config.standoff;
  const bool holdable = config.handle == HandleKind::Bar || config.handle == HandleKind::Knob;
  handle.thickness = holdable ? config.handle_thickness : 0.0;
  handle.length = config.handle_length;
  return handle;
}

}  // namespace

Mechanism make_mechanism(const MechanismConfig& config) {
  check_config(config);
  Layout layout;
  layout.X_WL.linear() = Eigen::AngleAxisd(config.yaw, Vector3d::UnitZ()).toRotationMatrix();
  layout.X_WL.translation() = Vector3d(config.at.x(), config.at.y(), 0.0);
  layout.handle_foot = Vector3d(0.0, 0.0, config.handle_height);

  Mechanism out;
  out.name = config.type;
  out.travel = config.travel;
  out.mass = config.mass;
  out.gravity_share = config.gravity_share;
  out.coulomb = config.coulomb;
  out.breakaway = config.breakaway;
  out.viscous = config.viscous;
  out.stiffness = config.stiffness;
  out.spring_reference = config.spring_reference;
  out.closer = config.closer_size > 0 ? closer_of_size(config.closer_size) : config.closer;
  out.seal = config.seal;
  out.handle = build_handle(config, layout);
  if (config.type == "hinge") {
    build_hinge(config, layout, out);
  } else {
    build_slide(config, layout, out);
  }
  out.validate();
  return out;
}

}  // namespace ajar
