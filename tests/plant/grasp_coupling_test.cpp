// Strategy: closed forms of a mass on a spring whose other end is led by the hand, energy balance with every loss
// accounted for, sticking and slipping against the forces that were configured, and limits of the stops.
#include "ajar/plant/grasp_coupling.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "ajar/core/so3.hpp"

namespace {

using namespace ajar;
constexpr double kStep = 0.001;

Mechanism drawer(double mass) {
  Mechanism m;
  m.kind = JointKind::Slide;
  m.axis = -Vector3d::UnitY();
  m.mass = m.inertia = mass;
  m.armature = m.coulomb = m.viscous = 0.0;
  m.travel = 10.0;
  return m;
}

// Hinge about z through the origin, handle at radius 0.8 on +x, opens towards +y.
Mechanism door() {
  Mechanism m;
  m.handle.position = {0.8, 0.0, 1.0};
  m.inertia = 4.0;
  m.armature = m.coulomb = m.viscous = 0.0;
  m.travel = 2.0;
  return m;
}

GraspConfig spring(double stiffness) {
  GraspConfig config;
  config.stiffness = stiffness;
  config.damping = 0.0;
  config.slip_force = config.break_force = 1e5;
  return config;
}

Pose at(const Vector3d& position) {
  Pose X = Pose::Identity();
  X.translation() = position;
  return X;
}

TEST(GraspCoupling, MassOnASpringFollowsTheLedEndInClosedForm) {
  const double stiffness = 5e3;
  const double mass = 20.0;
  const double speed = 0.1;
  GraspCoupling coupling(drawer(mass), spring(stiffness));
  coupling.take(at(Vector3d::Zero()), 0.0);
  MechanismState state;
  const double omega = std::sqrt(stiffness / mass);
  for (int i = 0; i < 400; ++i) {
    const auto led = [&](int n) { return at(-Vector3d::UnitY() * (speed * n * kStep)); };
    coupling.step({led(i), led(i + 1), kStep}, false, state);
    const double t = (i + 1) * kStep;
    // Implicit steps of 0.25 ms damp by omega dt / 2 = 0.2 % of critical: 1.2 % of the oscillation after one period.
    EXPECT_NEAR(state.q, speed * (t - std::sin(omega * t) / omega), 0.015 * speed / omega);
    EXPECT_NEAR(coupling.wrench().force.y(), -stiffness * speed * std::sin(omega * t) / omega,
                0.015 * stiffness * speed / omega);
  }
}

TEST(GraspCoupling, WorkOfTheHandIsStoredOrLost) {
  Mechanism m = door();
  m.coulomb = 2.0;
  m.viscous = 1.5;
  m.stiffness = 6.0;
  GraspCoupling coupling(m, spring(1e4));
  coupling.take(at(m.handle.position), 0.0);
  MechanismState state;
  double work = 0.0;
  double lost = 0.0;
  // One radian in four seconds with a soft start, which leaves no oscillation for the implicit step to damp.
  const auto turned = [](int n) { return 0.5 * (1.0 - std::cos(std::numbers::pi * n * kStep / 4.0)); };
  for (int i = 0; i < 4000; ++i) {
    const auto led = [&](int n) {
      const double angle = turned(n);
      return Pose(leaf_motion(m, angle) * at(m.handle.position));
    };
    const Vector3d f0 = coupling.wrench().force;
    const Vector3d t0 = coupling.wrench().torque;
    coupling.step({led(i), led(i + 1), kStep}, false, state);
    const Vector3d way = led(i + 1).translation() - led(i).translation();
    work += 0.5 * (f0 + coupling.wrench().force).dot(way) +
            0.5 * (t0 + coupling.wrench().torque).z() * (turned(i + 1) - turned(i));
    lost += kStep * (m.coulomb * std::abs(state.dq) + m.viscous * state.dq * state.dq);
  }
  const double stored = 0.5 * m.stiffness * state.q * state.q + 0.5 * m.inertia * state.dq * state.dq +
                        0.5 * coupling.wrench().force.squaredNorm() / 1e4;
  EXPECT_NEAR(work, stored + lost, 0.01 * work);
  EXPECT_GT(work, 4.0);
}

TEST(GraspCoupling, FrictionHoldsUntilItIsBrokenAndSlidesWithLess) {
  Mechanism m = drawer(10.0);
  m.coulomb = 10.0;
  m.breakaway = 1.5;
  const GraspConfig config = spring(1e4);
  const auto pulled = [&](double force) {
    GraspCoupling coupling(m, config);
    coupling.take(at(Vector3d::Zero()), 0.0);
    MechanismState state;
    const Pose hand = at(-Vector3d::UnitY() * (force / config.stiffness));
    for (int i = 0; i < 5000; ++i) coupling.step({hand, hand, kStep}, false, state);
    return state;
  };
  EXPECT_EQ(pulled(14.9).q, 0.0);
  EXPECT_EQ(pulled(14.9).dq, 0.0);
  const MechanismState moved = pulled(15.1);
  // Springs past the middle of the sliding force by as much as it started from it: q = 2 (15.1 - 10) / K, then sticks.
  EXPECT_NEAR(moved.q, 2.0 * 5.1 / config.stiffness, 0.03 * 2.0 * 5.1 / config.stiffness);
  EXPECT_EQ(moved.dq, 0.0);
}

TEST(GraspCoupling, PullAlongTheRadiusLoadsTheHingeAndMovesNothing) {
  const Mechanism m = door();
  GraspCoupling coupling(m, spring(1e4));
  coupling.take(at(m.handle.position), 0.0);
  MechanismState state;
  const Pose hand = at(m.handle.position + Vector3d(0.002, 0.0, 0.0));
  for (int i = 0; i < 1000; ++i) coupling.step({hand, hand, kStep}, false, state);
  EXPECT_NEAR(coupling.wrench().force.x(), 20.0, 1e-9);
  EXPECT_NEAR(state.q, 0.0, 1e-12);
}

TEST(GraspCoupling, GripCreepsAboveSlipForceAndBreaksAboveBreakForce) {
  GraspConfig config;
  config.stiffness = 1e4;
  config.slip_force = 120.0;
  config.break_force = 250.0;
  Mechanism m = drawer(20.0);
  const auto drawn_at = [&](double speed, double way) {
    GraspCoupling coupling(m, config);
    coupling.take(at(Vector3d::Zero()), 0.0);
    MechanismState state;
    const int steps = static_cast<int>(way / (speed * kStep));
    double largest = 0.0;
    for (int i = 0; i < steps; ++i) {
      const auto led = [&](int n) { return at(-Vector3d::UnitY() * (speed * n * kStep)); };
      coupling.step({led(i), led(i + 1), kStep}, true, state);
      largest = std::max(largest, coupling.wrench().force.norm());
    }
    EXPECT_EQ(state.q, 0.0);
    return std::pair<double, bool>{largest, coupling.held()};
  };
  const auto [below, held_below] = drawn_at(0.01, 0.0115);
  EXPECT_LT(below, 120.0);
  EXPECT_TRUE(held_below);
  const auto [slow, held_slow] = drawn_at(0.01, 0.05);  // creeps with the hand at a fifth of the range above slip
  EXPECT_NEAR(slow, 120.0 + 130.0 * 0.01 / 0.05, 2.0);
  EXPECT_TRUE(held_slow);
  EXPECT_FALSE(drawn_at(0.01, 0.10).second);  // half of a 12 cm bar: off its end
  const auto [fast, held_fast] = drawn_at(0.2, 0.05);
  EXPECT_GT(fast, 200.0);
  EXPECT_LE(fast, 250.0);
  EXPECT_FALSE(held_fast);
}

TEST(GraspCoupling, LostGripFeelsNothing) {
  GraspConfig config;
  GraspCoupling coupling(drawer(20.0), config);
  coupling.take(at(Vector3d::Zero()), 0.0);
  MechanismState state;
  const Pose far = at(Vector3d(0.0, -0.1, 0.0));
  coupling.step({far, far, kStep}, false, state);
  EXPECT_FALSE(coupling.held());
  EXPECT_EQ(coupling.wrench().force.norm(), 0.0);
}

TEST(GraspCoupling, TurnedHandFeelsTheGripsTorqueUnlessItPivots) {
  for (const bool pivots : {false, true}) {
    GraspConfig config;
    config.pivots = pivots;
    config.rotational_stiffness = 100.0;
    GraspCoupling coupling(drawer(20.0), config);
    coupling.take(at(Vector3d::Zero()), 0.0);
    MechanismState state;
    Pose hand = Pose::Identity();
    hand.linear() = exp_so3(Vector3d(0.03, 0.0, 0.05));
    coupling.step({hand, hand, kStep}, false, state);
    EXPECT_NEAR(coupling.wrench().torque.x(), 3.0, 1e-6);
    EXPECT_NEAR(coupling.wrench().torque.z(), pivots ? 0.0 : 5.0, 1e-6);
  }
}

TEST(GraspCoupling, EndStopHoldsAMovingDoor) {
  const Mechanism m = door();
  GraspCoupling coupling(m, GraspConfig{});
  MechanismState state{1.9, 1.0};
  double furthest = 0.0;
  const Pose hand = Pose::Identity();
  for (int i = 0; i < 500; ++i) {
    coupling.step({hand, hand, kStep}, false, state);
    furthest = std::max(furthest, state.q);
  }
  EXPECT_GT(furthest, m.travel);
  // A critically damped contact struck at speed v yields by v T / e and, as it cannot pull, throws back v / e²; implicit
  // steps take a little from both.
  const double e = std::numbers::e;
  EXPECT_LT(furthest - m.travel, m.stop_time_constant / e);
  EXPECT_GT(furthest - m.travel, 0.8 * m.stop_time_constant / e);
  EXPECT_LT(state.dq, 0.0);
  EXPECT_GT(state.dq, -1.0 / (e * e));
}

TEST(GraspCoupling, CloserShutsAtTheSpeedOfItsDamping) {
  Mechanism m = door();
  m.closer = {20.0, 0.0, 80.0};
  m.viscous = 10.0;
  GraspCoupling coupling(m, GraspConfig{});
  MechanismState state{1.5, 0.0};
  const Pose hand = Pose::Identity();
  for (int i = 0; i < 1000; ++i) coupling.step({hand, hand, kStep}, false, state);
  EXPECT_NEAR(state.dq, -20.0 / 90.0, 1e-4);
  for (int i = 0; i < 10000; ++i) coupling.step({hand, hand, kStep}, false, state);
  // Rests in the closed stop, pressed in by 20 / (M / T²).
  EXPECT_NEAR(state.q, -20.0 * m.stop_time_constant * m.stop_time_constant / m.inertia, 1e-6);
}

TEST(GraspCoupling, StaysStableForTheStiffestGripOnTheLightestFront) {
  GraspConfig config = spring(1e5);
  GraspCoupling coupling(drawer(0.01), config);
  coupling.take(at(Vector3d::Zero()), 0.0);
  MechanismState state;
  const Pose hand = at(Vector3d(0.0, -0.01, 0.0));
  for (int i = 0; i < 1000; ++i) coupling.step({hand, hand, kStep}, false, state);
  EXPECT_NEAR(state.q, 0.01, 1e-6);
}

TEST(GraspCoupling, LockedDoorDoesNotMove) {
  GraspCoupling coupling(drawer(20.0), spring(1e4));
  coupling.take(at(Vector3d::Zero()), 0.3);
  MechanismState state{0.3, 0.2};
  const Pose hand = at(Vector3d(0.0, -0.005, 0.0));
  for (int i = 0; i < 100; ++i) coupling.step({hand, hand, kStep}, true, state);
  EXPECT_EQ(state.q, 0.3);
  EXPECT_NEAR(coupling.wrench().force.y(), -50.0, 1e-9);
}

TEST(GraspCoupling, NotANumberHandLeavesAllAsItWas) {
  GraspCoupling coupling(drawer(20.0), GraspConfig{});
  coupling.take(at(Vector3d::Zero()), 0.0);
  MechanismState state{0.1, 0.2};
  const Pose bad = at(Vector3d::Constant(std::numeric_limits<double>::quiet_NaN()));
  coupling.step({bad, bad, kStep}, false, state);
  coupling.step({at(Vector3d::Zero()), at(Vector3d::Zero()), std::numeric_limits<double>::quiet_NaN()}, false, state);
  EXPECT_EQ(state.q, 0.1);
  EXPECT_EQ(state.dq, 0.2);
  EXPECT_TRUE(coupling.wrench().force.allFinite());
}

}  // namespace
