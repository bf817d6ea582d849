#include "ajar/planning/flap_room.hpp"

#include <cmath>
#include <limits>

#include "ajar/planning/believed_scene.hpp"

namespace ajar {

KeepOut beside_flap(const HandleBelief& belief, const FlapPress& press, double angle) noexcept {
  const Vector3d axis = press.way.curvature.normalized();
  const Vector3d out = axis.cross(Vector3d::UnitZ());
  const Box leaf = leaf_pressed(belief, press, angle);
  const auto half = [&](const Vector3d& along) {
    return (leaf.pose.linear().transpose() * along).cwiseAbs().dot(leaf.half_extents);
  };
  KeepOut keep_out;
  keep_out.point = (belief.position - belief.standoff * out).head<2>();
  keep_out.normal = out.head<2>().normalized();
  keep_out.box = FloorBox{leaf.pose.translation().head<2>(), keep_out.normal, {half(out), half(axis)}};
  return keep_out;
}

double way_off_flap(const BasePose& base, const KeepOut& flap) noexcept {
  const double outward = Vector2d(std::cos(base.yaw), std::sin(base.yaw)).dot(flap.normal);
  double best = std::numeric_limits<double>::infinity();
  double sense = 0.0;
  for (const double s : {1.0, -1.0}) {
    const double way = s * outward >= 0.0 ? way_to_turn(base, flap, s) : best;
    if (way < best) {
      best = way;
      sense = s;
    }
  }
  return std::isfinite(best) ? sense * best : 0.0;
}

}  // namespace ajar
