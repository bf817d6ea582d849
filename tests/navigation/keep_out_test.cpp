// Strategy: distances of rectangles in closed form; where a base may turn is checked by turning it, and the way into a place
// beside a box by driving it from random starts with the drives' lag.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <numbers>

#include "ajar/core/random.hpp"
#include "ajar/navigation/navigator.hpp"

namespace ajar {
namespace {

constexpr double kPi = std::numbers::pi;

// A wall along x at y = 0 and a flap of 0.6 m that reaches half a metre out of it.
KeepOut flap_before_wall() {
  KeepOut keep_out;
  keep_out.box = FloorBox{Vector2d(0.0, -0.25), -Vector2d::UnitY(), Vector2d(0.25, 0.3)};
  return keep_out;
}

TEST(BoxClearance, IsTheGapBetweenParallelRectangles) {
  const KeepOut keep_out = flap_before_wall();
  EXPECT_NEAR(box_clearance({0.1, -1.0, 0.0}, keep_out), 0.5 - keep_out.half_width, 1e-12);
  EXPECT_NEAR(box_clearance({0.1, -1.0, 0.5 * kPi}, keep_out), 0.5 - keep_out.front, 1e-12);
  EXPECT_NEAR(box_clearance({0.1, -1.0, -0.5 * kPi}, keep_out), 0.5 - keep_out.rear, 1e-12);
  EXPECT_NEAR(box_clearance({0.1, -0.6, 0.0}, keep_out), 0.1 - keep_out.half_width, 1e-12);  // they overlap
  EXPECT_EQ(box_clearance({}, KeepOut()), std::numeric_limits<double>::infinity());
}

TEST(BoxClearance, OfACornerBeforeASideIsTheCornersDistance) {
  const KeepOut keep_out = flap_before_wall();
  for (const double yaw : {0.3, 0.8, 1.2}) {
    const BasePose base{-0.1, -1.2, yaw};
    const double corner = base.y + keep_out.front * std::sin(yaw) + keep_out.half_width * std::cos(yaw);
    EXPECT_NEAR(box_clearance(base, keep_out), -0.5 - corner, 1e-12) << yaw;
  }
}

TEST(WayToTurn, EndsWhereTheBaseTurnsWithItsMarginAndNotSooner) {
  const KeepOut keep_out = flap_before_wall();
  Random random(5);
  int found = 0;
  for (int i = 0; i < 200; ++i) {
    const BasePose base{random.uniform(-0.6, 0.6), random.uniform(-1.1, -0.7), random.uniform(-kPi, kPi)};
    const double sense = i % 2 == 0 ? 1.0 : -1.0;
    const double way = way_to_turn(base, keep_out, sense);
    if (!std::isfinite(way)) continue;
    ++found;
    const auto nearest = [&](double along) {
      BasePose there = integrate_base(base, sense * along, 0.0, 1.0);
      double gap = 1e9;
      for (there.yaw = -kPi; there.yaw < kPi; there.yaw += 0.01)
        gap = std::min({gap, box_clearance(there, keep_out), footprint_clearance(there, keep_out)});
      return gap;
    };
    EXPECT_GE(nearest(way), 0.7 * keep_out.margin);  // between two corners it tells less than there is
    if (way > 0.02) {
      EXPECT_LT(nearest(way - 0.02), keep_out.margin);
    }
  }
  EXPECT_GT(found, 100);
}

TEST(WayToTurn, IsEndlessAlongAWallAndFacingIt) {
  const KeepOut keep_out = flap_before_wall();
  EXPECT_FALSE(std::isfinite(way_to_turn({-1.5, -0.4, 0.0}, keep_out, 1.0)));
  EXPECT_FALSE(std::isfinite(way_to_turn({0.0, -0.8, 0.5 * kPi}, keep_out, 1.0)));
  EXPECT_EQ(way_to_turn({0.0, -2.0, 0.5 * kPi}, keep_out, -1.0), 0.0);
}

TEST(Navigator, ComesStraightToAPlaceBesideABox) {
  const KeepOut keep_out = flap_before_wall();
  Random random(9);
  for (int i = 0; i < 60; ++i) {
    const BasePose start{random.uniform(-0.8, 0.8), random.uniform(-2.2, -1.4), random.uniform(-kPi, kPi)};
    const BasePose target{random.uniform(-0.1, 0.1), -0.9, i % 2 == 0 ? 0.0 : kPi};  // 11 cm to its side
    Navigator navigator({}, 0.01);
    navigator.set_target(start, target, &keep_out);
    BasePose base = start;
    BaseTwist actual;
    std::deque<BaseTwist> pipe(5);
    double nearest = 1e9;
    for (int k = 0; k < 9000 && !navigator.arrived(); ++k) {
      pipe.push_back(navigator.step(base));
      const double share = 0.01 / 0.11;
      actual = {actual.v + share * (pipe.front().v - actual.v), actual.w + share * (pipe.front().w - actual.w)};
      pipe.pop_front();
      base = integrate_base(base, actual.v, actual.w, 0.01);
      nearest = std::min(nearest, box_clearance(base, keep_out));
    }
    EXPECT_TRUE(navigator.arrived());
    EXPECT_GT(nearest, std::min(keep_out.margin, box_clearance(target, keep_out) - 0.01) - 0.02)
        << start.x << ", " << start.y << ", " << start.yaw;
  }
}

}  // namespace
}  // namespace ajar
