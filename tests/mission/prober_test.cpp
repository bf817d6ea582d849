// Strategy: a handle on an elastic grasp that is free along one direction beyond a breakaway force, else fixed; the hand
// follows its commanded twist exactly. Truth is the direction of the model, which the prober never sees.
#include "ajar/mission/prober.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "ajar/core/random.hpp"

namespace ajar {
namespace {

constexpr double kDt = 0.002;
constexpr double kStiffness = 8e3;

// Quasi-static: the handle slides along `free` so that the pull along it never exceeds the friction.
struct Handle {
  Vector3d free;
  double friction;
  double travel = 0.0;

  Vector3d force(const Vector3d& hand) {
    const double pull = kStiffness * (free.dot(hand) - travel);
    if (pull > friction) travel += (pull - friction) / kStiffness;
    if (pull < -friction && travel > 0.0) travel = std::max(0.0, travel + (pull + friction) / kStiffness);
    return kStiffness * (hand - travel * free);
  }
};

// Returns the angle between found and true direction, or -1 if nothing was found; adds the time to `time`.
double probe(Handle handle, const Vector3d& guess, double& time) {
  Prober prober{ProbeConfig{}};
  Pose hand = Pose::Identity();
  prober.start(hand, guess);
  while (prober.status() == Prober::Status::Running && time < 60.0) {
    const HandWrench wrench{.force = handle.force(hand.translation()), .torque = Vector3d::Zero()};
    const Vector6d twist = prober.step(hand, wrench, kDt);
    hand.translation() += kDt * twist.head<3>();
    time += kDt;
  }
  if (prober.status() != Prober::Status::Found) return -1.0;
  return std::acos(std::clamp(prober.direction().dot(handle.free), -1.0, 1.0));
}

TEST(Prober, FindsAnyFreeDirectionWithinTenSeconds) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    double time = 0.0;
    const double error = probe({random.direction(), random.uniform(0.5, 8.0)}, Vector3d::Zero(), time);
    ASSERT_GE(error, 0.0) << "run " << i;
    EXPECT_LT(error, 0.7) << "run " << i;
    EXPECT_LT(time, 10.0) << "run " << i;
  }
}

TEST(Prober, PressesLittleMoreThanTheHandleNeeds) {
  Random random(5);
  const Vector3d ways[] = {Vector3d::UnitX(),  -Vector3d::UnitX(), Vector3d::UnitY(),
                           -Vector3d::UnitY(), Vector3d::UnitZ(),  -Vector3d::UnitZ()};
  for (int i = 0; i < 60; ++i) {
    Handle handle{ways[i % 6], random.uniform(0.5, 34.0)};
    Prober prober{ProbeConfig{}};
    Pose hand = Pose::Identity();
    prober.start(hand, Vector3d::Zero());
    double peak = 0.0;
    double time = 0.0;
    for (; prober.status() == Prober::Status::Running && time < 60.0; time += kDt) {
      const Vector3d force = handle.force(hand.translation());
      peak = std::max(peak, force.norm());
      hand.translation() += kDt * prober.step(hand, {.force = force, .torque = Vector3d::Zero()}, kDt).head<3>();
    }
    ASSERT_EQ(prober.status(), Prober::Status::Found) << "run " << i;
    EXPECT_LT(peak, handle.friction + 15.0) << "run " << i;
    EXPECT_LT(time, 5.0) << "run " << i;
    EXPECT_LT(std::acos(std::clamp(prober.direction().dot(handle.free), -1.0, 1.0)), 0.1) << "run " << i;
  }
}

TEST(Prober, CallsALockedHandleNothing) {
  double time = 0.0;
  EXPECT_EQ(probe({Vector3d::UnitX(), 1e6}, Vector3d::Zero(), time), -1.0);
  EXPECT_LT(time, 25.0);
}

TEST(Prober, AHeavyHandleIsFoundWithMoreForceAlongTheNormalFirst) {
  double time = 0.0;
  EXPECT_LT(probe({-Vector3d::UnitZ(), 26.0}, Vector3d::Zero(), time), 0.2);
  EXPECT_GE(time, 0.5);
  EXPECT_LT(time, 5.0);
}

TEST(Prober, AGoodGuessIsTriedBeforeTheSides) {
  const Vector3d sideways = (Vector3d::UnitX() + Vector3d::UnitY()).normalized();
  double with_guess = 0.0;
  double without = 0.0;
  EXPECT_LT(probe({sideways, 15.0}, sideways, with_guess), 0.2);
  EXPECT_GE(probe({sideways, 15.0}, Vector3d::Zero(), without), 0.0);
  EXPECT_LT(with_guess, without);
}

TEST(Prober, ALeafThatSpringsBackIsNoAnswer) {
  // Held open by 4 cm against a closer that pushes the hand out; 45 N hold it.
  constexpr double kClosing = 45.0;
  constexpr double kOpen = 0.04;
  const Vector3d inward = Vector3d::UnitZ();
  Prober prober{ProbeConfig{}};
  Pose hand = Pose::Identity();
  prober.start(hand, Vector3d::Zero());
  for (double time = 0.0; prober.status() == Prober::Status::Running && time < 60.0; time += kDt) {
    const Vector3d p = hand.translation();
    const double along = inward.dot(p);
    const double load = std::min(kClosing, kStiffness * (along + kOpen));
    const HandWrench wrench{.force = kStiffness * (p - along * inward) + load * inward, .torque = Vector3d::Zero()};
    hand.translation() += kDt * prober.step(hand, wrench, kDt).head<3>();
  }
  ASSERT_EQ(prober.status(), Prober::Status::Found);
  EXPECT_GT(prober.direction().dot(inward), 0.95);
}

TEST(Prober, HandsOverWithoutTheSidewaysForceOfItsPush) {
  const Vector3d free = Vector3d::UnitX();
  const Vector3d guess = (free + 0.6 * Vector3d::UnitY()).normalized();
  Handle handle{free, 28.0};
  Prober prober{ProbeConfig{}};
  Pose hand = Pose::Identity();
  prober.start(hand, guess);
  Vector3d force = Vector3d::Zero();
  for (double time = 0.0; prober.status() == Prober::Status::Running && time < 60.0; time += kDt) {
    force = handle.force(hand.translation());
    hand.translation() += kDt * prober.step(hand, {.force = force, .torque = Vector3d::Zero()}, kDt).head<3>();
  }
  ASSERT_EQ(prober.status(), Prober::Status::Found);
  // The true load, seen from a direction that is wrong by e, is 28 N sin(e) of it; nothing else is left.
  const double e = std::acos(prober.direction().dot(free));
  const Vector3d across = force - force.dot(prober.direction()) * prober.direction();
  EXPECT_LT(across.norm(), 28.0 * std::sin(e) + 1.5);
}

}  // namespace
}  // namespace ajar
