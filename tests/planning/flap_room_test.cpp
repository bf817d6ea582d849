// Strategy: the outline on the floor against the corners of the believed leaf; the way off against the turns that the base
// could not make where it stood and can make where it gets to.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ajar/planning/believed_scene.hpp"
#include "ajar/planning/flap_room.hpp"
#include "ajar/planning/hypotheses.hpp"

namespace ajar {
namespace {

constexpr double kPi = std::numbers::pi;

// A flap of 0.4 m, hung at 0.3 m, in a wall that looks to -y turned by `turn`.
struct Flap {
  HandleBelief belief;
  FlapPress press;
};

Flap flap(double turn, double opened) {
  const Matrix3d R = Eigen::AngleAxisd(turn, Vector3d::UnitZ()).toRotationMatrix();
  const FeltMechanism way{.direction = R * -Vector3d::UnitY(), .curvature = R * Vector3d::UnitX() / 0.4};
  HandleBelief belief;
  belief.position = Vector3d(1.0, 2.0, 0.7);
  belief.normal = way.direction;
  belief.bar = R * Vector3d::UnitX();
  const FlapPress press = make_press(way, belief.position, opened);
  belief.press = press;
  return {belief, press};
}

// Whether it turns on the spot without its corners meeting the flap.
bool swings_clear(BasePose base, const KeepOut& beside) {
  double gap = 1e9;
  for (base.yaw = -kPi; base.yaw < kPi; base.yaw += 0.01) gap = std::min(gap, box_clearance(base, beside));
  return gap > 0.05;
}

// Largest distances of the leaf's corners from the middle of the rectangle, seen from above.
Vector2d farthest_corners(const Box& leaf, const FloorBox& floor) {
  const Vector2d across(-floor.along.y(), floor.along.x());
  Vector2d most = Vector2d::Zero();
  for (int corner = 0; corner < 8; ++corner) {
    const Vector3d signs(corner & 1 ? 1.0 : -1.0, corner & 2 ? 1.0 : -1.0, corner & 4 ? 1.0 : -1.0);
    const Vector2d from = (leaf.pose * leaf.half_extents.cwiseProduct(signs)).head<2>() - floor.centre;
    most = most.cwiseMax(Vector2d(std::abs(from.dot(floor.along)), std::abs(from.dot(across))));
  }
  return most;
}

TEST(FlapRoom, TheFloorBeneathAFlapIsWhereItsCornersStandAbove) {
  for (const double turn : {0.0, 0.7, -2.5}) {
    for (const double opened : {0.1, 0.8, 1.5}) {
      const Flap f = flap(turn, opened);
      const FloorBox floor = beside_flap(f.belief, f.press, opened).box.value_or(FloorBox());
      const Vector2d most = farthest_corners(leaf_pressed(f.belief, f.press, opened), floor);
      EXPECT_LT((most - floor.half_extents).norm(), 1e-12) << turn << ", " << opened;
    }
  }
}

TEST(FlapRoom, TheWallBesideAFeltFlapIsThePlaneOfItsFace) {
  HandleBelief belief = flap(0.4, 0.8).belief;
  const auto before_face = [&] {
    const Box wall = believed_wall(belief);
    const Vector3d face = belief.position - belief.standoff * belief.normal;
    return (wall.pose.translation() - face).dot(belief.normal) + wall.half_extents.y();
  };
  EXPECT_NEAR(before_face(), 0.0, 1e-12);
  belief.press.reset();
  EXPECT_NEAR(before_face(), 0.02, 1e-12);  // as far as sight may err
}

// A base whose axle stands half a metre before the edge of the flap: too near to turn.
void leads_away(const Flap& flap, double heading) {
  const KeepOut beside = beside_flap(flap.belief, flap.press, 0.5 * kPi);
  const Vector2d p = flap.belief.position.head<2>() + 0.95 * beside.normal;
  const BasePose base{p.x(), p.y(), heading};
  const double way = way_off_flap(base, beside);
  EXPECT_FALSE(swings_clear(base, beside));
  EXPECT_GE(way * Vector2d(std::cos(heading), std::sin(heading)).dot(beside.normal), 0.0) << heading;
  EXPECT_TRUE(swings_clear(integrate_base(base, way, 0.0, 1.0), beside)) << heading;
}

TEST(FlapRoom, TheWayOffLeadsAwayFromTheWallToWhereTheBaseTurns) {
  for (const double heading : {0.0, 0.6, 1.5, 2.2, 3.0, -1.0, -2.6}) {
    leads_away(flap(0.0, 1.5), heading);
    leads_away(flap(1.1, 1.5), heading);
  }
}

TEST(FlapRoom, FarFromAFlapABaseTurnsWhereItStands) {
  const auto [belief, press] = flap(0.5, 1.5);
  const KeepOut beside = beside_flap(belief, press, 0.5 * kPi);
  const Vector2d far = belief.position.head<2>() + 2.0 * beside.normal;
  EXPECT_EQ(way_off_flap({far.x(), far.y(), 0.3}, beside), 0.0);
}

}  // namespace
}  // namespace ajar
