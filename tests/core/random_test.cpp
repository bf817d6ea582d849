// Strategy: equal seeds give equal draws; means and spreads of 20 000 draws lie within five standard errors of the
// distribution's own, a bound that a right generator misses less than once in a million.
#include "ajar/core/random.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace {

using namespace ajar;
constexpr int kDraws = 20000;

TEST(Random, SameSeedGivesSameDraws) {
  Random a(42);
  Random b(42);
  Random c(43);
  bool differs = false;
  for (int i = 0; i < 100; ++i) {
    const double x = a.uniform(-1.0, 1.0);
    EXPECT_EQ(x, b.uniform(-1.0, 1.0));
    EXPECT_EQ(a.normal(2.0), b.normal(2.0));
    differs = differs || x != c.uniform(-1.0, 1.0);
  }
  EXPECT_TRUE(differs);
}

TEST(Random, UniformStaysInRangeAndHasItsMean) {
  Random random(7);
  double sum = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.uniform(2.0, 5.0);
    ASSERT_GE(x, 2.0);
    ASSERT_LT(x, 5.0);
    sum += x;
  }
  EXPECT_NEAR(sum / kDraws, 3.5, 5.0 * 3.0 / std::sqrt(12.0 * kDraws));
}

TEST(Random, NormalHasZeroMeanAndItsSigma) {
  Random random(8);
  double sum = 0.0;
  double squares = 0.0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = random.normal(3.0);
    sum += x;
    squares += x * x;
  }
  EXPECT_NEAR(sum / kDraws, 0.0, 5.0 * 3.0 / std::sqrt(kDraws));
  EXPECT_NEAR(squares / kDraws, 9.0, 5.0 * 9.0 * std::sqrt(2.0 / kDraws));
}

TEST(Random, ChanceAndIndexFollowTheirProbabilities) {
  Random random(9);
  int hits = 0;
  int counts[4] = {0, 0, 0, 0};
  for (int i = 0; i < kDraws; ++i) {
    hits += random.chance(0.25) ? 1 : 0;
    const int index = random.index(4);
    ASSERT_GE(index, 0);
    ASSERT_LT(index, 4);
    ++counts[index];
  }
  const double bound = 5.0 * std::sqrt(0.25 * 0.75 * kDraws);
  EXPECT_NEAR(hits, 0.25 * kDraws, bound);
  for (const int count : counts) EXPECT_NEAR(count, 0.25 * kDraws, bound);
}

TEST(Random, DirectionsAreUnitAndPointEverywhere) {
  Random random(10);
  Vector3d sum = Vector3d::Zero();
  for (int i = 0; i < kDraws; ++i) {
    const Vector3d d = random.direction();
    ASSERT_NEAR(d.norm(), 1.0, 1e-12);
    sum += d;
  }
  EXPECT_LT((sum / kDraws).norm(), 5.0 / std::sqrt(3.0 * kDraws) * std::sqrt(3.0));
}

}  // namespace
