#include "ajar/interaction/force_law.hpp"

#include <algorithm>
#include <cmath>

#include "ajar/core/config_range.hpp"

namespace ajar {
namespace {

// Smallest value where zero would divide.
constexpr double kTiny = 1e-9;

Vector3d limited(const Vector3d& v, double largest) {
  const double length = v.norm();
  return length > largest ? Vector3d(v * (largest / length)) : v;
}

}  // namespace

void ForceLawConfig::validate() const {
  check_ranges("interaction", {{"stability_number", stability_number, kTiny, 1.5},
                               {"total_stiffness", total_stiffness, 1.0, 1e7},
                               {"gain_max", gain_max, kTiny, 1.0},
                               {"integral_ratio", integral_ratio, 0.0, 100.0},
                               {"correction_max", correction_max, 0.0, 1.0},
                               {"deadband", deadband, 0.0, 100.0},
                               {"torque_gain", torque_gain, 0.0, 10.0},
                               {"rotational_stiffness", rotational_stiffness, kTiny, 1e6},
                               {"turn_max", turn_max, 0.0, 10.0},
                               {"force_limit", force_limit, 1.0, 1e4},
                               {"speed_start", speed_start, 0.0, 1.0},
                               {"speed", speed, kTiny, 2.0},
                               {"acceleration", acceleration, kTiny, 100.0},
                               {"deceleration", deceleration, kTiny, 100.0},
                               {"give_gain", give_gain, 0.0, 1.0},
                               {"give_margin", give_margin, 0.0, 1e4},
                               {"give_reserve", give_reserve, 0.0, 1e4},
                               {"give_speed", give_speed, 0.0, 1.0}});
}

double loop_gain(double largest, double number, double stiffness, double delay) noexcept {
  return std::min(largest, number / (stiffness * delay));
}

ForceLaw::ForceLaw(const ForceLawConfig& config, double period, double dead_time) : config_(config), period_(period) {
  config.validate();
  check_ranges("interaction", {{"period", period, 1e-6, 0.1}, {"dead_time", dead_time, 0.0, 1.0}});
  const double delay = period + dead_time;
  gain_ = loop_gain(config.gain_max, config.stability_number, config.total_stiffness, delay);
  torque_gain_ = loop_gain(config.torque_gain, config.stability_number, config.rotational_stiffness, delay);
}

void ForceLaw::reset() noexcept { integral_.setZero(); }

ForceCorrection ForceLaw::step(const HandWrench& wrench, const Vector3d& direction, const Vector3d& free_axis) noexcept {
  const double length = direction.norm();
  if (!wrench.force.allFinite() || !wrench.torque.allFinite() || !free_axis.allFinite() || !std::isfinite(length) ||
      length < 0.5) {
    return {};
  }
  const Vector3d x = direction / length;
  const Matrix3d P = Matrix3d::Identity() - x * x.transpose();
  ForceCorrection out;
  out.pull_force = x.dot(wrench.force);
  const Vector3d normal = P * wrench.force;
  out.normal_force = normal.norm();
  const Vector3d error = normal * (std::max(0.0, out.normal_force - config_.deadband) / std::max(out.normal_force, kTiny));
  integral_ = P * integral_;
  const Vector3d wanted = gain_ * (error + config_.integral_ratio * integral_);
  out.velocity = limited(wanted, config_.correction_max);
  if (wanted.norm() < config_.correction_max) {
    integral_ += period_ * error;
  }
  Vector3d torque = wrench.torque;
  const double axis_length = free_axis.norm();
  if (axis_length > 0.5) {
    const Vector3d axis = free_axis / axis_length;
    torque -= axis * axis.dot(torque);
  }
  out.turn = limited(torque_gain_ * torque, config_.turn_max);
  return out;
}

}  // namespace ajar
