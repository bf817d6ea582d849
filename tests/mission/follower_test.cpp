// Strategy: the told path against the circle and line that it must be; then the follower on a robot that executes commands
// exactly: it parks, follows within a millimetre with feedback, and stops with a zero command for nonsense.
#include "ajar/mission/follower.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(HandPath, IsACircleAboutItsCentreOrALine) {
  HandPath path{Vector3d::UnitX(), Vector3d(0.0, 0.0, 2.0), 1.0};
  Pose start = Pose::Identity();
  start.translation() = Vector3d(1.0, 2.0, 3.0);
  start.linear() = exp_so3(Vector3d(0.3, -0.2, 0.5));
  const Vector3d centre = start.translation() + start.linear() * Vector3d(0.0, 0.5, 0.0);
  for (const double arc : {0.0, 1e-9, 0.2, kPi / 4.0, 1.5}) {
    const Pose at = pose_on_path(path, start, arc);
    EXPECT_NEAR((at.translation() - centre).norm(), 0.5, 1e-12);
    EXPECT_NEAR(log_so3(start.linear().transpose() * at.linear()).norm(), 2.0 * arc, 1e-9);
  }
  path.curvature.setZero();
  EXPECT_LT((pose_on_path(path, start, 0.7).translation() - start.translation() - 0.7 * start.linear().col(0)).norm(),
            1e-12);
}

TEST(HandPath, MovesWithAConstantTwistInItsOwnAxes) {
  const HandPath path{-Vector3d::UnitZ(), Vector3d(1.25, 0.0, 0.0), 1.0};
  const Pose start = Pose::Identity();
  const double h = 1e-6;
  for (const double arc : {0.0, 0.4, 1.1}) {
    const Pose at = pose_on_path(path, start, arc);
    const Vector3d v = (pose_on_path(path, start, arc + h).translation() - at.translation()) / h;
    EXPECT_LT((at.linear().transpose() * v - path.direction).norm(), 1e-5);
  }
}

class FollowerOnHeron : public ::testing::Test {
 protected:
  FollowerOnHeron() {
    config.task = "follow";
    config.period = 0.01;
    config.follow.start = config.follow.parking = Vector2d(0.0, 0.0);
    config.base_law.kind = "distance";
    config.drives = {0.0, 0.0, 0.0};  // it executes commands exactly
    state.q = JointVector(6);
    state.q << -1.86, -1.03, 1.90, -0.87, 1.29, -1.57;
    state.dq = JointVector::Zero(6);
  }

  void apply(const Command& command) {
    state.q += config.period * command.dq;
    state.dq = command.dq;
    state.base = integrate_base(state.base, command.base_v, command.base_w, config.period);
    state.base_v = command.base_v;
    state.base_w = command.base_w;
    state.time += config.period;
  }

  RobotModel model = load_robot("heron");
  MissionConfig config;
  RobotState state;
  HandPath path{-Vector3d::UnitZ(), Vector3d::Zero(), 0.3};
};

TEST_F(FollowerOnHeron, FollowsALineToItsEnd) {
  Follower follower(model, config, path);
  Kinematics kinematics;
  model.compute(state.base, state.q, kinematics);
  const Pose start = kinematics.X_WE;
  double worst = 0.0;
  for (int i = 0; i < 3000 && !follower.finished(); ++i) {
    apply(follower.step(state));
    model.compute(state.base, state.q, kinematics);
    const Vector3d way = kinematics.X_WE.translation() - start.translation();
    const Vector3d x = start.linear() * path.direction;
    worst = std::max(worst, (way - x * x.dot(way)).norm());
  }
  EXPECT_TRUE(follower.reached_goal());
  EXPECT_LT(worst, 1e-3);
  const Vector3d end = pose_on_path(path, start, path.length).translation();
  EXPECT_LT((kinematics.X_WE.translation() - end).norm(), 2e-3);  // one tick of travel
}

TEST_F(FollowerOnHeron, StopsForMeasurementsThatAreNotNumbers) {
  Follower follower(model, config, path);
  apply(follower.step(state));
  state.q[2] = std::numeric_limits<double>::quiet_NaN();
  const Command command = follower.step(state);
  EXPECT_TRUE(follower.finished());
  EXPECT_FALSE(follower.reached_goal());
  EXPECT_EQ(follower.reason(), EndReason::SensorInvalid);
  EXPECT_EQ(command.dq.norm() + std::abs(command.base_v) + std::abs(command.base_w), 0.0);
}

TEST_F(FollowerOnHeron, StopsWhenAsked) {
  Follower follower(model, config, path);
  apply(follower.step(state));
  follower.interrupt();
  (void)follower.step(state);
  EXPECT_EQ(follower.reason(), EndReason::Interrupted);
  EXPECT_EQ(follower.phase(), Phase::Stopped);
}

}  // namespace
}  // namespace ajar
