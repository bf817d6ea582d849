// Strategy: inverse kinematics must undo forward kinematics (found posture, wanted pose, limits), and the smallest singular
// value must equal that of a full decomposition and vanish at a posture that is singular by geometry.
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <limits>
#include <numbers>

#include "ajar/core/so3.hpp"
#include "model_fixtures.hpp"

namespace ajar {
namespace {

TEST(InverseKinematics, UndoesForwardKinematics) {
  const RobotModel model = load_robot("heron");
  std::mt19937_64 rng(11);
  int solved = 0;
  constexpr int runs = 2000;
  for (int i = 0; i < runs; ++i) {
    const BasePose base = test::random_base(rng);
    Kinematics wanted, found;
    model.compute(base, test::random_posture(model, rng), wanted);
    JointVector q = test::random_posture(model, rng);
    const JointVector start = q;
    if (model.solve_ik(base, wanted.X_WE, q)) {
      ++solved;
      model.compute(base, q, found);
      ASSERT_LT((found.X_WE.translation() - wanted.X_WE.translation()).norm(), 1e-5);
      ASSERT_LT(log_so3(found.X_WE.linear() * wanted.X_WE.linear().transpose()).norm(), 1e-5);
      ASSERT_LE(q.cwiseAbs().maxCoeff(), std::numbers::pi);
    } else {
      ASSERT_EQ((q - start).norm(), 0.0) << "a failure leaves the start";
    }
  }
  EXPECT_GT(solved, runs * 6 / 10) << "most random starts lead somewhere";
}

TEST(InverseKinematics, FollowsASmallStepFromNearby) {
  const RobotModel model = load_robot("heron");
  std::mt19937_64 rng(12);
  int solved = 0, tried = 0;
  for (int i = 0; i < 300; ++i) {
    Kinematics k;
    const JointVector q = test::random_posture(model, rng);
    model.compute({}, q, k);
    if (arm_sigma_min(k) < 0.05) {
      continue;
    }
    ++tried;
    Pose wanted = k.X_WE;
    wanted.translation() += Vector3d(0.005, -0.005, 0.005);
    JointVector found = q;
    if (model.solve_ik({}, wanted, found)) {
      ++solved;
      JointVector change = found - q;
      for (Eigen::Index j = 0; j < change.size(); ++j) {
        change[j] = wrap_angle(change[j]);
      }
      EXPECT_LT(change.norm(), 0.01 * std::sqrt(3.0) / 0.05) << "step over the smallest singular value, with a margin";
    }
  }
  EXPECT_EQ(solved, tried);
}

TEST(InverseKinematics, RefusesWhatIsOutOfReachOrNotFinite) {
  const RobotModel model = load_robot("heron");
  JointVector q = model.home();
  Pose far = Pose::Identity();
  far.translation() = Vector3d(3.0, 0.0, 1.0);
  EXPECT_FALSE(model.solve_ik({}, far, q));
  far.translation().x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(model.solve_ik({}, far, q));
  EXPECT_EQ((q - model.home()).norm(), 0.0);
  q[0] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(model.solve_ik({}, Pose::Identity(), q));
}

TEST(ArmSigma, EqualsTheFullDecomposition) {
  const RobotModel model = load_robot("heron");
  std::mt19937_64 rng(13);
  for (int i = 0; i < 200; ++i) {
    Kinematics k;
    model.compute({}, test::random_posture(model, rng), k);
    Eigen::MatrixXd J = k.J.leftCols(6);
    J.bottomRows(3) *= 0.3;
    const double sigma = Eigen::JacobiSVD<Eigen::MatrixXd>(J).singularValues().tail<1>()[0];
    ASSERT_NEAR(arm_sigma_min(k), sigma, 1e-7);
  }
}

TEST(ArmSigma, VanishesWhereTwoWristAxesAlign) {
  const RobotModel model = load_robot("heron");
  JointVector q = model.home();
  q[4] = 0.0;  // axes of wrist 1 and wrist 3 are parallel
  Kinematics k;
  model.compute({}, q, k);
  EXPECT_LT(arm_sigma_min(k), 1e-7);
  k.J(0, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(arm_sigma_min(k), 0.0);
}

}  // namespace
}  // namespace ajar
