#include "ajar/model/footprint.hpp"

#include <algorithm>
#include <cmath>

namespace ajar {

Footprint base_footprint(const RobotModel& model) {
  Footprint out;
  for (const CollisionShape& shape : model.shapes()) {
    if (shape.joint >= 0) continue;
    const Matrix3d R = shape.pose_in_joint.linear();
    const Vector3d& p = shape.pose_in_joint.translation();
    const bool box = shape.kind == CollisionShape::Kind::Box;
    const Vector3d capsule = R.col(2).cwiseAbs() * shape.half_length + Vector3d::Constant(shape.radius);
    const Vector3d reach = box ? Vector3d(R.cwiseAbs() * shape.half_extents) : capsule;
    out.front = std::max(out.front, p.x() + reach.x());
    out.rear = std::max(out.rear, reach.x() - p.x());
    out.half_width = std::max(out.half_width, std::abs(p.y()) + reach.y());
  }
  return out;
}

}  // namespace ajar
