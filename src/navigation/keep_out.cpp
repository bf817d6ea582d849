// What the base keeps out of, and where beside it it can turn. (docs/equations.md#navigation)
#include <algorithm>
#include <cmath>
#include <limits>

#include "ajar/navigation/navigator.hpp"

namespace ajar {

namespace {

// A base of a metre turns beside a box of half a metre this far on at most; looked for on a grid [m].
constexpr double kLongestWayToTurn = 2.0;
constexpr double kTurnStep = 0.01;

}  // namespace

double footprint_clearance(const BasePose& base, const KeepOut& keep_out) noexcept {
  const double c = std::cos(base.yaw);
  const double s = std::sin(base.yaw);
  const Vector2d n = keep_out.normal;
  const double centre = (base.x - keep_out.point.x()) * n.x() + (base.y - keep_out.point.y()) * n.y();
  const double lengthwise = c * n.x() + s * n.y();
  const double sideways = std::abs(-s * n.x() + c * n.y()) * keep_out.half_width;
  return centre + std::min(lengthwise * keep_out.front, -lengthwise * keep_out.rear) - sideways;
}

// Two rectangles are apart if and only if one of their sides' directions separates them.
double box_clearance(const BasePose& base, const KeepOut& keep_out) noexcept {
  if (!keep_out.box) return std::numeric_limits<double>::infinity();
  const FloorBox& box = *keep_out.box;
  const Vector2d ahead(std::cos(base.yaw), std::sin(base.yaw));
  const Vector2d aside(-ahead.y(), ahead.x());
  const Vector2d across(-box.along.y(), box.along.x());
  const double half_length = 0.5 * (keep_out.front + keep_out.rear);
  const Vector2d middle = Vector2d(base.x, base.y) + 0.5 * (keep_out.front - keep_out.rear) * ahead;
  double apart = -std::numeric_limits<double>::infinity();
  for (const Vector2d& axis : {ahead, aside, box.along, across}) {
    const double robot = std::abs(axis.dot(ahead)) * half_length + std::abs(axis.dot(aside)) * keep_out.half_width;
    const double other =
        std::abs(axis.dot(box.along)) * box.half_extents.x() + std::abs(axis.dot(across)) * box.half_extents.y();
    apart = std::max(apart, std::abs(axis.dot(box.centre - middle)) - robot - other);
  }
  return apart;
}

double way_to_turn(const BasePose& base, const KeepOut& keep_out, double sense) noexcept {
  const Vector2d ahead(std::cos(base.yaw), std::sin(base.yaw));
  const double room = std::hypot(std::max(keep_out.front, keep_out.rear), keep_out.half_width) + keep_out.margin;
  const auto free = [&](const Vector2d& p) {
    if ((p - keep_out.point).dot(keep_out.normal) < room) return false;
    if (!keep_out.box) return true;
    const FloorBox& box = *keep_out.box;
    const Vector2d from = p - box.centre;
    const Vector2d across(-box.along.y(), box.along.x());
    const Vector2d inside(std::abs(from.dot(box.along)), std::abs(from.dot(across)));
    return (inside - box.half_extents).cwiseMax(0.0).norm() >= room;
  };
  for (double way = 0.0; way <= kLongestWayToTurn; way += kTurnStep) {
    if (free(Vector2d(base.x, base.y) + sense * way * ahead)) return way;
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace ajar
