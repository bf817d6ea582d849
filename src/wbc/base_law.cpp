#include "ajar/wbc/base_law.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

// Measured speed below which the mechanism is taken as standing (encoder noise) [m/s].
constexpr double kStandingSpeed = 0.004;
// Confidence above which the direction is good enough to choose forward or backward once.
constexpr double kChooseConfidence = 0.3;
// The driving sense changes only when the heading error passes a right angle by 15°.
constexpr double kSenseHysteresis = std::numbers::pi / 2.0 + std::numbers::pi / 12.0;
// Reference slower than this share of the hand defines no heading: the last one is held.
constexpr double kLeastHorizontalShare = 0.25;
// Lateral error that the steering answers to at most: bounds ω = k_y v e_y [m].
constexpr double kLateralMax = 0.15;
// Speed at which heading feedback has full strength: a standing base is not turned on the spot [m/s].
constexpr double kFullHeadingSpeed = 0.05;
// Largest feed-forward turning, in turnings of the mechanism: bounded where the reference nearly stands.
constexpr double kTurningMax = 1.5;
// A base that must still turn cannot follow: beyond 75° each further radian counts as that much lag, so that the hand has
// nearly stopped waiting for its place when the base stands across its way [rad], [m/rad].
constexpr double kTurnAllowance = 1.3;
constexpr double kTurnLag = 1.0;
// cos²β + ε²: driving does not change the distance to a hand beside the base (β = ±90°).
constexpr double kSideways = 0.05;
// Part of the hand's speed with which a base beside the hand leaves its path to close what is missing: atan(0.6) = 31°.
constexpr double kMissingShare = 0.6;
// |cos β| below which the heading takes part: within 20° of beside.
constexpr double kBeside = 0.35;
// Share of horizontal motion below which "distance" holds its heading.
constexpr double kLeastPlanarShare = 0.2;

bool is_usable(const BaseLawInput& input) {
  return std::isfinite(input.dt) && input.dt > 0.0 && std::isfinite(input.base.x) && std::isfinite(input.base.y) &&
         std::isfinite(input.base.yaw) && input.hand.allFinite() && input.direction.allFinite() &&
         input.curvature.allFinite() && std::isfinite(input.wanted_speed) && std::isfinite(input.measured_speed) &&
         std::isfinite(input.confidence);
}

Vector3d turn_about_z(double angle, const Vector3d& v) { return Eigen::AngleAxisd(angle, Vector3d::UnitZ()) * v; }

}  // namespace

BaseLaw::BaseLaw(const BaseLawConfig& config) : config_(config) {
  config.validate();
  kind_ = config.kind == "corotating" ? Kind::Corotating : config.kind == "distance" ? Kind::Distance : Kind::Line;
}

void BaseLaw::reset(const BasePose& base, const Vector3d& hand, const std::optional<BaseLine>& line) noexcept {
  line_ = line;
  offset_ = Vector3d(base.x - hand.x(), base.y - hand.y(), 0.0);
  turned_ = 0.0;
  start_yaw_ = base.yaw;
  last_heading_ = line ? std::atan2(line->direction.y(), line->direction.x()) : base.yaw;
  drive_sense_ = 0;
}

BaseLawOutput BaseLaw::step(const BaseLawInput& input) noexcept {
  if (!is_usable(input) || !offset_.allFinite()) {
    return {};
  }
  BaseLawOutput out = kind_ == Kind::Corotating ? corotating(input) : keep_distance(input);
  const double confidence = std::clamp(input.confidence, 0.0, 1.0);
  out.twist.v *= confidence;
  out.twist.w *= confidence;
  return out;
}

// Forward or backward along the heading: chosen once when the direction is known, then kept with hysteresis.
void BaseLaw::choose_sense(double heading, double yaw, double confidence) noexcept {
  const double error = std::abs(wrap_angle(heading - yaw));
  if (drive_sense_ == 0) {
    if (confidence > kChooseConfidence) {
      drive_sense_ = error <= std::numbers::pi / 2.0 ? 1 : -1;
    }
  } else if ((drive_sense_ > 0 ? error : std::numbers::pi - error) > kSenseHysteresis) {
    drive_sense_ = -drive_sense_;
  }
}

// p_ref = c + Π (p_hand + Rz(φ_b) o - c) turns with the share g of the mechanism; the base tracks it as a unicycle does.
// In the open Π = I; on a line Π = a aᵀ and g = 0.
BaseLawOutput BaseLaw::corotating(const BaseLawInput& input) noexcept {
  const double k_z = input.curvature.z();
  const double follow = std::clamp(config_.full_curvature / std::max(std::abs(k_z), 1e-6), config_.least_share, 1.0);
  const double share = line_ ? 0.0 : follow;
  const auto allowed = [&](const Vector3d& v) -> Vector3d {
    return line_ ? Vector3d(line_->direction * line_->direction.dot(v)) : v;
  };
  if (std::abs(input.measured_speed) > kStandingSpeed) {
    turned_ += share * k_z * input.measured_speed * input.dt;
  }
  const Vector3d offset = turn_about_z(turned_, offset_);
  const Vector3d turning = share * k_z * Vector3d::UnitZ();
  // Velocity of the reference per metre of handle travel, and its change.
  const Vector3d path = allowed(input.direction + turning.cross(offset));
  const Vector3d path_change = allowed(input.curvature.cross(input.direction) + turning.cross(turning.cross(offset)));
  const double rate = path.head<2>().norm();
  double turn_per_metre = share * k_z;
  if (rate > kLeastHorizontalShare) {
    last_heading_ = std::atan2(path.y(), path.x());
    const double largest = kTurningMax * std::abs(k_z);
    turn_per_metre =
        std::clamp((path.x() * path_change.y() - path.y() * path_change.x()) / (rate * rate), -largest, largest);
  }
  choose_sense(last_heading_, input.base.yaw, input.confidence);
  const double sense = drive_sense_ < 0 ? -1.0 : 1.0;
  const double heading_error = wrap_angle(last_heading_ + (sense < 0.0 ? std::numbers::pi : 0.0) - input.base.yaw);
  const double c = std::cos(input.base.yaw);
  const double s = std::sin(input.base.yaw);
  const Vector3d origin = line_ ? line_->point : Vector3d(Vector3d::Zero());
  const Vector3d reference = origin + allowed(input.hand + offset - origin);
  const double dx = reference.x() - input.base.x;
  const double dy = reference.y() - input.base.y;
  const double along = c * dx + s * dy;
  const double across = -s * dx + c * dy;
  const double v_ref = sense * input.wanted_speed * rate;

  BaseLawOutput out;
  out.twist.v = v_ref * std::cos(heading_error) + config_.gain_along * along;
  out.twist.w = input.wanted_speed * turn_per_metre +
                config_.gain_across * v_ref * std::clamp(across, -kLateralMax, kLateralMax) +
                config_.gain_heading * std::sin(heading_error) * std::min(1.0, std::abs(v_ref) / kFullHeadingSpeed);
  out.lag = std::hypot(dx, dy) + kTurnLag * std::max(0.0, std::abs(heading_error) - kTurnAllowance);
  out.heading_error = -heading_error;
  return out;
}

// The base moves with the hand, which alone keeps the distance, and closes what is missing: by its speed where the hand is
// ahead or behind, by its heading where the hand is beside it. "line" keeps its first heading. (docs/equations.md#base-law)
BaseLawOutput BaseLaw::keep_distance(const BaseLawInput& input) noexcept {
  const Vector2d reach(input.hand.x() - input.base.x, input.hand.y() - input.base.y);
  const double distance = std::max(reach.norm(), 1e-3);
  const Vector2d ray = reach / distance;
  const Vector2d nose(std::cos(input.base.yaw), std::sin(input.base.yaw));
  const double cos_beta = ray.dot(nose);
  const double most = kMissingShare * std::abs(input.wanted_speed);
  const double missing = config_.gain_distance * (distance - config_.distance);
  const double beside = kind_ == Kind::Distance ? std::max(0.0, 1.0 - std::abs(cos_beta) / kBeside) : 0.0;
  // Critically damped with the heading's own loop: a quarter of its gain.
  const double aside = std::min(config_.gain_distance, 0.25 * config_.gain_heading_distance) * (distance - config_.distance);
  const Vector2d velocity = input.wanted_speed * input.direction.head<2>() + beside * std::clamp(aside, -most, most) * ray;
  double heading = start_yaw_;
  double turn = 0.0;
  double sense = 1.0;
  if (kind_ == Kind::Distance) {
    if (velocity.norm() > kLeastPlanarShare * std::abs(input.wanted_speed)) {
      const Vector3d change = input.wanted_speed * input.wanted_speed * input.curvature.cross(input.direction);
      last_heading_ = std::atan2(velocity.y(), velocity.x());
      turn = (velocity.x() * change.y() - velocity.y() * change.x()) / velocity.squaredNorm();
    }
    heading = last_heading_;
    choose_sense(heading, input.base.yaw, input.confidence);
    sense = drive_sense_ < 0 ? -1.0 : 1.0;
  }
  const double error = wrap_angle(input.base.yaw - heading - (sense < 0.0 ? std::numbers::pi : 0.0));

  BaseLawOutput out;
  // What the hand's own motion changes of the distance beyond what a base that goes as the hand does would take back.
  const double change = velocity.dot(ray) - nose.dot(velocity) * cos_beta;
  out.twist.v = nose.dot(velocity) + (1.0 - beside) * (missing + change) * cos_beta / (cos_beta * cos_beta + kSideways);
  out.twist.w = turn - config_.gain_heading_distance * error;
  out.lag = std::abs(distance - config_.distance);
  out.heading_error = error;
  return out;
}

}  // namespace ajar
