// Strategy: readings are made from a known contact wrench, tool weight and bias by moving forces as free-body diagrams
// do, in many poses; the estimator must give the contact wrench back. RobotModel is not needed for the equations.
#include "ajar/interaction/wrench.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

constexpr double kMass = 1.3;

Kinematics random_pose() {
  Kinematics k;
  k.R_WF = exp_so3(3.0 * Vector3d::Random());
  k.p_WF = Vector3d::Random();
  k.X_WE.linear() = k.R_WF;
  k.X_WE.translation() = k.p_WF + k.R_WF * Vector3d(0.01, -0.02, 0.15);
  return k;
}

// Free-body diagram of the tool at rest: what the robot side exerts = contact on the handle + weight carried.
HandWrench reading_of(const HandWrench& contact, const Kinematics& k, const Vector3d& com) {
  const Vector3d up(0.0, 0.0, kMass * 9.81);
  const Vector3d p_com = k.p_WF + k.R_WF * com;
  HandWrench reading;
  reading.force = k.R_WF.transpose() * (contact.force + up);
  const Vector3d torque = contact.torque + (k.X_WE.translation() - k.p_WF).cross(contact.force) + (p_com - k.p_WF).cross(up);
  reading.torque = k.R_WF.transpose() * torque;
  return reading;
}

TEST(ContactWrench, ReturnsTheWrenchOnTheHandleInEveryPose) {
  std::srand(11);
  const Vector3d com(0.01, 0.02, 0.06);
  for (int trial = 0; trial < 200; ++trial) {
    const Kinematics k = random_pose();
    const HandWrench truth{30.0 * Vector3d::Random(), 3.0 * Vector3d::Random()};
    const HandWrench seen = contact_wrench(reading_of(truth, k, com), k, kMass, com);
    EXPECT_LT((seen.force - truth.force).norm(), 1e-12 * 100.0);
    EXPECT_LT((seen.torque - truth.torque).norm(), 1e-12 * 100.0);
  }
}

TEST(ContactWrench, RobotThatPushesForwardReadsAForwardForce) {
  Kinematics k;
  k.X_WE.translation() = Vector3d(0.0, 0.0, 0.2);
  const HandWrench reading{Vector3d(10.0, 0.0, kMass * 9.81), Vector3d(0.0, 2.0, 0.0)};
  const HandWrench wrench = contact_wrench(reading, k, kMass, Vector3d::Zero());
  EXPECT_NEAR(wrench.force.x(), 10.0, 1e-12);
  EXPECT_NEAR(wrench.force.z(), 0.0, 1e-12);
  EXPECT_NEAR(wrench.torque.y(), 0.0, 1e-12);  // 0.2 m below the hand, a force of 10 N along x turns by 2 N m about y
}

TEST(ToolReading, VanishesAsContact) {
  std::srand(12);
  const Vector3d com(0.0, 0.01, 0.07);
  const Kinematics k = random_pose();
  const HandWrench wrench = contact_wrench(tool_reading(k.R_WF, kMass, com), k, kMass, com);
  EXPECT_LT(wrench.force.norm(), 1e-12);
  EXPECT_LT(wrench.torque.norm(), 1e-12);
}

class WrenchOfHeron : public ::testing::Test {
 protected:
  RobotModel model = load_robot("heron");
  WrenchEstimator estimator{model};
};

TEST_F(WrenchOfHeron, BiasInSensorAxesIsRemovedInOtherPoses) {
  std::srand(13);
  const Vector3d force_bias(0.7, -1.1, 2.0);
  const Vector3d torque_bias(0.05, 0.02, -0.04);
  const auto sense = [&](const Kinematics& k) {
    const HandWrench tool = tool_reading(k.R_WF, model.tool_mass(), model.tool_com());
    RobotState state;
    state.sensor_force = tool.force + force_bias;
    state.sensor_torque = tool.torque + torque_bias;
    return state;
  };
  const Kinematics first = random_pose();
  for (int i = 0; i < 5; ++i) {
    estimator.zero(sense(first), first);
  }
  EXPECT_EQ(estimator.zero_samples(), 5);
  for (int trial = 0; trial < 50; ++trial) {
    const Kinematics k = random_pose();
    const HandWrench wrench = estimator.hand_wrench(sense(k), k);
    EXPECT_LT(wrench.force.norm(), 1e-11);
    EXPECT_LT(wrench.torque.norm(), 1e-11);
  }
  estimator.reset();
  EXPECT_EQ(estimator.zero_samples(), 0);
  EXPECT_NEAR(estimator.hand_wrench(sense(first), first).force.norm(), force_bias.norm(), 1e-12);
}

TEST_F(WrenchOfHeron, AveragesTheNoiseOfItsZero) {
  RobotState state;
  const Kinematics k;
  const HandWrench tool = tool_reading(k.R_WF, model.tool_mass(), model.tool_com());
  for (int i = 0; i < 100; ++i) {
    state.sensor_force = tool.force + Vector3d(i % 2 == 0 ? 1.0 : -1.0, 0.5, 0.0);
    state.sensor_torque = tool.torque;
    estimator.zero(state, k);
  }
  state.sensor_force = tool.force;
  EXPECT_LT((estimator.hand_wrench(state, k).force - Vector3d(0.0, -0.5, 0.0)).norm(), 1e-12);
}

TEST_F(WrenchOfHeron, IgnoresWhatIsNotFinite) {
  RobotState state;
  state.sensor_force.y() = std::numeric_limits<double>::quiet_NaN();
  estimator.zero(state, {});
  EXPECT_EQ(estimator.zero_samples(), 0);
  EXPECT_EQ(estimator.hand_wrench(state, {}).force.norm(), 0.0);
  state.sensor_force.setZero();
  state.sensor_torque.z() = std::numeric_limits<double>::infinity();
  EXPECT_EQ(estimator.hand_wrench(state, {}).torque.norm(), 0.0);
}

}  // namespace
}  // namespace ajar
