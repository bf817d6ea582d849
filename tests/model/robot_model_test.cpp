// Strategy: the kinematics of the UR5e against golden numbers that come from its DH table (another description of the same
// arm, another program), and every derivative against central differences at 10 000 random states, for Heron and for TIAGo,
// which nobody here wrote. Left out: speed, which the benchmarks measure.
#include "ajar/model/robot_model.hpp"

#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <limits>
#include <numbers>

#include "ajar/core/so3.hpp"
#include "ajar/model/clearance.hpp"
#include "ajar/model/footprint.hpp"
#include "allocation_guard.hpp"
#include "model_fixtures.hpp"

namespace ajar {
namespace {

using test::random_base;
using test::random_posture;

constexpr double kStep = 1e-5;        // of the central differences: their own error is then near 1e-10
constexpr double kDerivative = 1e-7;  // required of every derivative

RobotModel ur5e_on_a_mount() {
  const test::TemporaryFolder folder;
  return RobotModel::load(
      folder.write("ur5e.urdf", test::ur5e_urdf()),
      folder.write("ur5e.toml", test::robot_toml("\"pan\", \"lift\", \"elbow\", \"w1\", \"w2\", \"w3\"", 6, "tool0")));
}

// The state after the inputs u for a short time, exactly.
void advance(const InputVector& u, double dt, BasePose& base, JointVector& q) {
  const Eigen::Index n = q.size();
  base = integrate_base(base, u[n + 1], u[n], dt);
  q += dt * u.head(n);
}

void expect_derivatives(const RobotModel& model, int states) {
  std::mt19937_64 rng(7);
  Kinematics at, before, after;
  double worst_pose = 0.0, worst_distance = 0.0, worst_point = 0.0;
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxInputs> J_p;
  for (int s = 0; s < states; ++s) {
    const BasePose base = random_base(rng);
    const JointVector q = random_posture(model, rng);
    const int column = s % model.inputs();
    const int joint = s % (model.joints() + 1) - 1;
    InputVector u = InputVector::Zero(model.inputs());
    u[column] = 1.0;
    Vector3d points[2];
    const Vector3d p_J(0.1, -0.2, 0.3);  // fixed to that joint's body
    for (int side : {-1, 1}) {
      BasePose b = base;
      JointVector x = q;
      advance(u, side * kStep, b, x);
      model.compute(b, x, side < 0 ? before : after);
      points[(side + 1) / 2] = model.joint_pose(joint, b) * p_J;
    }
    model.compute(base, q, at);
    model.point_jacobian(joint, model.joint_pose(joint, base) * p_J, base, J_p);
    Vector6d twist;
    twist.head<3>() = (after.X_WE.translation() - before.X_WE.translation()) / (2.0 * kStep);
    twist.tail<3>() = log_so3(after.X_WE.linear() * before.X_WE.linear().transpose()) / (2.0 * kStep);
    worst_pose = std::max(worst_pose, (twist - at.J.col(column)).cwiseAbs().maxCoeff());
    worst_point = std::max(worst_point, ((points[1] - points[0]) / (2.0 * kStep) - J_p.col(column)).cwiseAbs().maxCoeff());
    if (at.distance > 0.05) {  // nearer to the axle the distance bends too sharply for this step
      worst_distance = std::max(worst_distance,
                                std::abs((after.distance - before.distance) / (2.0 * kStep) - at.distance_jacobian[column]));
    }
    ASSERT_EQ(at.distance_jacobian[model.joints()], 0.0) << "turning the base moves the hand with it";
    ASSERT_EQ(at.distance_jacobian[model.joints() + 1], 0.0) << "driving the base moves the hand with it";
  }
  EXPECT_LT(worst_pose, kDerivative);
  EXPECT_LT(worst_point, kDerivative);
  EXPECT_LT(worst_distance, kDerivative);
}

TEST(RobotModel, AgreesWithGoldenNumbersOfTheDhTable) {
  const RobotModel model = ur5e_on_a_mount();
  JointVector q(6);
  q << 0.2, -1.6, 2.0, -2.0, -1.57, 0.3;
  Kinematics k;
  model.compute({1.0, 0.5, 0.4}, q, k);
  constexpr double digits = 1e-6;  // the golden numbers have six decimals
  EXPECT_LT((k.X_WE.translation() - Vector3d(0.942576, 0.167965, 0.937943)).cwiseAbs().maxCoeff(), digits);
  Vector6d omega_column, v_column, twist;
  omega_column << 0.332035, -0.057424, 0.0, 0.0, 0.0, 1.0;
  v_column << 0.921061, 0.389418, 0.0, 0.0, 0.0, 0.0;
  EXPECT_LT((k.J.col(6) - omega_column).cwiseAbs().maxCoeff(), digits);
  EXPECT_LT((k.J.col(7) - v_column).cwiseAbs().maxCoeff(), digits);
  InputVector u(8);
  u << 0.1, -0.2, 0.3, -0.1, 0.2, -0.3, 0.25, 0.15;
  twist << 0.342730, 0.092581, -0.038590, -0.119011, -0.149588, 0.655712;
  EXPECT_LT((k.J * u - twist).cwiseAbs().maxCoeff(), digits);
  EXPECT_NEAR(k.distance, 0.336964, digits);
  InputRow distance_row(8);
  distance_row << 0.099149, 0.154004, -0.218903, -0.084836, 0.047709, 0.0, 0.0, 0.0;
  EXPECT_LT((k.distance_jacobian - distance_row).cwiseAbs().maxCoeff(), digits);

  const Eigen::MatrixXd J = k.J;
  EXPECT_NEAR(std::abs(J.leftCols(6).determinant()), 0.067976, digits);
  EXPECT_NEAR(std::sqrt((J * J.transpose()).determinant()), 0.254002, digits);
  const Eigen::MatrixXd N = Eigen::MatrixXd::Identity(8, 8) - J.transpose() * (J * J.transpose()).inverse() * J;
  EXPECT_NEAR(N(6, 6), 0.660388, digits);
  EXPECT_NEAR(k.distance_jacobian * N * k.distance_jacobian.transpose(), 0.033656, digits);
}

TEST(RobotModel, HeronsArmStandsWhereTheMakerSaysAtZero) {
  const RobotModel model = load_robot("heron");
  Kinematics k;
  model.compute({}, JointVector::Zero(6), k);
  // The controller's frame "Base" stands at +90 degrees on the mount.
  Pose X_BM = Pose::Identity();
  X_BM.linear() = Eigen::AngleAxisd(std::numbers::pi / 2.0, Vector3d::UnitZ()).toRotationMatrix();
  X_BM.translation() = Vector3d(-0.061854, -0.0045, 0.872);
  // tool0 of the DH table at zero: (-a2 - a3, -d4 - d6, d1 - d5)
  EXPECT_LT((X_BM.inverse() * k.p_WF - Vector3d(-0.8172, -0.2329, 0.0628)).norm(), 1e-9);
  EXPECT_LT((k.X_WE.translation() - (k.p_WF + 0.15 * k.R_WF.col(2))).norm(), 1e-9) << "the hand is 0.15 m out of the flange";
  EXPECT_LT((k.X_WE.linear() - k.R_WF).norm(), 1e-9);
}

TEST(RobotModel, HeronsDerivativesEqualCentralDifferences) { expect_derivatives(load_robot("heron"), 10000); }

TEST(RobotModel, TiagosDerivativesEqualCentralDifferences) {
  namespace fs = std::filesystem;
  fs::path urdf;
  std::error_code ignored;
  for (const auto& entry : fs::directory_iterator(fs::path(AJAR_SOURCE_DIR) / ".deps" / "venv" / "lib", ignored)) {
    const fs::path candidate =
        entry.path() / "site-packages/cmeel.prefix/share/example-robot-data/robots/tiago_description/robots/tiago.urdf";
    if (fs::exists(candidate, ignored)) {
      urdf = candidate;
    }
  }
  if (urdf.empty()) {
    GTEST_SKIP() << "the wheel example-robot-data is not installed in .deps/venv";
  }
  const RobotModel model = RobotModel::load(urdf, fs::path(AJAR_SOURCE_DIR) / "tests/support/tiago.toml");
  EXPECT_EQ(model.joints(), 8);
  EXPECT_GT(model.tool_mass(), 0.0);
  EXPECT_NEAR(model.limits().position_upper[0], 0.35, 1e-9) << "stroke of the torso";
  expect_derivatives(model, 10000);

  std::mt19937_64 rng(3);
  int solved = 0;
  for (int i = 0; i < 50; ++i) {
    Kinematics k;
    JointVector q = random_posture(model, rng);
    model.compute({}, q, k);
    const Pose wanted = k.X_WE;
    JointVector found = q + 0.1 * JointVector::Ones(8);
    if (model.solve_ik({}, wanted, found)) {
      ++solved;
      EXPECT_TRUE((found.array() >= model.limits().position_lower.array()).all());
      EXPECT_TRUE((found.array() <= model.limits().position_upper.array()).all());
    }
  }
  EXPECT_GE(solved, 40);
}

TEST(RobotModel, FixedBaseHasNoBaseColumns) {
  const test::TemporaryFolder folder;
  const RobotModel model = RobotModel::load(
      folder.write("ur5e.urdf", test::ur5e_urdf()),
      folder.write("ur5e.toml",
                   test::robot_toml("\"pan\", \"lift\", \"elbow\", \"w1\", \"w2\", \"w3\"", 6, "tool0", "fixed")));
  Kinematics k;
  model.compute({0.3, 0.2, 0.1}, JointVector::Constant(6, 0.5), k);
  EXPECT_EQ(k.J.rightCols(2).norm(), 0.0);
  EXPECT_GT(k.J.leftCols(6).norm(), 1.0);
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxInputs> J_p;
  model.point_jacobian(3, Vector3d(1.0, 1.0, 1.0), {0.3, 0.2, 0.1}, J_p);
  EXPECT_EQ(J_p.rightCols(2).norm(), 0.0);
}

TEST(RobotModel, WeighsTheToolBeyondTheSensor) {
  const RobotModel model = load_robot("heron");
  EXPECT_NEAR(model.tool_mass(), 1.0, 1e-9);
  EXPECT_LT((model.tool_com() - Vector3d(0.0, 0.0, 0.06)).norm(), 1e-6);
}

TEST(RobotModel, CopiesShareNothingThatChanges) {
  const RobotModel first = load_robot("heron");
  const RobotModel second(first);
  Kinematics a, b;
  first.compute({}, first.home(), a);
  second.compute({}, JointVector::Constant(6, 0.7), b);
  EXPECT_NEAR((first.joint_pose(5, {}).translation() - a.p_WF).norm(), 0.0, 1e-12);
}

TEST(RobotModel, SaysThatNonFiniteInputsAreInvalid) {
  const RobotModel model = load_robot("heron");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Kinematics k;
  JointVector q = model.home();
  q[3] = nan;
  model.compute({}, q, k);
  EXPECT_FALSE(k.valid);
  EXPECT_EQ(k.J.norm(), 0.0);
  EXPECT_FALSE(model.evaluated());
  model.compute({0.0, nan, 0.0}, model.home(), k);
  EXPECT_FALSE(k.valid);
  EXPECT_TRUE(k.X_WE.matrix().allFinite());
  model.compute({}, model.home(), k);
  EXPECT_TRUE(k.valid);
}

TEST(RobotModel, ComputesWithoutAllocation) {  // with the clearance, deep penetrations included
  const RobotModel model = load_robot("heron");
  ClearanceChecker checker(model, {});
  Box box;  // of 1 m, in the middle of the arm's workspace
  box.pose.translation() = Vector3d(0.3, 0.3, 1.2);
  checker.set_obstacle(0, box, MayTouch::Nothing);
  std::mt19937_64 rng(5);
  const JointVector q = random_posture(model, rng);
  JointVector found = model.home();
  Kinematics k;
  ClearanceResult result;
  Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxInputs> J_p;
  const long before = test::allocations;
  double least = 0.0, sigma = 0.0;
  for (int i = 0; i < 500; ++i) {
    model.compute({0.1, 0.2, 0.3}, (1.0 + 0.01 * i) * q, k);
    model.point_jacobian(5, k.p_WF, {0.1, 0.2, 0.3}, J_p);
    checker.compute(model, {0.1, 0.2, 0.3}, result);
    least = std::min(least, result.smallest[1]);
    sigma = std::max(sigma, arm_sigma_min(k));
  }
  const bool solved = model.solve_ik({0.1, 0.2, 0.3}, k.X_WE, found);
  EXPECT_EQ(test::allocations, before) << solved;
  EXPECT_LT(least, -0.2) << "some capsules were deep inside of the box";
  EXPECT_GT(sigma, 0.0);
}

// Its hull is 0.898 x 0.584 m with its middle 3.8 cm before the axle; all else that it carries stands above that.
TEST(BaseFootprint, OfHeronIsItsHull) {
  const Footprint footprint = base_footprint(load_robot("heron"));
  EXPECT_NEAR(footprint.front, 0.038 + 0.449, 1e-12);
  EXPECT_NEAR(footprint.rear, 0.449 - 0.038, 1e-12);
  EXPECT_NEAR(footprint.half_width, 0.292, 1e-12);
}

}  // namespace
}  // namespace ajar
