#include <cmath>

#include "ajar/model/robot_model.hpp"

namespace ajar {

Vector2d wheel_speeds(const RobotModel& model, double v, double w) noexcept {
  if (model.base_type() == BaseType::Fixed || !std::isfinite(v) || !std::isfinite(w)) {
    return Vector2d::Zero();
  }
  const double half_difference = 0.5 * w * model.wheel_track();
  return Vector2d(v - half_difference, v + half_difference) / model.wheel_radius();
}

BasePose integrate_base(const BasePose& base, double v, double w, double dt) noexcept {
  const double half_turn = 0.5 * w * dt;
  // The chord of the arc: v dt sin(h)/h at the mean heading. Below 1e-4 rad the series is exact to round-off.
  const double sinc = std::abs(half_turn) < 1e-4 ? 1.0 - half_turn * half_turn / 6.0 : std::sin(half_turn) / half_turn;
  const double chord = v * dt * sinc;
  const BasePose next{base.x + chord * std::cos(base.yaw + half_turn), base.y + chord * std::sin(base.yaw + half_turn),
                      base.yaw + 2.0 * half_turn};
  return std::isfinite(next.x + next.y + next.yaw) ? next : base;
}

}  // namespace ajar
