// Strategy: the grip's path of each hypothesis is compared with the rigid rotation or translation that it stands for, and
// with its own derivative; every hypothesis must start away from the wall. The hand's orientation is checked by its axes.
#include <gtest/gtest.h>

#include <cmath>

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

TEST(Hypotheses, AHandOnAFreeBarFollowsADoorWhollyAndAFlapInPart) {
  for (const double turn : {-1.2, 0.3, 1.5}) {
    EXPECT_EQ(free_grip_turn(Vector3d::UnitZ(), turn), turn);
    const double part = free_grip_turn(Vector3d::UnitX(), turn) / turn;
    EXPECT_GT(part, 0.0);
    EXPECT_LT(part, 0.5);  // at a right angle it still comes from the front
  }
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
