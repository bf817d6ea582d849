// Strategy: the value by its slope in each part; roll-outs of a known good posture must follow the path to its end, stand
// still before a wall, and give up early exactly when the value is already lost.
#include <gtest/gtest.h>

#include <cmath>

#include "ajar/planning/believed_scene.hpp"
#include "ajar/planning/grasp_planner.hpp"
#include "ajar/planning/roll_out.hpp"

namespace ajar {
namespace {

TEST(RollOutValue, FallsWithEveryShortfall) {
  RollOutResult good;
  good.sigma = 0.1;
  good.fraction = 1.0;
  const double value = roll_out_value(good, false);
  EXPECT_NEAR(value, 0.1, 1e-12);
  const auto worse = [&](double RollOutResult::*part, double to) {
    RollOutResult bad = good;
    bad.*part = to;
    return roll_out_value(bad, false);
  };
  EXPECT_NEAR(worse(&RollOutResult::own, 0.01), value - 0.04, 1e-12);
  EXPECT_NEAR(worse(&RollOutResult::arm, 0.02), value - 0.04, 1e-12);
  EXPECT_NEAR(worse(&RollOutResult::base, 0.04), value - 0.04, 1e-12);
  EXPECT_NEAR(worse(&RollOutResult::fraction, 0.89), value - 0.1, 1e-12);
  EXPECT_NEAR(worse(&RollOutResult::error, 0.05), value - 0.03, 1e-12);
  EXPECT_NEAR(worse(&RollOutResult::sigma, 0.5), 0.12, 1e-12);
  EXPECT_GT(roll_out_value(good, true), 0.06);
}

class RollOutTest : public ::testing::Test {
 protected:
  void SetUp() override {
    belief_.position = Vector3d(0.0, 0.0, 1.0);
    PlannerConfig config;
    config.roll_outs = 30;
    config.kept = 2;
    const GraspPlanner planner(model_, config, {}, {}, {});
    const std::vector<GraspCandidate> found = planner.choose(belief_, 2);
    ASSERT_FALSE(found.empty());
    grasp_ = found.front();
  }
  MechanismHypothesis drawer() const {
    MechanismHypothesis out;
    out.direction = belief_.normal;
    out.travel = 0.4;
    return out;
  }

  RobotModel model_ = load_robot("heron");
  HandleBelief belief_;
  GraspCandidate grasp_;
  RollOut roll_out_{model_, {}, {}, {}, {}};
};

TEST_F(RollOutTest, DrawerIsPulledToItsEnd) {
  const RollOutResult result = roll_out_.run(belief_, drawer(), grasp_.base, grasp_.grasp, -1e9);
  EXPECT_GE(result.fraction, 0.999);
  EXPECT_LT(result.error, 0.01);
  EXPECT_GT(result.sigma, 0.05);
  EXPECT_GE(result.own, 0.019);
}

TEST_F(RollOutTest, SameRollOutTwiceGivesTheSame) {
  const RollOutResult a = roll_out_.run(belief_, drawer(), grasp_.base, grasp_.grasp, -1e9);
  MechanismHypothesis other = drawer();
  other.direction = Vector3d::UnitX();
  static_cast<void>(roll_out_.run(belief_, other, grasp_.base, grasp_.grasp, -1e9));
  const RollOutResult b = roll_out_.run(belief_, drawer(), grasp_.base, grasp_.grasp, -1e9);
  EXPECT_EQ(a.value, b.value);
  EXPECT_EQ(a.sigma, b.sigma);
}

TEST_F(RollOutTest, MovingIntoTheWallStandsStill) {
  MechanismHypothesis inward = drawer();
  inward.direction = -belief_.normal;
  inward.travel = 1.2;
  const RollOutResult result = roll_out_.run(belief_, inward, grasp_.base, grasp_.grasp, -1e9);
  EXPECT_LT(result.fraction, 0.9);
  EXPECT_LT(result.value, 0.0);
  EXPECT_GT(result.arm, 0.0);
  EXPECT_GT(result.base, 0.0);
}

TEST_F(RollOutTest, GivesUpOnceTheValueIsLost) {
  const double full = roll_out_.run(belief_, drawer(), grasp_.base, grasp_.grasp, -1e9).value;
  EXPECT_EQ(roll_out_.run(belief_, drawer(), grasp_.base, grasp_.grasp, full - 1e-6).value, full);
  const RollOutResult hopeless = roll_out_.run(belief_, drawer(), grasp_.base, grasp_.grasp, 0.5);
  EXPECT_LT(hopeless.fraction, 0.1);
  EXPECT_LT(hopeless.value, 0.5);
}

TEST_F(RollOutTest, BelievedWallStandsBehindTheHandle) {
  const Box wall = believed_wall(belief_);
  EXPECT_NEAR(wall.pose.linear().determinant(), 1.0, 1e-12);
  const Vector3d local = wall.pose.inverse() * belief_.position;
  EXPECT_NEAR(-local.y() - wall.half_extents.y(), belief_.standoff - 0.02, 1e-12);
}

}  // namespace
}  // namespace ajar
