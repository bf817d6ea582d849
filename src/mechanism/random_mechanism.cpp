#include "ajar/mechanism/random_mechanism.hpp"

#include <algorithm>
#include <numbers>

namespace ajar {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kRoom = 2.0;        // mechanisms stand within ± this of the origin [m]
constexpr double kLyingBars = 0.35;  // share of horizontal bars
constexpr double kBreakaway = 1.5;   // largest static over sliding friction of hinges and runners [-]
constexpr int kCheckedOpenings = 20;
constexpr double kAskew = 0.05;        // doors that hang askew [rad]
constexpr double kAskewSlide = 0.26;   // 15 degrees off the normal
constexpr double kLeastDoorway = 0.7;  // radius of the smallest door drawn to open away: the base is 0.58 m wide [m]
constexpr double kAboveFloor = 0.05;   // [m]
constexpr double kBelowCeiling = 2.3;  // [m]

MechanismConfig place(Random& random) {
  MechanismConfig config;
  const double x = random.uniform(-kRoom, kRoom);
  const double y = random.uniform(-kRoom, kRoom);
  config.at = {x, y};
  config.yaw = random.uniform(-std::numbers::pi, std::numbers::pi);
  config.bar = random.chance(kLyingBars) ? BarOrientation::Horizontal : BarOrientation::Vertical;
  config.breakaway = random.uniform(1.0, kBreakaway);
  return config;
}

double largest_force(const MechanismConfig& config) {
  const Mechanism mechanism = make_mechanism(config);
  double largest = 0.0;
  for (int i = 0; i <= kCheckedOpenings; ++i) {
    largest = std::max(largest, handle_force_needed(mechanism, mechanism.travel * i / kCheckedOpenings));
  }
  return largest;
}

// Moments that come from the handle's force scale with the radius, so that small doors do not become heavy ones.
void add_closer_or_seal(Random& random, MechanismConfig& config) {
  const double kind = random.uniform(0.0, 1.0);
  if (kind < 0.20) {
    config.closer.moment = random.uniform(8.0, 20.0) * config.radius / 0.8;
    config.closer.stiffness = random.uniform(0.0, 3.0);
    config.closer.closing_damping = random.uniform(20.0, 60.0) * config.radius / 0.8;
    config.viscous = random.uniform(3.0, 10.0);  // hydraulic [N m s/rad]
  } else if (kind < 0.35) {
    config.seal.force = random.uniform(10.0, 30.0) * config.radius;
    config.seal.range = 3.0 * kDegree;  // magnetic gaskets let go within a few degrees
  }
}

MechanismConfig draw_door(Random& random, Sense sense, double radius_lower, double mass_lower) {
  MechanismConfig config = place(random);
  config.type = "hinge";
  config.sense = sense;
  config.side = random.chance(0.5) ? Side::Left : Side::Right;
  config.radius = random.uniform(radius_lower, 0.95);
  config.handle_height = random.uniform(0.9, 1.1);
  config.mass = random.uniform(mass_lower, 40.0) * config.radius / 0.9;
  config.coulomb = random.uniform(0.5, 4.0);
  config.viscous = random.uniform(0.2, 2.0);
  config.travel = random.uniform(80.0, 115.0) * kDegree;
  return config;
}

MechanismConfig draw_drawer(Random& random) {
  MechanismConfig config = place(random);
  config.type = "slide";
  config.handle_height = random.uniform(0.55, 1.05);
  config.mass = random.uniform(3.0, 30.0);
  config.viscous = random.uniform(5.0, 20.0);
  config.coulomb = random.uniform(2.0, 12.0);
  config.travel = random.uniform(0.3, 0.5);
  config.front_height = random.uniform(0.12, 0.30);
  config.front_width = random.uniform(0.36, 0.80);
  return config;
}

// Free, rubbing, sprung or closing by itself; forces at the handle, `lever` turns them into those of the joint.
void add_resistance(Random& random, double lever, MechanismConfig& config) {
  const double kind = random.uniform(0.0, 1.0);
  config.viscous = random.uniform(2.0, 10.0) * lever * lever;
  config.coulomb = random.uniform(0.5, 4.0) * lever;
  if (kind < 0.25) return;
  if (kind < 0.5) {
    config.coulomb = random.uniform(4.0, 20.0) * lever;
  } else if (kind < 0.75) {
    const double whole_way = config.travel * lever;
    config.stiffness = random.uniform(2.0, 15.0) / whole_way * lever * lever;
    config.spring_reference = -random.uniform(2.0, 15.0) * lever / config.stiffness;
  } else {
    config.closer.moment = random.uniform(8.0, 20.0) * lever;
    config.closer.stiffness = random.uniform(0.0, 4.0) * lever * lever;
    config.closer.closing_damping = random.uniform(30.0, 90.0) * lever * lever;
  }
}

// Whether a flap's corners keep off the floor and below the ceiling.
bool fits_room(const MechanismConfig& config) {
  const Mechanism mechanism = make_mechanism(config);
  const Box& leaf = mechanism.leaf.front();
  const double half_height = (leaf.pose.linear().row(2).cwiseAbs() * leaf.half_extents).value();
  const double middle = leaf.pose.translation().z();
  return middle - half_height > kAboveFloor && middle + half_height < kBelowCeiling;
}

MechanismConfig draw_hinge_about_any_axis(Random& random) {
  MechanismConfig config = place(random);
  config.type = "hinge";
  config.side = random.chance(0.5) ? Side::Left : Side::Right;
  config.radius = random.uniform(0.2, 1.2);
  config.handle_height = random.uniform(0.7, 1.1);
  config.mass = random.uniform(3.0, 30.0) * config.radius / 0.9;
  config.travel = random.uniform(80.0, 100.0) * kDegree;
  const double kind = random.uniform(0.0, 1.0);
  if (kind < 0.4) {
    config.tilt = random.uniform(-kAskew, kAskew);
    if (config.radius > kLeastDoorway && random.chance(0.25)) config.sense = Sense::Push;
  } else {
    const bool level = kind < 0.7;
    config.tilt = level ? std::numbers::pi / 2.0 : random.uniform(-0.5, 0.5) * std::numbers::pi;
    if (level) config.bar = BarOrientation::Horizontal;
    config.gravity_share = random.uniform(0.0, 0.2);  // springs carry the rest
  }
  add_resistance(random, config.radius, config);
  return config;
}

// Drawers askew by up to 15 degrees, doors that slide along the wall, sashes that slide up or down.
MechanismConfig draw_slide_any_way(Random& random) {
  MechanismConfig config = place(random);
  config.type = "slide";
  config.handle_height = random.uniform(0.7, 1.1);
  config.travel = random.uniform(0.3, 0.5);
  const double kind = random.uniform(0.0, 1.0);
  const double sign = random.chance(0.5) ? 1.0 : -1.0;
  if (kind < 0.45) {
    const double sideways = random.uniform(-kAskewSlide, kAskewSlide);
    config.slide_direction = Vector3d(sideways, -1.0, random.uniform(-kAskewSlide, kAskewSlide));
    config.mass = random.uniform(3.0, 30.0);
  } else if (kind < 0.8) {
    config.slide_direction = Vector3d(sign, 0.0, 0.0);
    config.mass = random.uniform(10.0, 50.0);
  } else {
    config.slide_direction = Vector3d(0.0, 0.0, sign);
    config.bar = BarOrientation::Horizontal;
    config.mass = random.uniform(2.0, 10.0);  // counterbalanced: gravity_share stays 0
  }
  add_resistance(random, 1.0, config);
  return config;
}

// Draws again until the mechanism can be opened with the largest force; the ranges above seldom exceed it.
template <typename Draw>
MechanismConfig draw_within_force(const Draw& draw) {
  MechanismConfig config = draw();
  while (largest_force(config) > kLargestDrawnForce) config = draw();
  return config;
}

}  // namespace

MechanismConfig sample_pull(Random& random) {
  return draw_within_force([&] {
    if (random.chance(0.4)) return draw_drawer(random);
    MechanismConfig config = draw_door(random, Sense::Pull, 0.3, 5.0);
    add_closer_or_seal(random, config);
    return config;
  });
}

MechanismConfig sample_oven(Random& random) {
  return draw_within_force([&] {
    MechanismConfig config = place(random);
    config.type = "hinge";
    config.side = Side::Right;
    config.tilt = std::numbers::pi / 2.0;
    config.bar = BarOrientation::Horizontal;
    config.radius = random.uniform(0.35, 0.5);
    config.handle_height = random.uniform(0.6, 1.0);
    config.mass = random.uniform(4.0, 10.0);
    config.coulomb = random.uniform(0.5, 2.0);
    config.viscous = random.uniform(0.3, 1.5);
    config.travel = random.uniform(86.0, 93.0) * kDegree;
    config.gravity_share = 1.0 - random.uniform(0.6, 1.1);
    return config;
  });
}

MechanismConfig sample_sliding(Random& random) {
  return draw_within_force([&] {
    MechanismConfig config = place(random);
    config.type = "slide";
    config.slide_direction = Vector3d(random.chance(0.5) ? 1.0 : -1.0, 0.0, 0.0);
    config.bar = BarOrientation::Vertical;
    config.handle_height = random.uniform(0.95, 1.05);
    config.mass = random.uniform(10.0, 50.0);
    config.viscous = random.uniform(5.0, 20.0);
    config.coulomb = random.uniform(5.0, 20.0);
    config.travel = random.uniform(0.6, 0.9);
    return config;
  });
}

MechanismConfig sample_push(Random& random) {
  // An opening of 0.8 m and more: the base is 0.58 m wide.
  return draw_within_force([&] { return draw_door(random, Sense::Push, 0.7, 10.0); });
}

MechanismConfig sample_any(Random& random) {
  return draw_within_force([&] {
    if (random.chance(0.35)) return draw_slide_any_way(random);
    MechanismConfig config = draw_hinge_about_any_axis(random);
    while (std::abs(config.tilt) > kAskew && !fits_room(config)) config = draw_hinge_about_any_axis(random);
    return config;
  });
}

}  // namespace ajar
