// Strategy: every draw must build and stay within the stated ranges and force; shares of kinds within five standard
// errors; equal seeds give equal draws.
#include "ajar/mechanism/random_mechanism.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace {

using namespace ajar;
constexpr int kDraws = 1000;
constexpr double kDegree = std::numbers::pi / 180.0;

double share_bound(double p) { return 5.0 * std::sqrt(p * (1.0 - p) / kDraws); }

TEST(RandomMechanism, PullsStayWithinTheirRangesAndNeedAtMostFortyNewton) {
  Random random(1);
  int hinges = 0;
  int lying = 0;
  int left = 0;
  for (int i = 0; i < kDraws; ++i) {
    const MechanismConfig config = sample_pull(random);
    const Mechanism m = make_mechanism(config);
    for (double q = 0.0; q <= m.travel; q += 0.01) EXPECT_LE(handle_force_needed(m, q), kLargestDrawnForce * 1.001);
    lying += config.bar == BarOrientation::Horizontal ? 1 : 0;
    EXPECT_GT(handle_motion(m, 0.0).direction.dot(m.handle.normal), 0.9);
    if (m.kind == JointKind::Slide) {
      EXPECT_GE(m.travel, 0.3);
      EXPECT_LE(m.travel, 0.5);
      continue;
    }
    ++hinges;
    left += config.side == Side::Left ? 1 : 0;
    EXPECT_GE(config.radius, 0.3);
    EXPECT_LE(config.radius, 0.95);
    EXPECT_GE(m.travel, 80.0 * kDegree);
    EXPECT_LE(m.travel, 115.0 * kDegree);
  }
  EXPECT_NEAR(hinges, 0.6 * kDraws, share_bound(0.6) * kDraws);
  EXPECT_NEAR(lying, 0.35 * kDraws, share_bound(0.35) * kDraws);
  EXPECT_NEAR(left, 0.5 * hinges, share_bound(0.5) * kDraws);
}

TEST(RandomMechanism, OvensHingeBelowAndFallTowardsTheRobot) {
  Random random(2);
  for (int i = 0; i < kDraws; ++i) {
    const Mechanism m = make_mechanism(sample_oven(random));
    EXPECT_LT(m.point.z(), m.handle.position.z());
    EXPECT_GT(m.point.z(), 0.0);
    EXPECT_NEAR(m.axis.z(), 0.0, 1e-9);
    EXPECT_LT(handle_motion(m, 0.5 * m.travel).direction.z(), 0.0);
    EXPECT_LE(handle_force_needed(m, 0.0), kLargestDrawnForce);
  }
}

TEST(RandomMechanism, SlidingDoorsMoveAlongTheWallToBothSides) {
  Random random(3);
  int right = 0;
  for (int i = 0; i < kDraws; ++i) {
    const MechanismConfig config = sample_sliding(random);
    const Mechanism m = make_mechanism(config);
    EXPECT_NEAR(handle_motion(m, 0.1).direction.dot(m.handle.normal), 0.0, 1e-9);
    EXPECT_NEAR(std::abs(m.handle.bar.z()), 1.0, 1e-12);
    right += config.slide_direction.x() > 0.0 ? 1 : 0;
  }
  EXPECT_NEAR(right, 0.5 * kDraws, share_bound(0.5) * kDraws);
}

TEST(RandomMechanism, PushesLeadAwayFromTheRobot) {
  Random random(4);
  for (int i = 0; i < kDraws; ++i) {
    const MechanismConfig config = sample_push(random);
    const Mechanism m = make_mechanism(config);
    EXPECT_LT(handle_motion(m, 0.0).direction.dot(m.handle.normal), -0.9);
    EXPECT_GE(config.radius, 0.7);
  }
}

TEST(RandomMechanism, AnyKindStandsInTheRoomAndNeedsAtMostFortyNewton) {
  Random random(7);
  int hinges = 0;
  int level = 0;
  int tilted = 0;
  int away = 0;
  int sideways = 0;
  int upwards = 0;
  for (int i = 0; i < kDraws; ++i) {
    const MechanismConfig config = sample_any(random);
    const Mechanism m = make_mechanism(config);
    for (double q = 0.0; q <= m.travel; q += 0.02) EXPECT_LE(handle_force_needed(m, q), kLargestDrawnForce * 1.001);
    EXPECT_GT(handle_force_needed(m, 0.0), 0.0);
    if (m.kind == JointKind::Slide) {
      sideways += std::abs(m.axis.dot(m.handle.normal)) < 0.1 && std::abs(m.axis.z()) < 0.1 ? 1 : 0;
      upwards += std::abs(m.axis.z()) > 0.99 ? 1 : 0;
      continue;
    }
    ++hinges;
    EXPECT_GE(config.radius, 0.2);
    EXPECT_LE(config.radius, 1.2);
    EXPECT_GT(m.point.z(), 0.0);
    level += std::abs(m.axis.z()) < 1e-9 ? 1 : 0;
    tilted += std::abs(m.axis.z()) > 1e-9 && std::abs(m.axis.z()) < 0.95 ? 1 : 0;
    away += config.sense == Sense::Push ? 1 : 0;
  }
  EXPECT_NEAR(hinges, 0.65 * kDraws, share_bound(0.65) * kDraws);
  EXPECT_NEAR(sideways, 0.35 * 0.35 * kDraws, share_bound(0.35 * 0.35) * kDraws);
  EXPECT_NEAR(upwards, 0.35 * 0.2 * kDraws, share_bound(0.35 * 0.2) * kDraws);
  // What would not stand in the room is drawn again: only that every kind occurs often is asked.
  for (const int kind : {level, tilted}) EXPECT_GT(kind, 0.1 * hinges);
  EXPECT_GT(away, 0.02 * hinges);
}

TEST(RandomMechanism, SameSeedDrawsTheSameMechanisms) {
  Random a(5);
  Random b(5);
  Random c(6);
  EXPECT_EQ(sample_pull(a), sample_pull(b));
  EXPECT_EQ(sample_oven(a), sample_oven(b));
  EXPECT_NE(sample_pull(a), sample_pull(c));
}

}  // namespace
