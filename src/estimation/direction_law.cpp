#include "ajar/estimation/direction_law.hpp"

#include <algorithm>
#include <cmath>

#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

constexpr double kSpeedFloor = 0.02;    // slowest start of a pull: gains grow as 1/v² only down to it [m/s]
constexpr double kMaxTurnRate = 1.5;    // of x̂; a hinge of 0.1 m at 0.15 m/s turns that fast [rad/s]
constexpr double kMaxBendRate = 4.0;    // of k̂ [1/(m s)]
constexpr double kMaxCurvature = 5.0;   // r = 0.2 m: the tightest hinge that start-up has to believe in [1/m]
constexpr double kForceScale = 5.0;     // reaction at which a stuck handle turns the guess at full rate [N]
constexpr double kLeastForce = 1e-3;    // no force [N]
constexpr double kForceDeadBand = 2.0;  // more than bias and noise of a wrist sensor [N]

Vector3d limited(const Vector3d& v, double limit) {
  const double norm = v.norm();
  return norm > limit ? Vector3d(v * (limit / norm)) : v;
}

}  // namespace

AdaptiveGains adaptive_gains(double bandwidth, double damping_ratio, double speed) noexcept {
  const double v2 = std::max(speed * speed, kSpeedFloor * kSpeedFloor);
  AdaptiveGains gains;
  gains.gamma = 2.0 * damping_ratio * bandwidth / v2;
  gains.Gamma = bandwidth * bandwidth / v2;
  return gains;
}

DirectionState step_adaptive_law(const DirectionState& state, const Vector3d& v_ref, double speed,
                                 const AdaptiveGains& gains, double dt) noexcept {
  const Vector3d turn = state.x.cross(v_ref);
  // As a rotation vector: x̂' = w × x̂ with w = γ s x̂ × v_ref + s k̂.
  const Vector3d w = limited(gains.gamma * speed * turn + speed * state.k, kMaxTurnRate);
  const Vector3d bend = limited(gains.Gamma * turn - gains.curvature_leak * state.x * state.x.dot(state.k), kMaxBendRate);
  DirectionState next;
  next.x = (exp_so3(dt * w) * state.x).normalized();
  next.k = limited(state.k + dt * bend, kMaxCurvature);
  return next.x.allFinite() && next.k.allFinite() ? next : state;
}

double unexplained_share(double pull, double normal, double doubt) noexcept {
  if (!std::isfinite(pull) || !std::isfinite(normal)) return 0.0;
  return std::max(0.0, 1.0 - std::abs(pull) * doubt / std::max(normal, kLeastForce));
}

Vector3d turn_from_reaction(const Vector3d& x, const Vector3d& force, double rate, double dt) noexcept {
  const Vector3d normal = force - x * x.dot(force);
  const double size = normal.norm();
  if (!(size > kForceDeadBand) || !std::isfinite(size)) return x;
  const Vector3d w = -x.cross(normal) * (rate / std::max(kForceScale, size));
  return (exp_so3(dt * w) * x).normalized();
}

Vector3d turn_towards(const Vector3d& x, const Vector3d& target, double max_angle) noexcept {
  const Vector3d axis = x.cross(target);
  const double sine = axis.norm();
  const double angle = std::atan2(sine, x.dot(target));
  if (angle <= max_angle) return target;
  const Vector3d unit = sine > 1e-9 ? Vector3d(axis / sine) : any_perpendicular(x);
  return (exp_so3(unit * max_angle) * x).normalized();
}

}  // namespace ajar
