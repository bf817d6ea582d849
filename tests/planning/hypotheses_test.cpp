// Strategy: the grip's path of each hypothesis is compared with the rigid rotation or translation that it stands for, and
// with its own derivative; every hypothesis must start away from the wall. The hand's orientation is checked by its axes.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "ajar/core/so3.hpp"
#include "ajar/planning/hypotheses.hpp"

namespace ajar {
namespace {

HandleBelief handle(const Vector3d& bar) {
  HandleBelief belief;
  belief.position = Vector3d(1.0, 2.0, 0.9);
  belief.normal = Vector3d(0.6, -0.8, 0.0);
  belief.bar = bar;
  return belief;
}

TEST(Hypotheses, GripTurnsRigidlyAboutAnAxisInTheLeaf) {
  const HandleBelief belief = handle(Vector3d::UnitZ());
  for (const MechanismHypothesis& h : make_hypotheses(belief, {})) {
    EXPECT_NEAR(h.direction.norm(), 1.0, 1e-12) << h.name;
    EXPECT_NEAR(h.direction.dot(h.curvature), 0.0, 1e-12) << h.name;
    if (h.curvature.norm() == 0.0) continue;
    const Vector3d centre = belief.position + h.curvature.cross(h.direction) / h.curvature.squaredNorm();
    EXPECT_NEAR((belief.position - centre).dot(belief.normal), belief.standoff, 1e-12) << h.name;
    EXPECT_NEAR(h.travel * h.curvature.norm(), PlannerConfig{}.hinge_angle, 1e-12) << h.name;
    for (const double arc : {0.0, 0.1, 0.7 * h.travel}) {
      const HypothesisPoint point = point_at(h, arc);
      const Vector3d expected = centre + exp_so3(point.turned) * (belief.position - centre);
      EXPECT_NEAR((belief.position + point.shift - expected).norm(), 0.0, 1e-12) << h.name;
      const Vector3d slope = (point_at(h, arc + 1e-6).shift - point_at(h, arc - 1e-6).shift) / 2e-6;
      EXPECT_NEAR((slope - point.direction).norm(), 0.0, 1e-8) << h.name;
    }
  }
}

TEST(Hypotheses, NothingStartsIntoTheWall) {
  for (const Vector3d& bar : {Vector3d(0, 0, 1), Vector3d(0.8, 0.6, 0), Vector3d(0, 0, 0)}) {
    const HandleBelief belief = handle(bar);
    for (const MechanismHypothesis& h : make_hypotheses(belief, {}))
      EXPECT_GE(h.direction.dot(belief.normal), -1e-12) << h.name;
  }
}

TEST(Hypotheses, BarTellsWhatElseIsPlausible) {
  const auto count = [](const Vector3d& bar, const std::string& word) {
    int n = 0;
    for (const MechanismHypothesis& h : make_hypotheses(handle(bar), {}))
      n += h.name.find(word) != std::string::npos ? 1 : 0;
    return n;
  };
  const Vector3d level(0.8, 0.6, 0.0);
  EXPECT_EQ(count(Vector3d::UnitZ(), "hinge"), 4);
  EXPECT_EQ(count(level, "hinge"), 4);
  EXPECT_EQ(count(Vector3d::Zero(), "hinge"), 4);
  EXPECT_EQ(count(Vector3d::UnitZ(), "sliding"), 2);
  EXPECT_EQ(count(level, "sliding"), 0);
  EXPECT_EQ(count(level, "flap"), 1);
  EXPECT_EQ(count(Vector3d::UnitZ(), "flap"), 0);
  EXPECT_EQ(count(Vector3d::Zero(), "flap") + count(Vector3d::Zero(), "sliding"), 0);
}

TEST(Hypotheses, FlapGoesDownAndTowardsTheRobot) {
  const HandleBelief belief = handle(Vector3d(0.8, 0.6, 0.0));
  for (const MechanismHypothesis& h : make_hypotheses(belief, {})) {
    if (h.name != "flap") continue;
    EXPECT_TRUE(h.soft);
    const Vector3d shift = point_at(h, h.travel).shift;
    EXPECT_LT(shift.z(), -0.3);
    EXPECT_GT(shift.dot(belief.normal), 0.3);
    EXPECT_NEAR(std::abs(h.free_axis.dot(h.curvature.normalized())), 1.0, 1e-12);
  }
}

TEST(Hypotheses, WhatWasFeltIsTheOnlyOne) {
  HandleBelief belief = handle(Vector3d(0.8, 0.6, 0.0));
  const PlannerConfig config;
  // A flap of 0.4 m: it opens along the normal, about the bar's direction.
  belief.felt = FeltMechanism{.direction = belief.normal, .curvature = -belief.bar / 0.4, .bar_turns = true};
  std::vector<MechanismHypothesis> all = make_hypotheses(belief, config);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_NEAR(all[0].travel, 0.4 * config.hinge_angle, 1e-12);
  EXPECT_LT((all[0].free_axis - belief.bar).norm(), 1e-12);
  EXPECT_FALSE(all[0].soft);
  // Slides: outwards as far as a drawer, along the wall as far as a sliding door; a grip held fast has no free axis.
  belief.felt = FeltMechanism{.direction = belief.normal};
  EXPECT_EQ(make_hypotheses(belief, config).front().travel, config.drawer_travel);
  EXPECT_EQ(make_hypotheses(belief, config).front().free_axis.norm(), 0.0);
  belief.felt = FeltMechanism{.direction = belief.bar};
  EXPECT_EQ(make_hypotheses(belief, config).front().travel, config.sliding_travel);
}

TEST(Hypotheses, AHandOnAFreeBarFollowsADoorWhollyAndLeansOffAFlap) {
  for (const double turn : {-1.2, 0.3, 1.5}) {
    EXPECT_EQ(free_grip_turn(Vector3d::UnitZ(), turn), turn);
    const double lean = (turn - free_grip_turn(Vector3d::UnitX(), turn)) / turn;
    EXPECT_GT(lean, 0.0);                                      // the hand stays behind the leaf, on the side of the arm
    EXPECT_LT(std::abs(lean * turn), 0.5 * std::numbers::pi);  // and never comes to lie in it
    for (const Vector3d& bar : {Vector3d(Vector3d::UnitX()), Vector3d(Vector3d::UnitZ())}) {
      const double slope = (free_grip_turn(bar, turn + 1e-6) - free_grip_turn(bar, turn - 1e-6)) / 2e-6;
      EXPECT_NEAR(free_grip_share(bar, turn), slope, 1e-6);
    }
  }
}

// A flap of 0.4 m below a level handle at 1.0 m, standing 0.06 m before it; it opens along -y.
struct Flap {
  HandleBelief belief;
  FlapPress press;
};
Flap half_open() {
  Flap flap;
  flap.belief.position = Vector3d(0.0, -0.06, 1.0);
  flap.belief.normal = -Vector3d::UnitY();
  flap.belief.bar = Vector3d::UnitX();
  const Vector3d arm(0.0, -0.06, 0.4);  // from the axis
  const Vector3d axis = Vector3d::UnitX();
  const FeltMechanism felt{.direction = axis.cross(arm).normalized(), .curvature = axis / arm.norm(), .bar_turns = true};
  flap.press = make_press(felt, flap.belief.position, 0.8);
  flap.belief.press = flap.press;
  return flap;
}

TEST(Hypotheses, WhatComesDownIsAFlapHungBelowItsBar) {
  const Flap flap = half_open();
  EXPECT_TRUE(comes_down(flap.belief, flap.press.way));
  FeltMechanism lid = flap.press.way;  // hung above: it goes up
  lid.curvature = -lid.curvature;
  EXPECT_FALSE(comes_down(flap.belief, lid));
  EXPECT_FALSE(comes_down(flap.belief, {.direction = -Vector3d::UnitY(), .curvature = Vector3d::UnitZ() / 0.8}));
  EXPECT_FALSE(comes_down(flap.belief, {.direction = -Vector3d::UnitY()}));
}

TEST(Hypotheses, FingersPressOnTheInnerFaceOfAFlap) {
  const Flap flap = half_open();
  EXPECT_LT((flap.press.centre - Vector3d(0.0, 0.0, 0.6)).norm(), 1e-12);
  for (const double angle : {0.0, 0.5, 0.8, 1.5}) {
    const Vector3d tip = press_point(flap.belief, flap.press, angle);
    // Beyond the outer face, seen along its normal, and between axis and bar, seen along the leaf.
    const Vector3d normal(0.0, -std::cos(angle), -std::sin(angle));
    const Vector3d along(0.0, -std::sin(angle), std::cos(angle));
    EXPECT_LT((tip - flap.press.centre).dot(normal), -0.04) << angle;
    EXPECT_GT((tip - flap.press.centre).dot(along), 0.3) << angle;
    EXPECT_LT((tip - flap.press.centre).dot(along), 0.4) << angle;
    EXPECT_NEAR(pressed_opening(flap.belief, flap.press, tip + 0.05 * Vector3d::UnitX()), angle, 1e-12);
    EXPECT_NEAR(seen_opening(flap.press, normal), angle, 1e-12);
  }
}

TEST(Hypotheses, APressedFlapGoesOnFromWhereItStands) {
  const Flap flap = half_open();
  const PlannerConfig config;
  const std::vector<MechanismHypothesis> all = make_hypotheses(flap.belief, config);
  ASSERT_EQ(all.size(), 1U);
  const MechanismHypothesis& h = all.front();
  const Vector3d start = press_point(flap.belief, flap.press, flap.press.opened);
  for (const double arc : {0.05, 0.2}) {
    const double angle = flap.press.opened + arc * h.curvature.norm();
    EXPECT_LT((start + point_at(h, arc).shift - press_point(flap.belief, flap.press, angle)).norm(), 1e-12);
  }
  EXPECT_GT(h.travel * h.curvature.norm(), config.hinge_angle - flap.press.opened);
  EXPECT_TRUE(h.hand_stays);
}

TEST(GraspOrientation, HandMeetsTheLeafWithTheFingersAcrossTheBar) {
  for (const Vector3d& bar : {Vector3d(0, 0, 1), Vector3d(0.8, 0.6, 0), Vector3d(0, 0, 0), Vector3d(0.3, 0.2, 0.8)}) {
    const HandleBelief belief = handle(bar);
    for (const bool flip : {false, true}) {
      const Matrix3d R = grasp_orientation(belief, flip);
      EXPECT_NEAR((R.transpose() * R - Matrix3d::Identity()).norm(), 0.0, 1e-12);
      EXPECT_NEAR(R.determinant(), 1.0, 1e-12);
      EXPECT_NEAR((R.col(2) + belief.normal).norm(), 0.0, 1e-12);
      EXPECT_NEAR(R.col(1).dot(bar), 0.0, 1e-12);
    }
    const Matrix3d half_turn = grasp_orientation(belief, false).transpose() * grasp_orientation(belief, true);
    EXPECT_NEAR((half_turn - Vector3d(-1, -1, 1).asDiagonal().toDenseMatrix()).norm(), 0.0, 1e-12);
  }
}

}  // namespace
}  // namespace ajar
