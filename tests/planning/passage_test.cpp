// Strategy: a door of known geometry, closed and ajar, hinged on either side and seen from any heading. Axis, walls and the
// middle of the way must come out where plane geometry puts them; the hand must turn its back to the hinge.
#include "ajar/planning/passage.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "ajar/core/so3.hpp"
#include "ajar/planning/hypotheses.hpp"

namespace ajar {
namespace {

// Leaf frame: x right, y into the wall. The axis stands 4 cm behind the leaf's face, 1.5 cm beside the frame.
constexpr double kRadius = 0.8;
constexpr double kAxisDepth = 0.04;
constexpr double kStandoff = 0.06;
constexpr double kBeyond = 0.06;  // what the goal asks for beyond the wanted angle [rad]

struct Door {
  double side;  // +1 hinged on the right
  double yaw;
  double angle;  // how far open
};

Vector3d axis_of(const Door& door) { return {door.side * kRadius, kAxisDepth, 1.0}; }

HandleBelief belief_of(const Door& door) {
  const Matrix3d open = exp_so3(Vector3d(0.0, 0.0, -door.side * door.angle));
  const Matrix3d R = exp_so3(Vector3d(0.0, 0.0, door.yaw));
  const Vector3d grip = axis_of(door) + open * (Vector3d(0.0, -kStandoff, 1.0) - axis_of(door));
  const Vector3d strike(-0.09 * door.side, 0.0, 0.0);
  const Vector3d hinge(door.side * (kRadius + 0.015), 0.0, 0.0);
  HandleBelief belief;
  belief.position = R * grip;
  belief.normal = R * open * -Vector3d::UnitY();
  belief.standoff = kStandoff;
  belief.doorway = door.side > 0.0 ? Doorway{R * strike, R * hinge} : Doorway{R * hinge, R * strike};
  return belief;
}

constexpr Door kDoors[] = {{1.0, 0.0, 0.0}, {-1.0, 0.0, 0.0}, {1.0, 2.0, 0.2}, {-1.0, -1.3, 0.15}, {1.0, 3.1, 0.0}};

Passage passage_of(const Door& door) {
  return *make_passage(belief_of(door), door.side > 0.0 ? HingeSide::Right : HingeSide::Left);
}

TEST(Passage, TheAxisIsFoundFromTheFrameAndTheLeafAsItStands) {
  for (const Door& door : kDoors) {
    const Matrix3d R = exp_so3(Vector3d(0.0, 0.0, door.yaw));
    const Passage passage = passage_of(door);
    EXPECT_EQ(likely_side(belief_of(door)), door.side > 0.0 ? HingeSide::Right : HingeSide::Left);
    EXPECT_NEAR(passage.opened, door.angle, 1e-12);
    EXPECT_LT((passage.inward - R * Vector3d::UnitY()).norm(), 1e-12);
    EXPECT_LT((passage_axis(belief_of(door), passage) - R * axis_of(door)).norm(), 1e-9);
  }
}

TEST(Passage, ThePushedLeafTurnsAboutThatAxisIntoTheDoorway) {
  for (const Door& door : kDoors) {
    const Matrix3d R = exp_so3(Vector3d(0.0, 0.0, door.yaw));
    HandleBelief belief = belief_of(door);
    belief.passage = passage_of(door);
    const std::vector<MechanismHypothesis> hypotheses = make_hypotheses(belief, {});
    ASSERT_EQ(hypotheses.size(), 1U);
    const MechanismHypothesis& h = hypotheses.front();
    const Vector3d centre = belief.position + h.curvature.cross(h.direction) / h.curvature.squaredNorm();
    EXPECT_LT((centre - R * axis_of(door)).norm(), 1e-9);
    EXPECT_GT(h.direction.dot(belief.passage->inward), 0.9);
    EXPECT_NEAR(h.travel * h.curvature.norm() + door.angle, PlannerConfig{}.hinge_angle + kBeyond, 1e-12);
  }
}

TEST(Passage, TheWayRunsInTheMiddleOfWhatTheOpenLeafLeaves) {
  for (const Door& door : kDoors) {
    const Passage passage = passage_of(door);
    const BaseLine line = passage_line(passage);
    const Vector3d across = (passage.hinge - passage.strike).normalized();
    const double to_strike = across.dot(line.point - passage.strike);
    EXPECT_NEAR(passage_width(passage), kRadius + 0.105 - 0.07, 1e-12);
    EXPECT_NEAR(to_strike, 0.5 * passage_width(passage), 1e-12);
    EXPECT_LT((line.direction - passage.inward).norm(), 1e-12);
    const std::array<Box, 2> walls = passage_walls(passage);
    for (const Box& wall : walls) {
      EXPECT_NEAR(wall.pose.linear().determinant(), 1.0, 1e-12);
      EXPECT_NEAR(passage.inward.dot(wall.pose.translation() - passage.strike), wall.half_extents.y(), 1e-12);
    }
    EXPECT_NEAR(across.dot(passage.strike - walls[0].pose.translation()), walls[0].half_extents.x(), 1e-12);
    EXPECT_NEAR(across.dot(walls[1].pose.translation() - passage.hinge), walls[1].half_extents.x(), 1e-12);
  }
}

// A leaf of 1 m that pivots 0.3 m inside its frame, its axis in the middle of the leaf.
TEST(Passage, APivotWithinTheLeafStandsForTheEdgeOfTheFrame) {
  constexpr double kOverhang = 0.3;
  for (const Door& door : kDoors) {
    if (door.angle > 0.0) continue;
    const Matrix3d R = exp_so3(Vector3d(0.0, 0.0, door.yaw));
    const HandleBelief belief = belief_of(door);
    const Passage hinged = passage_of(door);
    const Vector3d axis(door.side * (kRadius - kOverhang), 0.5 * kAxisDepth, 1.0);
    const double radius = (axis - Vector3d(0.0, -kStandoff, 1.0)).norm();
    const std::optional<Passage> pivot = pivot_passage(belief, hinged, radius);
    ASSERT_TRUE(pivot.has_value());
    EXPECT_NEAR(pivot->overhang, kOverhang, 1e-12);
    EXPECT_LT((passage_axis(belief, *pivot) - R * axis).norm(), 1e-9);
    EXPECT_NEAR(passage_curvature(belief, *pivot).norm(), 1.0 / radius, 1e-9);
    EXPECT_NEAR(passage_width(*pivot), passage_width(hinged) - kOverhang + 0.5 * kAxisDepth, 1e-12);
    // What swings back lies within the wall beyond the axis: its tip on all of the way is no farther out than `overhang`.
    const Box beyond = passage_walls(*pivot)[1];
    for (const double angle : {0.1, 0.8, 1.5}) {
      const Vector3d open = exp_so3(Vector3d(0.0, 0.0, -door.side * angle)) * Vector3d(door.side * kOverhang, 0.0, 0.0);
      const Vector3d tip = beyond.pose.inverse() * Vector3d(R * (axis + open + Vector3d(0.0, -0.5 * kAxisDepth, 0.0)));
      EXPECT_LT(std::abs(tip.y()), beyond.half_extents.y() + 1e-12);
    }
  }
}

TEST(Passage, ALeafHingedAtItsFrameIsNoPivot) {
  for (const Door& door : kDoors) {
    const HandleBelief belief = belief_of(door);
    const Passage hinged = passage_of(door);
    const double radius = 1.0 / passage_curvature(belief, hinged).norm();
    EXPECT_FALSE(pivot_passage(belief, hinged, radius).has_value());
    EXPECT_FALSE(pivot_passage(belief, hinged, radius - 0.07).has_value());
    EXPECT_FALSE(pivot_passage(belief, hinged, 0.5 * kStandoff).has_value());
    EXPECT_FALSE(pivot_passage(belief, hinged, std::numeric_limits<double>::quiet_NaN()).has_value());
  }
}

TEST(Passage, TheHandTurnsItsBackToTheHinge) {
  for (const Door& door : kDoors) {
    const HandleBelief belief = belief_of(door);
    const Passage passage = passage_of(door);
    const Matrix3d R = turned_to_hinge(grasp_orientation(belief, false), passage, 0.8);
    const Vector3d to_axis = (passage_axis(belief, passage) - belief.position).normalized();
    EXPECT_GT(-R.col(2).dot(to_axis), 0.5);
    EXPECT_NEAR(-R.col(2).dot(belief.normal), std::cos(0.8), 1e-12);
  }
}

TEST(Passage, SaysHowMuchRoomIsLeft) {
  const RobotModel model = load_robot("heron");
  EXPECT_NEAR(base_width(model), 0.584, 1e-6);
  Passage narrow = passage_of(kDoors[0]);
  narrow.hinge = narrow.strike + Vector3d(0.62 + 0.07, 0.0, 0.0);  // 7 cm of leaf and gap when it stands open
  EXPECT_EQ(passage_room(narrow, model), "base 0.58 m wide, opening 0.62 m: 0.02 m each side");
}

TEST(Passage, NeedsADoorwayOfSomeWidth) {
  HandleBelief belief = belief_of(kDoors[0]);
  belief.doorway->right = belief.doorway->left + Vector3d(0.1, 0.0, 0.0);
  EXPECT_FALSE(make_passage(belief, HingeSide::Left).has_value());
  belief.doorway->right.setConstant(std::numeric_limits<double>::quiet_NaN());
  EXPECT_FALSE(make_passage(belief, HingeSide::Left).has_value());
  belief.doorway.reset();
  EXPECT_FALSE(make_passage(belief, HingeSide::Left).has_value());
}

TEST(Passage, ALeafBehindItsFrameLiesInAReveal) {
  constexpr double kDepth = 0.1;
  constexpr double kGivenUp = 0.025;  // of the clearance beside a reaching hand
  for (const Door& door : kDoors) {
    if (door.angle > 0.0) continue;
    const Matrix3d R = exp_so3(Vector3d(0.0, 0.0, door.yaw));
    HandleBelief belief = belief_of(door);
    EXPECT_EQ(reveal_depth(belief), 0.0);
    EXPECT_FALSE(reveal_walls(belief));
    const Vector3d forward = kDepth * belief.normal;
    belief.doorway = Doorway{belief.doorway->left + forward, belief.doorway->right + forward};
    EXPECT_NEAR(reveal_depth(belief), kDepth, 1e-12);
    const auto walls = reveal_walls(belief);
    ASSERT_TRUE(walls);
    const double edges[] = {-0.09, kRadius + 0.015};  // strike, hinge
    for (std::size_t i = 0; i < 2; ++i) {
      const Box& wall = (*walls)[i];
      const Vector3d centre = R.transpose() * wall.pose.translation();
      EXPECT_NEAR(centre.y() - wall.half_extents.y(), -kDepth, 1e-12);
      const double outward = i == 0 ? -door.side : door.side;
      EXPECT_NEAR(centre.x() - outward * wall.half_extents.x(), door.side * edges[i] + outward * kGivenUp, 1e-12);
    }
    belief.passage = passage_of(door);
    EXPECT_EQ(reveal_depth(belief), 0.0);
  }
}

TEST(Passage, TheFirstCentimetresTellWhatTheCameraMisread) {
  constexpr double kArc = 0.06;
  for (const Door& door : kDoors) {
    for (const double error : {-0.15, 0.0, 0.08}) {
      const HandleBelief seen = turned_about_handle(belief_of(door), error);
      const Passage passage = *make_passage(seen, door.side > 0.0 ? HingeSide::Right : HingeSide::Left);
      HandleBelief truth = belief_of(door);
      truth.passage = passage_of(door);
      const MechanismHypothesis h = make_hypotheses(truth, {}).front();
      const HypothesisPoint after = point_at(h, kArc);
      EXPECT_NEAR(felt_misreading(seen, passage, after.direction, kArc), -error, 1e-9);
      // A chord points as the path does at its middle.
      EXPECT_NEAR(felt_misreading(seen, passage, after.shift, 0.5 * kArc), -error, 1e-9);
      const HandleBelief corrected = turned_about_handle(seen, -error);
      EXPECT_LT((corrected.doorway->left - truth.doorway->left).norm(), 1e-12);
      EXPECT_LT((corrected.normal - truth.normal).norm(), 1e-12);
    }
  }
}

}  // namespace
}  // namespace ajar
