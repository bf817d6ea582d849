#include "ajar/planning/hypotheses.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "ajar/core/so3.hpp"
#include "ajar/planning/passage.hpp"

namespace ajar {

namespace {

// A bar counts as upright or level when its vertical part is above or below sin 45 degrees.
constexpr double kUpright = 0.7071;
// Below this curvature the chord formulas lose digits; the arc is then straight to 1e-9 m per metre [1/m].
constexpr double kStraight = 1e-9;
// A hand that goes round with a flap would have to hold its bar from below. It leans the other way by this share of the
// turn, until its axis makes the largest angle with the leaf's normal that leaves the palm 3 cm from the leaf: from there on
// it follows. So it stands where it comes off the bar away from the leaf, and the arm keeps above the bar.
constexpr double kFlapShare = -0.8;
constexpr double kLargestLean = 1.05;  // [rad]
// A slide within 45 degrees of the leaf's normal is a drawer.
constexpr double kOutward = 0.7071;
// A leaf that already stands open is still pushed by this much [rad].
constexpr double kLeastAngle = 0.2;
// And by this much farther than wanted: the goal's own margin of 1° and twice the doubt of the angle [rad].
constexpr double kBeyond = 0.06;
// A hand that lets go half way needs room behind itself, or the robot's own body slows it down: 0.2 m/s at 9 cm [m].
constexpr double kRoomBehind = 0.09;
// An axis along the bar: within 25 degrees.
constexpr double kAlongBar = 0.9;
// Where a flap is pressed on: fingertips this deep behind its outer face (a leaf of 4 cm and the round of the tips), this
// much nearer to its axis than the bar [m].
constexpr double kPressDepth = 0.055;
constexpr double kPressBelow = 0.03;
constexpr double kFlapBeyond = 0.09;  // a leaf goes on this far beyond its handle [m]

/// Turning about an axis through a point that lies `radius` along `towards` from the handle's foot on the leaf.
MechanismHypothesis turning(const HandleBelief& belief, const Vector3d& n, const Vector3d& towards, double radius,
                            double angle) {
  MechanismHypothesis out;
  // From the axis to the grip: the grip stands `standoff` in front of the leaf that holds the axis.
  const Vector3d arm = belief.standoff * n - radius * towards;
  const Vector3d axis = (-radius * towards).cross(n).normalized();  // turns the leaf towards the robot
  out.direction = axis.cross(arm).normalized();
  out.curvature = axis / arm.norm();
  out.travel = angle * arm.norm();
  return out;
}

/// Turning away from the robot about the believed axis of a doorway.
MechanismHypothesis pushed(const HandleBelief& belief, const Passage& passage, double angle) {
  MechanismHypothesis out;
  out.name = "pushed through the doorway";
  out.direction = passage_direction(belief, passage);
  out.curvature = passage_curvature(belief, passage);
  out.travel = std::max(kLeastAngle, angle + kBeyond - passage.opened) / out.curvature.norm();
  return out;
}

/// Pressed down from inside; the hand turns about the line on which its fingers stand.
MechanismHypothesis pressed(const HandleBelief& belief, const FlapPress& press, double angle) {
  const Vector3d axis = press.way.curvature.normalized();
  Vector3d arm = press_point(belief, press, press.opened) - press.centre;
  arm -= axis * axis.dot(arm);
  MechanismHypothesis out;
  out.name = "flap pressed down";
  out.direction = axis.cross(arm).normalized();
  out.curvature = axis / arm.norm();
  out.travel = std::max(kBeyond, angle + kBeyond - press.opened) * arm.norm();
  out.free_axis = axis;
  out.hand_stays = true;
  return out;
}

MechanismHypothesis sliding(const Vector3d& direction, double travel) {
  MechanismHypothesis out;
  out.direction = direction;
  out.travel = travel;
  return out;
}

}  // namespace

// p(s) = sin(κs)/κ x + (1 - cos κs)/κ² k × x
HypothesisPoint point_at(const MechanismHypothesis& hypothesis, double arc) noexcept {
  HypothesisPoint out;
  const Vector3d& x = hypothesis.direction;
  const Vector3d& k = hypothesis.curvature;
  const double kappa = k.norm();
  if (kappa < kStraight) {
    out.shift = arc * x;
    out.direction = x;
    return out;
  }
  const double angle = kappa * arc;
  const Vector3d across = k.cross(x);
  out.shift = std::sin(angle) / kappa * x + (1.0 - std::cos(angle)) / (kappa * kappa) * across;
  out.direction = std::cos(angle) * x + std::sin(angle) / kappa * across;
  out.turned = arc * k;
  return out;
}

double free_grip_turn(const Vector3d& bar, double leaf_turn) noexcept {
  if (std::abs(bar.z()) > kUpright) return leaf_turn;
  const double lean = std::clamp((1.0 - kFlapShare) * leaf_turn, -kLargestLean, kLargestLean);
  return leaf_turn - lean;
}

double free_grip_share(const Vector3d& bar, double leaf_turn) noexcept {
  const bool follows = std::abs(bar.z()) > kUpright || (1.0 - kFlapShare) * std::abs(leaf_turn) > kLargestLean;
  return follows ? 1.0 : kFlapShare;
}

bool comes_down(const HandleBelief& belief, const FeltMechanism& felt) noexcept {
  const double kappa = felt.curvature.norm();
  if (kappa < kStraight || belief.bar.norm() < 0.5 || std::abs(belief.bar.z()) > kUpright) return false;
  const bool along = std::abs(felt.curvature.dot(belief.bar)) > kAlongBar * kappa;
  return along && felt.curvature.cross(felt.direction).z() < -kUpright * kappa;
}

FlapPress make_press(const FeltMechanism& felt, const Vector3d& grip, double opened) noexcept {
  const double kappa = felt.curvature.norm();
  return {felt, grip + felt.curvature.cross(felt.direction) / (kappa * kappa), opened};
}

Vector3d press_point(const HandleBelief& belief, const FlapPress& press, double angle) noexcept {
  const Vector3d axis = press.way.curvature.normalized();
  const Vector3d outward = axis.cross(Vector3d::UnitZ());
  const Vector3d closed =
      belief.position - (belief.standoff + kPressDepth) * outward - kPressBelow * Vector3d::UnitZ() - press.centre;
  return press.centre + exp_so3(angle * axis) * closed;
}

double pressed_opening(const HandleBelief& belief, const FlapPress& press, const Vector3d& tip) noexcept {
  const Vector3d axis = press.way.curvature.normalized();
  const Vector3d from = press_point(belief, press, 0.0) - press.centre;
  const Vector3d to = tip - press.centre;
  return std::atan2(axis.dot(from.cross(to)), from.dot(to) - axis.dot(from) * axis.dot(to));
}

double flap_reach(const HandleBelief& belief) noexcept {
  return belief.press ? (belief.position - belief.press->centre).norm() + kFlapBeyond : 0.0;
}

double seen_opening(const FlapPress& press, const Vector3d& normal) noexcept {
  const Vector3d axis = press.way.curvature.normalized();
  const Vector3d outward = axis.cross(Vector3d::UnitZ());
  return std::atan2(axis.cross(outward).dot(normal), outward.dot(normal));
}

MechanismHypothesis felt_hypothesis(const HandleBelief& belief, const FeltMechanism& felt, const PlannerConfig& config) {
  MechanismHypothesis out;
  out.name = "what was felt";  // short: no allocation
  out.direction = felt.direction;
  out.curvature = felt.curvature;
  const double kappa = felt.curvature.norm();
  const bool drawer = std::abs(felt.direction.dot(belief.normal)) > kOutward;
  const double angle = felt.angle > 0.0 ? felt.angle : config.hinge_angle;
  out.travel = kappa > kStraight ? angle / kappa : (drawer ? config.drawer_travel : config.sliding_travel);
  if (felt.angle > 0.0) out.own_room = kRoomBehind;
  if (felt.bar_turns && belief.bar.norm() > 0.5) out.free_axis = belief.bar.normalized();
  return out;
}

std::vector<MechanismHypothesis> make_hypotheses(const HandleBelief& belief, const PlannerConfig& config) {
  if (belief.passage) return {pushed(belief, *belief.passage, config.hinge_angle)};
  if (belief.press) return {pressed(belief, *belief.press, config.hinge_angle)};
  if (belief.felt) return {felt_hypothesis(belief, *belief.felt, config)};
  const Vector3d n = Vector3d(belief.normal.x(), belief.normal.y(), 0.0).normalized();
  const Vector3d side = Vector3d::UnitZ().cross(n);
  const bool knob = belief.bar.norm() < 0.5;
  const bool upright = !knob && std::abs(belief.bar.z()) > kUpright;
  std::vector<MechanismHypothesis> out;
  const auto add = [&](MechanismHypothesis hypothesis, const std::string& name) {
    hypothesis.name = name;
    out.push_back(std::move(hypothesis));
  };
  for (const double radius : config.hinge_radii) {
    for (const double sign : {1.0, -1.0}) {
      add(turning(belief, n, sign * side, radius, config.hinge_angle),
          fmt::format("hinge on the {}, {:.2f} m", sign > 0.0 ? "right" : "left", radius));
    }
  }
  add(sliding(n, config.drawer_travel), "drawer");
  if (upright) {
    for (const double sign : {1.0, -1.0}) {
      add(sliding(sign * side, config.sliding_travel), std::string("sliding to the ") + (sign > 0.0 ? "right" : "left"));
    }
  }
  if (!knob && !upright) {
    MechanismHypothesis flap = turning(belief, n, -Vector3d::UnitZ(), config.flap_radius, config.hinge_angle);
    flap.free_axis = belief.bar.normalized();
    flap.soft = true;
    add(std::move(flap), "flap");
  }
  return out;
}

}  // namespace ajar
