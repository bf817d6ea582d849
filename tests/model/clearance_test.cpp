// Strategy: distances against an independent search (the distance of a point on a segment to a convex box is convex along
// the segment), rows against central differences of the distances themselves, signs and penetration on a toy robot with
// closed forms. Where two different points are equally near the distance has a kink; there the one-sided differences
// disagree and the row is compared with neither, but such states must be rare.
#include "ajar/model/clearance.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <tuple>

#include "ajar/core/error.hpp"
#include "model_fixtures.hpp"

namespace ajar {
namespace {

using Key = std::tuple<int, int, int>;  // shape, other shape, obstacle

Key key_of(const ClearanceRow& row) { return {row.shape, row.other_shape, row.obstacle}; }

double point_box_distance(const Vector3d& p, const Box& box) {
  const Vector3d local = (box.pose.inverse() * p).cwiseAbs() - box.half_extents;
  return local.cwiseMax(0.0).norm();
}

// Golden-section search over the segment; exact because the distance is convex there.
double capsule_box_distance(const Pose& X_WS, const CollisionShape& shape, const Box& box) {
  const Vector3d a = X_WS.translation() - shape.half_length * X_WS.linear().col(2);
  const Vector3d b = X_WS.translation() + shape.half_length * X_WS.linear().col(2);
  double low = 0.0, high = 1.0;
  for (int i = 0; i < 200; ++i) {
    const double m1 = low + (high - low) / 3.0, m2 = high - (high - low) / 3.0;
    const bool left = point_box_distance(a + m1 * (b - a), box) < point_box_distance(a + m2 * (b - a), box);
    (left ? high : low) = left ? m2 : m1;
  }
  return point_box_distance(a + 0.5 * (low + high) * (b - a), box) - shape.radius;
}

Box random_box(std::mt19937_64& rng) {
  std::uniform_real_distribution<double> place(-1.0, 1.0), size(0.05, 0.5), angle(-3.0, 3.0);
  Box box;
  box.pose.translation() = Vector3d(place(rng), place(rng), 1.0 + 0.6 * place(rng));
  box.pose.linear() = (Eigen::AngleAxisd(angle(rng), Vector3d::UnitZ()) * Eigen::AngleAxisd(angle(rng), Vector3d::UnitX()))
                          .toRotationMatrix();
  box.half_extents = Vector3d(size(rng), 0.2 * size(rng), size(rng));
  return box;
}

// A ball of radius 0.1 on a slide along x, 1 m above a base box of 0.4 m.
RobotModel ball_on_a_slide(const std::string& base = "differential") {
  const std::string urdf =
      "<robot name='ball'><link name='base_link'><collision><origin xyz='0 0 0.2'/><geometry><box size='0.4 0.4 "
      "0.4'/></geometry>"
      "</collision></link><link name='carriage'/><link name='ball'><collision><geometry><sphere "
      "radius='0.1'/></geometry></collision>"
      "</link><link name='hand'/>" +
      test::urdf_joint("lift", "prismatic", "base_link", "carriage", "xyz='0 0 1'", "0 0 1") +
      test::urdf_joint("slide", "prismatic", "carriage", "ball", "xyz='0 0 0'", "1 0 0") +
      test::urdf_joint("grip", "fixed", "ball", "hand", "xyz='0 0 0'") + "</robot>";
  const test::TemporaryFolder folder;
  return RobotModel::load(folder.write("ball.urdf", urdf),
                          folder.write("ball.toml", test::robot_toml("\"lift\", \"slide\"", 2, "hand", base)));
}

ClearanceResult evaluate(const RobotModel& model, ClearanceChecker& checker, const BasePose& base, const JointVector& q) {
  Kinematics k;
  ClearanceResult result;
  model.compute(base, q, k);
  checker.compute(model, base, result);
  return result;
}

Box wall_at(double x) {  // a plane facing -x
  Box wall;
  wall.pose.translation() = Vector3d(x + 0.5, 0.0, 1.0);
  wall.half_extents = Vector3d(0.5, 3.0, 3.0);
  return wall;
}

TEST(Clearance, BallBeforeAWallFollowsTheClosedForm) {
  const RobotModel model = ball_on_a_slide();
  ClearanceChecker checker(model, {});
  checker.set_obstacle(3, wall_at(1.0), MayTouch::Nothing);
  for (const double x :
       {0.8, 0.9, 0.9 + 1e-6, 0.95, 1.0, 1.0 + 1e-7, 1.05, 1.2}) {  // apart, touching, centre on the face, inside
    const JointVector q = (JointVector(2) << 0.0, x).finished();
    const ClearanceResult result = evaluate(model, checker, {}, q);
    ASSERT_EQ(result.count, 1) << x;
    const ClearanceRow& row = result.rows[0];
    EXPECT_NEAR(row.distance, 0.9 - x, 1e-6) << x;
    EXPECT_LT((row.normal + Vector3d::UnitX()).norm(), 1e-6) << x << ": from the wall to the robot";
    EXPECT_NEAR(row.point_on_obstacle.x(), 1.0, 1e-6) << x;
    EXPECT_EQ(row.obstacle, 3);
    EXPECT_EQ(row.kind, ClearanceKind::ArmWorld);
    EXPECT_NEAR(row.row[1], -1.0, 1e-6) << x << ": the slide drives into the wall";
    EXPECT_NEAR(row.row[3], -1.0, 1e-6) << x << ": so does the base";
    EXPECT_EQ(result.smallest[1], row.distance);
  }
}

TEST(Clearance, OwnBodyRowsDoNotDependOnTheBase) {
  const RobotModel model = ball_on_a_slide();
  ClearanceChecker checker(model, {});
  const ClearanceResult result = evaluate(model, checker, {1.0, 2.0, 0.7}, (JointVector(2) << -0.45, 0.0).finished());
  ASSERT_EQ(result.count, 1);
  EXPECT_NEAR(result.rows[0].distance, 0.05, 1e-6);
  EXPECT_EQ(result.rows[0].kind, ClearanceKind::Self);
  EXPECT_NEAR(result.rows[0].row[0], 1.0, 1e-6) << "lifting leaves the box";
  EXPECT_EQ(result.rows[0].row.tail(2).norm(), 0.0);
}

TEST(Clearance, BaseAgainstWallMovesWithDrivingOnly) {
  const RobotModel model = ball_on_a_slide();
  ClearanceChecker checker(model, {});
  checker.set_obstacle(0, wall_at(0.4), MayTouch::Hand);
  const ClearanceResult result = evaluate(model, checker, {0.0, 0.0, 0.2}, (JointVector(2) << 0.0, -1.0).finished());
  ASSERT_EQ(result.count, 1);
  // The front left corner leads: x = 0.2 cos 0.2 + 0.2 sin 0.2
  const double corner_x = 0.2 * (std::cos(0.2) + std::sin(0.2)), corner_y = 0.2 * (std::sin(0.2) - std::cos(0.2));
  EXPECT_NEAR(result.rows[0].distance, 0.4 - corner_x, 1e-6);
  EXPECT_EQ(result.rows[0].row.head(2).norm(), 0.0);
  EXPECT_NEAR(result.rows[0].row[2], corner_y, 1e-6) << "turning moves the corner along -x by its y";
  EXPECT_NEAR(result.rows[0].row[3], -std::cos(0.2), 1e-6);
}

TEST(Clearance, FixedBaseGetsNoRowsOfItsOwn) {
  const RobotModel model = ball_on_a_slide("fixed");
  ClearanceChecker checker(model, {});
  checker.set_obstacle(0, wall_at(0.3), MayTouch::Hand);
  const ClearanceResult result = evaluate(model, checker, {}, (JointVector(2) << 0.0, -1.0).finished());
  EXPECT_EQ(result.count, 0);
  EXPECT_NEAR(result.smallest[2], 0.1, 1e-6);
}

TEST(Clearance, FingersMayTouchWhatThePalmMustNot) {
  const RobotModel model = load_robot("heron");
  ClearanceChecker checker(model, {});
  Kinematics kinematics;
  model.compute({}, model.home(), kinematics);
  Box box;  // 4 cm beyond the tool centre point, across the hand's axis
  box.half_extents = Vector3d(0.3, 0.3, 0.01);
  box.pose = kinematics.X_WE * Eigen::Translation3d(0.0, 0.0, 0.05);
  const auto near = [&](MayTouch hand, const std::string& part) {
    checker.set_obstacle(0, box, hand);
    const ClearanceResult result = evaluate(model, checker, {}, model.home());
    return std::any_of(result.rows.begin(), result.rows.begin() + result.count, [&](const ClearanceRow& row) {
      return row.obstacle == 0 && model.shapes()[static_cast<std::size_t>(row.shape)].link == part;
    });
  };
  EXPECT_TRUE(near(MayTouch::Nothing, "left_finger"));
  EXPECT_FALSE(near(MayTouch::Fingers, "left_finger"));
  EXPECT_FALSE(near(MayTouch::Fingers, "right_finger"));
  EXPECT_TRUE(near(MayTouch::Fingers, "gripper"));
  EXPECT_FALSE(near(MayTouch::Hand, "gripper"));
}

TEST(Clearance, HandMayTouchWhatIsNearTheHand) {
  const RobotModel model = ball_on_a_slide();
  ClearanceChecker checker(model, {});
  const JointVector q = (JointVector(2) << 0.0, 0.85).finished();
  checker.set_obstacle(0, wall_at(1.0), MayTouch::Hand);
  EXPECT_EQ(evaluate(model, checker, {}, q).count, 0);
  checker.set_obstacle(0, wall_at(1.0), MayTouch::Nothing);
  EXPECT_EQ(evaluate(model, checker, {}, q).count, 1);
  checker.clear_obstacle(0);
  const ClearanceResult result = evaluate(model, checker, {}, q);
  EXPECT_EQ(result.count, 0);
  EXPECT_EQ(result.smallest[1], std::numeric_limits<double>::infinity());
}

TEST(Clearance, DistancesOfHeronEqualAnIndependentSearch) {
  const RobotModel model = load_robot("heron");
  std::mt19937_64 rng(21);
  int compared = 0;
  for (int s = 0; s < 300; ++s) {
    ClearanceChecker checker(model, {});
    const Box box = random_box(rng);
    checker.set_obstacle(0, box, MayTouch::Nothing);
    const JointVector q = test::random_posture(model, rng);
    const ClearanceResult result = evaluate(model, checker, {0.1, -0.2, 0.3}, q);
    std::map<int, double> seen;
    for (int i = 0; i < result.count; ++i) {
      if (result.rows[static_cast<std::size_t>(i)].kind == ClearanceKind::ArmWorld) {
        seen[result.rows[static_cast<std::size_t>(i)].shape] = result.rows[static_cast<std::size_t>(i)].distance;
      }
    }
    for (std::size_t i = 0; i < model.shapes().size(); ++i) {
      const CollisionShape& shape = model.shapes()[i];
      if (shape.joint < 0 || result.count == kMaxClearanceRows) {
        continue;
      }
      const double truth =
          capsule_box_distance(model.joint_pose(shape.joint, {0.1, -0.2, 0.3}) * shape.pose_in_joint, shape, box);
      const auto found = seen.find(static_cast<int>(i));
      if (truth > 0.15) {
        ASSERT_TRUE(found == seen.end()) << "farther than the influence";
      } else if (truth > -shape.radius + 1e-6) {  // the axis itself is outside of the box
        ASSERT_TRUE(found != seen.end());
        ASSERT_NEAR(found->second, truth, 1e-6);
        ++compared;
      } else {
        ASSERT_TRUE(found != seen.end());
        ASSERT_LE(found->second, -shape.radius + 1e-6) << "deeper than the radius";
      }
    }
  }
  EXPECT_GT(compared, 100);
}

TEST(Clearance, RowsOfHeronEqualCentralDifferences) {
  const RobotModel model = load_robot("heron");
  std::mt19937_64 rng(22);
  std::uniform_real_distribution<double> rate(-1.0, 1.0);
  ClearanceChecker checker(model, {});
  constexpr double h = 1e-5;
  int compared = 0, kinks = 0;
  for (int s = 0; s < 2000; ++s) {
    checker.set_obstacle(0, random_box(rng), MayTouch::Nothing);
    checker.set_obstacle(1, random_box(rng), MayTouch::Nothing);
    const BasePose base{0.2 * rate(rng), 0.2 * rate(rng), rate(rng)};
    const JointVector q = test::random_posture(model, rng);
    InputVector u(8);
    for (Eigen::Index i = 0; i < 8; ++i) {
      u[i] = rate(rng);
    }
    std::map<Key, double> side[2];
    for (int k : {0, 1}) {
      const double dt = k == 0 ? -h : h;
      const ClearanceResult r =
          evaluate(model, checker, integrate_base(base, u[7], u[6], dt), JointVector(q + dt * u.head(6)));
      for (int i = 0; i < r.count; ++i) {
        side[k][key_of(r.rows[static_cast<std::size_t>(i)])] = r.rows[static_cast<std::size_t>(i)].distance;
      }
    }
    const ClearanceResult result = evaluate(model, checker, base, q);
    for (int i = 0; i < result.count; ++i) {
      const ClearanceRow& row = result.rows[static_cast<std::size_t>(i)];
      const auto before = side[0].find(key_of(row)), after = side[1].find(key_of(row));
      if (before == side[0].end() || after == side[1].end()) {
        continue;
      }
      const double backward = (row.distance - before->second) / h, forward = (after->second - row.distance) / h;
      if (std::abs(forward - backward) > 1e-2) {
        ++kinks;
        continue;
      }
      ++compared;
      ASSERT_NEAR(0.5 * (forward + backward), row.row * u, 1e-6)
          << "shape " << row.shape << " distance " << row.distance << " state " << s;
    }
  }
  EXPECT_GT(compared, 5000);
  EXPECT_LT(kinks, compared / 50);
}

TEST(Clearance, RowsAreSortedAndBounded) {
  const RobotModel model = load_robot("heron");
  std::mt19937_64 rng(23);
  ClearanceChecker checker(model, {});
  for (int i = 0; i < kMaxObstacles; ++i) {
    checker.set_obstacle(i, random_box(rng), MayTouch::Nothing);
  }
  checker.set_obstacle(kMaxObstacles, random_box(rng), MayTouch::Nothing);  // no such place: ignored
  int fullest = 0;
  for (int s = 0; s < 200; ++s) {
    const ClearanceResult result = evaluate(model, checker, {}, test::random_posture(model, rng));
    fullest = std::max(fullest, result.count);
    const ClearanceConfig config;
    double last = -std::numeric_limits<double>::infinity();
    for (int i = 0; i < result.count; ++i) {
      const ClearanceRow& row = result.rows[static_cast<std::size_t>(i)];
      const ClearanceLimits& limit = row.kind == ClearanceKind::Self       ? config.self
                                     : row.kind == ClearanceKind::ArmWorld ? config.arm_world
                                                                           : config.base_world;
      ASSERT_GE(row.distance - limit.stop, last);
      ASSERT_NEAR(row.normal.norm(), 1.0, 1e-9);
      last = row.distance - limit.stop;
    }
  }
  EXPECT_EQ(fullest, kMaxClearanceRows);
}

// A box comes near by sliding, turning or growing alone; a checker that knows nothing of the way there is the judge.
TEST(Clearance, SkippedPairsAreSeenAsSoonAsTheyAreNear) {
  const RobotModel model = ball_on_a_slide();
  const JointVector q = JointVector::Zero(2);
  for (const std::string motion : {"slide", "turn", "grow", "drive"}) {
    ClearanceChecker checker(model, {});
    int rows = 0;
    for (int tick = 0; tick <= 400; ++tick) {
      const double way = tick / 400.0;
      Box bar;  // across, 0.6 m before the ball
      bar.half_extents = Vector3d(0.02, motion == "grow" ? 0.1 + 0.5 * way : 0.6, 0.02);
      bar.pose.translation() = Vector3d(motion == "slide" ? 0.6 - 0.5 * way : 0.6, motion == "grow" ? 0.8 : 0.0, 1.0);
      if (motion == "turn") bar.pose.rotate(Eigen::AngleAxisd(0.5 * M_PI * way, Vector3d::UnitZ()));
      const BasePose base{motion == "grow" ? 0.6 : motion == "drive" ? 0.5 * way : 0.0, 0.0, 0.0};
      ClearanceChecker judge(model, {});
      checker.set_obstacle(0, bar, MayTouch::Nothing);
      judge.set_obstacle(0, bar, MayTouch::Nothing);
      const ClearanceResult a = evaluate(model, checker, base, q), b = evaluate(model, judge, base, q);
      ASSERT_EQ(a.count, b.count) << motion << " " << tick;
      ASSERT_EQ(a.smallest, b.smallest) << motion << " " << tick;
      rows += a.count;
    }
    EXPECT_GT(rows, 20) << motion;
    EXPECT_LT(rows, 380) << motion;
  }
}

// The same for steps of every size, from a tick at 1 rad/s to a planner's posture, and obstacles that come and go.
TEST(Clearance, RememberedPairsChangeNothing) {
  const RobotModel model = load_robot("heron");
  std::mt19937_64 rng(24);
  std::uniform_real_distribution<double> unit(-1.0, 1.0);
  ClearanceChecker checker(model, {});
  JointVector q = model.home();
  std::array<Box, 3> boxes = {random_box(rng), random_box(rng), random_box(rng)};
  for (int tick = 0; tick < 3000; ++tick) {
    const double step = tick % 500 == 0 ? 1.0 : 2e-3 * std::pow(10.0, unit(rng));
    q += step * JointVector::NullaryExpr(q.size(), [&] { return unit(rng); });
    ClearanceChecker judge(model, {});
    for (int i = 0; i < 3; ++i) {
      Box& box = boxes[static_cast<std::size_t>(i)];
      box.pose.translation() += step * Vector3d(unit(rng), unit(rng), unit(rng));
      const auto hand = static_cast<MayTouch>((tick / 700 + i) % 3);
      for (ClearanceChecker* c : {&checker, &judge}) {
        (tick / 300 + i) % 4 == 0 ? c->clear_obstacle(i) : c->set_obstacle(i, box, hand);
      }
    }
    const ClearanceResult a = evaluate(model, checker, {}, q), b = evaluate(model, judge, {}, q);
    ASSERT_EQ(a.count, b.count) << tick;
    ASSERT_EQ(a.smallest, b.smallest) << tick;
  }
}

TEST(Clearance, HomeOfHeronIsClearOfItself) {
  const RobotModel model = load_robot("heron");
  ClearanceChecker checker(model, {});
  EXPECT_GT(evaluate(model, checker, {}, model.home()).smallest[0], 0.08);
  for (const CollisionShape& shape : model.shapes()) {  // and above the outline of the base: 0.898 x 0.584 m
    if (shape.joint < 0) {
      continue;
    }
    const Pose X = model.joint_pose(shape.joint, {}) * shape.pose_in_joint;
    for (const double end : {-1.0, 1.0}) {
      const Vector3d p = X.translation() + end * shape.half_length * X.linear().col(2);
      EXPECT_LT(p.x() + shape.radius, 0.487) << shape.link;
      EXPECT_GT(p.x() - shape.radius, -0.411) << shape.link;
      EXPECT_LT(std::abs(p.y()) + shape.radius, 0.292) << shape.link;
    }
  }
}

TEST(Clearance, NonFiniteInputsAreReadCautiously) {
  const RobotModel model = load_robot("heron");
  ClearanceChecker checker(model, {});
  const double nan = std::numeric_limits<double>::quiet_NaN();
  JointVector q = model.home();
  q[2] = nan;
  for (const ClearanceResult& result :
       {evaluate(model, checker, {}, q), evaluate(model, checker, {nan, 0.0, 0.0}, model.home())}) {
    EXPECT_EQ(result.count, 0);
    EXPECT_EQ(result.smallest[0], 0.0);
  }
  Box broken;
  broken.pose.translation().x() = nan;
  checker.set_obstacle(0, broken, MayTouch::Nothing);
  EXPECT_EQ(evaluate(model, checker, {}, model.home()).smallest[1], std::numeric_limits<double>::infinity());
}

TEST(Clearance, CopiesMeasureTheSame) {
  const RobotModel model = load_robot("heron");
  ClearanceChecker checker(model, {});
  checker.set_obstacle(0, wall_at(0.5), MayTouch::Nothing);
  ClearanceChecker copy(checker);
  const ClearanceResult a = evaluate(model, checker, {}, model.home()), b = evaluate(model, copy, {}, model.home());
  ASSERT_EQ(a.count, b.count);
  for (int i = 0; i < a.count; ++i) {
    EXPECT_EQ(a.rows[static_cast<std::size_t>(i)].distance, b.rows[static_cast<std::size_t>(i)].distance);
  }
}

TEST(Clearance, RefusesLimitsThatMakeNoSense) {
  const RobotModel model = ball_on_a_slide();
  ClearanceConfig config;
  config.self.stop = 0.5;
  EXPECT_THROW(ClearanceChecker(model, config), ConfigError);
  config = {};
  config.base_world.rate = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(ClearanceChecker(model, config), ConfigError);
}

}  // namespace
}  // namespace ajar
