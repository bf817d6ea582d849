#include <algorithm>
#include <cmath>
#include <numbers>

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"
#include "ajar/navigation/navigator.hpp"

namespace ajar {

namespace {

// Below this angle sin(2γ)/(2γ) = 1 - 2γ²/3 is exact to round-off: the next term is 2γ⁴/15 < 2e-17.
constexpr double kSmallAngle = 1e-4;
// Below this distance the direction to the target is meaningless (a tenth of a nanometre).
constexpr double kNoDistance = 1e-10;

bool finite(const BasePose& pose) { return std::isfinite(pose.x) && std::isfinite(pose.y) && std::isfinite(pose.yaw); }

void require_positive(double value, const char* key) {
  if (!(value > 0.0) || !std::isfinite(value)) {
    throw ConfigError("navigation." + std::string(key) + " = " + std::to_string(value) + ": must be positive and finite");
  }
}

}  // namespace

void NavigationConfig::validate() const {
  if (law != "graceful" && law != "polar" && law != "thesis") {
    throw ConfigError("navigation.law = \"" + law + "\": must be one of graceful, polar, thesis");
  }
  require_positive(k_rho, "k_rho");
  require_positive(k_gamma, "k_gamma");
  require_positive(k_delta, "k_delta");
  require_positive(k_phi, "k_phi");
  require_positive(k_turn, "k_turn");
  require_positive(lambda, "lambda");
  require_positive(slow_radius, "slow_radius");
  require_positive(v_max, "v_max");
  require_positive(v_reverse, "v_reverse");
  require_positive(w_max, "w_max");
  require_positive(acceleration, "acceleration");
  require_positive(yaw_acceleration, "yaw_acceleration");
  require_positive(k_final, "k_final");
  require_positive(max_curvature, "max_curvature");
  require_positive(position_tolerance, "position_tolerance");
  require_positive(heading_tolerance, "heading_tolerance");
  if (!(beta >= 0.0) || !std::isfinite(beta)) {
    throw ConfigError("navigation.beta = " + std::to_string(beta) + ": must be zero or positive and finite");
  }
  if (law == "thesis") return;  // its own gains (1, 2, 1) sit on the border of the rule below
  // The path's curvature stays bounded only if both heading modes are faster than the distance (docs/equations.md#polar).
  if (!(k_gamma > 2.0 * k_rho)) {
    throw ConfigError("navigation.k_gamma = " + std::to_string(k_gamma) +
                      ": must be larger than 2 k_rho = " + std::to_string(2.0 * k_rho));
  }
  if (!(k_delta > k_gamma / k_rho - 1.0)) {
    throw ConfigError("navigation.k_delta = " + std::to_string(k_delta) +
                      ": must be larger than k_gamma / k_rho - 1 = " + std::to_string(k_gamma / k_rho - 1.0));
  }
}

// (3.2)-(3.6) with the corrected sign of γ and the series of c(γ). (docs/equations.md#polar)
BaseTwist polar_law(const BasePose& base, const BasePose& target, const NavigationConfig& config) noexcept {
  if (!finite(base) || !finite(target)) return {};
  const double dx = target.x - base.x;
  const double dy = target.y - base.y;
  const double rho = std::hypot(dx, dy);
  if (rho < kNoDistance) return {};
  const double away = config.printed ? std::numbers::pi : 0.0;
  const double gamma = wrap_angle(std::atan2(dy, dx) + away - base.yaw);
  const double delta = wrap_angle(gamma + base.yaw - target.yaw);
  const double c = std::abs(gamma) < kSmallAngle ? 1.0 - 2.0 * gamma * gamma / 3.0 : std::sin(2.0 * gamma) / (2.0 * gamma);
  return {config.k_rho * rho * std::cos(gamma),
          config.k_gamma * gamma + config.k_rho * c * (gamma + config.k_delta * delta)};
}

// Park & Kuipers; backward = the same law with the line of sight turned by π and v negated. (docs/equations.md#graceful)
BaseTwist graceful_law(const BasePose& base, const BasePose& target, bool forward, const NavigationConfig& config) noexcept {
  if (!finite(base) || !finite(target)) return {};
  const double dx = target.x - base.x;
  const double dy = target.y - base.y;
  const double r = std::hypot(dx, dy);
  if (r < kNoDistance) return {};
  const double sight = std::atan2(dy, dx) + (forward ? 0.0 : std::numbers::pi);
  const double phi = wrap_angle(target.yaw - sight);
  const double delta = wrap_angle(base.yaw - sight);
  const double k_phi = config.k_phi;
  const double bend = 1.0 + k_phi / (1.0 + k_phi * k_phi * phi * phi);
  const double kappa = -(config.k_turn * (delta - std::atan(-k_phi * phi)) + bend * std::sin(delta)) / r;
  double v = config.v_max / (1.0 + config.beta * std::pow(std::abs(kappa), config.lambda));
  v = std::min(v, config.v_max * r / config.slow_radius);
  double w = kappa * v;
  if (std::abs(w) > config.w_max) {
    w = std::copysign(config.w_max, w);
    v = w / kappa;  // keeps the curvature
  }
  return {forward ? v : -v, w};
}

}  // namespace ajar
