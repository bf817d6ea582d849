// Strategy: positions against the derivative of the leaf's motion, forces against the derivative of a potential energy
// that is written down here anew, bad values by their message. What doors do to a robot is left to the plants.
#include "ajar/mechanism/mechanism.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "ajar/core/error.hpp"
#include "ajar/core/random.hpp"

namespace {

using namespace ajar;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Mechanism random_mechanism(Random& random) {
  Mechanism m;
  m.kind = random.chance(0.6) ? JointKind::Hinge : JointKind::Slide;
  m.axis = random.direction();
  m.point = random.normal3(1.0);
  m.handle.position = m.point + random.normal3(0.5) + m.axis.unitOrthogonal() * 1.0;
  m.com = m.point + random.normal3(0.5);
  m.gravity_share = random.uniform(0.0, 1.0);
  m.stiffness = random.uniform(0.0, 30.0);
  m.spring_reference = random.uniform(-2.0, 0.0);
  m.constant_closing = random.uniform(0.0, 3.0);
  m.closer = {random.uniform(0.0, 30.0), random.uniform(0.0, 20.0), 80.0};
  m.seal = {random.uniform(0.0, 20.0), 0.05};
  return m;
}

TEST(Mechanism, HandleMovesAlongItsDirectionAtItsRadius) {
  Random random(1);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 200; ++i) {
    const Mechanism m = random_mechanism(random);
    const double q = random.uniform(0.0, 2.0);
    const HandleMotion motion = handle_motion(m, q);
    const Vector3d velocity = (handle_motion(m, q + kStep).position - handle_motion(m, q - kStep).position) / (2.0 * kStep);
    EXPECT_LT((velocity - motion.radius * motion.direction).norm(), 1e-8);
    EXPECT_NEAR(motion.direction.norm(), 1.0, 1e-12);
    EXPECT_LT((motion.position - leaf_motion(m, q) * m.handle.position).norm(), 1e-12);
  }
}

TEST(Mechanism, CurvatureTurnsTheDirectionPerMetreOfTravel) {
  Random random(2);
  constexpr double kStep = 1e-6;
  for (int i = 0; i < 200; ++i) {
    const Mechanism m = random_mechanism(random);
    const double q = random.uniform(0.0, 2.0);
    const HandleMotion motion = handle_motion(m, q);
    const Vector3d turn =
        (handle_motion(m, q + kStep).direction - handle_motion(m, q - kStep).direction) / (2.0 * kStep * motion.radius);
    EXPECT_LT((turn - motion.curvature.cross(motion.direction)).norm(), 1e-8);
  }
}

TEST(Mechanism, HandleOfAHingeStaysOnItsCircle) {
  Random random(3);
  Mechanism m = random_mechanism(random);
  m.kind = JointKind::Hinge;
  const double radius = handle_motion(m, 0.0).radius;
  for (double q = 0.0; q < 3.0; q += 0.1) {
    const Vector3d arm = leaf_motion(m, q) * m.handle.position - m.point;
    EXPECT_NEAR(m.axis.cross(arm).norm(), radius, 1e-12);
    EXPECT_NEAR(m.axis.dot(arm), m.axis.dot(m.handle.position - m.point), 1e-12);
  }
}

// Energy stored by springs, closer and weight at q, integrated by hand.
double potential(const Mechanism& m, double q) {
  const double spring = 0.5 * m.stiffness * (q - m.spring_reference) * (q - m.spring_reference);
  const double closer = m.closer.moment * q + 0.5 * m.closer.stiffness * q * q;
  const double s = std::min(q, m.seal.range);
  const double seal = m.seal.force * (s - 0.5 * s * s / m.seal.range);
  const double height = (leaf_motion(m, q) * m.com).z();
  return spring + closer + seal + m.constant_closing * q + m.gravity_share * m.mass * 9.81 * height;
}

TEST(Mechanism, RestingForceIsTheSlopeOfTheStoredEnergy) {
  Random random(4);
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 200; ++i) {
    const Mechanism m = random_mechanism(random);
    const double q = random.uniform(0.001, 1.8);
    if (std::abs(q - m.seal.range) < 2.0 * kStep) continue;
    const double slope = (potential(m, q + kStep) - potential(m, q - kStep)) / (2.0 * kStep);
    EXPECT_NEAR(resisting_force(m, q, 0.0), slope, 1e-5);
  }
}

TEST(Mechanism, DampingOpposesMotionAndACloserDampsClosingMore) {
  Mechanism m;
  m.viscous = 2.0;
  m.closer.closing_damping = 80.0;
  const double rest = resisting_force(m, 0.5, 0.0);
  EXPECT_NEAR(resisting_force(m, 0.5, 0.3) - rest, 0.6, 1e-12);
  EXPECT_NEAR(resisting_force(m, 0.5, -0.3) - rest, -0.3 * 82.0, 1e-12);
}

TEST(Mechanism, NeededHandleForceIsMomentOverRadius) {
  Mechanism m;
  m.point = Vector3d::Zero();
  m.handle.position = {0.8, 0.0, 1.0};
  m.coulomb = 4.0;
  m.breakaway = 1.5;
  m.closer.moment = 12.0;
  EXPECT_NEAR(handle_force_needed(m, 0.0), (12.0 + 6.0) / 0.8, 1e-12);
  EXPECT_NEAR(handle_force_needed(m, 0.4), (12.0 + 4.0) / 0.8, 1e-12);
}

TEST(Mechanism, NotANumberLeavesTheClosedPose) {
  const Mechanism m;
  EXPECT_TRUE(leaf_motion(m, kNan).matrix().isApprox(Pose::Identity().matrix()));
  const HandleMotion motion = handle_motion(m, kNan);
  EXPECT_TRUE(motion.position.allFinite() && motion.direction.allFinite() && motion.curvature.allFinite());
  EXPECT_TRUE(std::isfinite(resisting_force(m, kNan, kNan)));
  EXPECT_TRUE(std::isfinite(handle_force_needed(m, kNan)));
}

TEST(Mechanism, BadValuesAreNamedWithFieldAndRule) {
  struct Case {
    const char* text;
    std::function<void(Mechanism&)> spoil;
  };
  const Case cases[] = {
      {"mass: -3: allowed: > 0", [](Mechanism& m) { m.mass = -3.0; }},
      {"mass: nan", [](Mechanism& m) { m.mass = kNan; }},
      {"axis: (0, 0, 0): allowed: a vector of length 1", [](Mechanism& m) { m.axis.setZero(); }},
      {"inertia: 0", [](Mechanism& m) { m.inertia = 0.0; }},
      {"travel: 0", [](Mechanism& m) { m.travel = 0.0; }},
      {"breakaway: 0.5: allowed: >= 1", [](Mechanism& m) { m.breakaway = 0.5; }},
      {"seal.range: -1", [](Mechanism& m) { m.seal.range = -1.0; }},
      {"closer.moment: -2", [](Mechanism& m) { m.closer.moment = -2.0; }},
      {"handle.normal", [](Mechanism& m) { m.handle.normal *= 2.0; }},
      {"distance handle - axis: 0", [](Mechanism& m) { m.handle.position = m.point; }},
      {"handle.position: (0.8, 0, 1): allowed: outside of walls",
       [](Mechanism& m) {
         m.world.emplace_back();
         m.world.back().pose.translation() = Vector3d(0.9, 0.0, 1.0);
       }},
  };
  for (const Case& c : cases) {
    Mechanism m;
    m.handle.position = {0.8, 0.0, 1.0};
    ASSERT_NO_THROW(m.validate());
    c.spoil(m);
    try {
      m.validate();
      ADD_FAILURE() << "accepted: " << c.text;
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(c.text), std::string::npos) << error.what();
    }
  }
}

}  // namespace
