#include "ajar/planning/passage.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ajar/model/footprint.hpp"

namespace ajar {

namespace {

// Leaf of a usual door; its pins stand on the face towards which it opens [m].
constexpr double kLeafThickness = 0.04;
// Pins stand beside the frame by a few millimetres (lists) to 3 cm (rebated) [m].
constexpr double kAxisFromFrame = 0.015;
// What frame gap and axis take from the opening besides the leaf that stands open [m].
constexpr double kOpenGap = 0.03;
// Nothing narrower is a doorway, no leaf is wider [m].
constexpr double kLeastWidth = 0.3;
constexpr double kLargestRadius = 2.0;
// An axis farther than this from the frame is a pivot's: frame and handle are seen and the radius is felt to some
// centimetres [m].
constexpr double kLeastOverhang = 0.1;
// Walls: farther out than a robot reaches, as deep as an outer wall of brick [m].
constexpr double kWallHalfWidth = 1.5;
constexpr double kWallDepth = 0.2;
constexpr double kWallHalfHeight = 1.5;
// A frame that stands out by less lies within the believed wall of a shut leaf [m].
constexpr double kFlush = 0.02;
// A hand reaches into a reveal past edges that it sees to some millimetres: of the 3 cm that it keeps from walls these are
// given up [m].
constexpr double kReachIn = 0.025;

Vector3d flat(const Vector3d& v) { return {v.x(), v.y(), 0.0}; }

// Along the wall from where the leaf shuts to its hinge, unit.
Vector3d across(const Passage& passage) { return flat(passage.hinge - passage.strike).normalized(); }

// Of the axis behind the leaf's face: pins stand on the far one, a pivot in the middle [m].
double axis_depth(bool pivot) { return pivot ? 0.5 * kLeafThickness : kLeafThickness; }

// The plane of the axis, seen from above: behind the handle, and from there towards the hinge.
struct LeafLine {
  Vector3d foot;
  Vector3d along;
};

LeafLine leaf_line(const HandleBelief& belief, const Passage& passage, bool pivot) {
  const Vector3d n = flat(belief.normal).normalized();
  const Vector3d t = Vector3d::UnitZ().cross(n);
  return {belief.position - (belief.standoff + axis_depth(pivot)) * n, t.dot(across(passage)) < 0.0 ? Vector3d(-t) : t};
}

Box wall(const Passage& passage, const Vector3d& edge, const Vector3d& outward, double overhang = 0.0) {
  Box box;
  box.pose.linear().col(1) = passage.inward;
  box.pose.linear().col(2) = Vector3d::UnitZ();
  box.pose.linear().col(0) = passage.inward.cross(Vector3d::UnitZ());
  box.pose.translation() = flat(edge) + kWallHalfWidth * outward + 0.5 * (kWallDepth - overhang) * passage.inward;
  box.pose.translation().z() = kWallHalfHeight;
  box.half_extents = Vector3d(kWallHalfWidth, 0.5 * (kWallDepth + overhang), kWallHalfHeight);
  return box;
}

}  // namespace

HingeSide likely_side(const HandleBelief& belief) noexcept {
  if (!belief.doorway) return HingeSide::Right;
  const double left = flat(belief.doorway->left - belief.position).norm();
  const double right = flat(belief.doorway->right - belief.position).norm();
  return left > right ? HingeSide::Left : HingeSide::Right;
}

std::optional<Passage> make_passage(const HandleBelief& belief, HingeSide side) {
  if (!belief.doorway || !belief.normal.allFinite()) return std::nullopt;
  const Vector3d along = flat(belief.doorway->right - belief.doorway->left);
  if (!(along.norm() > kLeastWidth) || !along.allFinite()) return std::nullopt;
  Passage passage;
  passage.inward = Vector3d::UnitZ().cross(along).normalized();
  passage.strike = side == HingeSide::Right ? belief.doorway->left : belief.doorway->right;
  passage.hinge = side == HingeSide::Right ? belief.doorway->right : belief.doorway->left;
  const Vector3d into = -flat(belief.normal);
  passage.opened = std::atan2(into.cross(passage.inward).norm(), into.dot(passage.inward));
  return passage;
}

std::optional<Passage> pivot_passage(const HandleBelief& belief, const Passage& passage, double radius) {
  const LeafLine leaf = leaf_line(belief, passage, true);
  const double depth = (belief.position - leaf.foot).norm();
  if (!(radius > depth)) return std::nullopt;
  const Vector3d axis = leaf.foot + std::sqrt(radius * radius - depth * depth) * leaf.along;
  const Vector3d e = across(passage);
  const double overhang = e.dot(flat(passage.hinge - axis)) - kAxisFromFrame;
  if (!(overhang > kLeastOverhang)) return std::nullopt;
  Passage out = passage;
  out.hinge -= overhang * e;
  out.overhang = overhang;
  return out;
}

// Where the plane of the axis meets the frame.
Vector3d passage_axis(const HandleBelief& belief, const Passage& passage) {
  const LeafLine leaf = leaf_line(belief, passage, passage.overhang > 0.0);
  const Vector3d e = across(passage);
  const double slope = std::max(0.2, leaf.along.dot(e));
  const double radius = (e.dot(flat(passage.hinge - leaf.foot)) - kAxisFromFrame) / slope;
  return leaf.foot + std::clamp(radius, 0.1, kLargestRadius) * leaf.along;
}

Vector3d passage_curvature(const HandleBelief& belief, const Passage& passage) {
  const Vector3d arm = flat(belief.position - passage_axis(belief, passage));
  const Vector3d k = Vector3d::UnitZ() / arm.norm();
  return k.cross(arm).dot(passage.inward) < 0.0 ? Vector3d(-k) : k;
}

Vector3d passage_direction(const HandleBelief& belief, const Passage& passage) {
  const Vector3d arm = flat(belief.position - passage_axis(belief, passage));
  return passage_curvature(belief, passage).cross(arm).normalized();
}

// The way back to the start is turned by what the believed radius says: over some centimetres it is known well enough.
double felt_misreading(const HandleBelief& belief, const Passage& passage, const Vector3d& direction, double arc) noexcept {
  const double back = -arc * passage_curvature(belief, passage).z();
  const Vector3d start = flat(Eigen::AngleAxisd(back, Vector3d::UnitZ()) * direction);
  const Vector3d believed = passage_direction(belief, passage);
  const double angle = std::atan2(believed.cross(start).z(), believed.dot(start));
  return std::isfinite(angle) ? std::clamp(angle, -kLargestMisreading, kLargestMisreading) : 0.0;
}

HandleBelief turned_about_handle(const HandleBelief& belief, double angle) noexcept {
  const Matrix3d R = Eigen::AngleAxisd(angle, Vector3d::UnitZ()).toRotationMatrix();
  HandleBelief out = belief;
  out.normal = R * belief.normal;
  out.bar = R * belief.bar;
  if (belief.doorway) {
    out.doorway->left = belief.position + R * (belief.doorway->left - belief.position);
    out.doorway->right = belief.position + R * (belief.doorway->right - belief.position);
  }
  return out;
}

double passage_width(const Passage& passage) {
  return flat(passage.hinge - passage.strike).norm() - axis_depth(passage.overhang > 0.0) - kOpenGap;
}

double base_width(const RobotModel& model) { return 2.0 * base_footprint(model).half_width; }

std::string passage_room(const Passage& passage, const RobotModel& model) {
  const double base = base_width(model);
  const double opening = passage_width(passage);
  std::array<char, 96> text{};
  std::snprintf(text.data(), text.size(), "base %.2f m wide, opening %.2f m: %.2f m each side", base, opening,
                0.5 * (opening - base));
  return text.data();
}

BaseLine passage_line(const Passage& passage) {
  return {flat(passage.strike) + 0.5 * passage_width(passage) * across(passage), passage.inward};
}

std::array<Box, 2> passage_walls(const Passage& passage) {
  const Vector3d e = across(passage);
  return {wall(passage, passage.strike, -e), wall(passage, passage.hinge, e, passage.overhang)};
}

double reveal_depth(const HandleBelief& belief) noexcept {
  if (!belief.doorway || belief.passage) return 0.0;
  const Vector3d& edge = likely_side(belief) == HingeSide::Right ? belief.doorway->left : belief.doorway->right;
  const double depth = flat(edge - belief.position).dot(flat(belief.normal)) + belief.standoff;
  return depth > kFlush ? depth : 0.0;
}

std::optional<std::array<Box, 2>> reveal_walls(const HandleBelief& belief) {
  if (!(reveal_depth(belief) > 0.0)) return std::nullopt;
  const std::optional<Passage> seen = make_passage(belief, likely_side(belief));
  if (!seen) return std::nullopt;
  const Vector3d e = across(*seen);
  return std::array<Box, 2>{wall(*seen, seen->strike - kReachIn * e, -e), wall(*seen, seen->hinge + kReachIn * e, e)};
}

Matrix3d turned_to_hinge(const Matrix3d& R, const Passage& passage, double yaw) {
  const double sense = passage.inward.cross(across(passage)).z() < 0.0 ? 1.0 : -1.0;
  return Eigen::AngleAxisd(sense * yaw, Vector3d::UnitZ()).toRotationMatrix() * R;
}

}  // namespace ajar
