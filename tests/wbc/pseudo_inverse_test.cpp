// Strategy: the inverse is compared with the normal equations of the minimisation that it states, the projector with
// its defining properties (J N = 0, N N = N, W-orthogonality) also for Jacobians close to rank loss, and both with
// figures from an independent numpy evaluation of a UR5e on a unicycle.
#include "ajar/wbc/pseudo_inverse.hpp"

#include <gtest/gtest.h>
#include <Eigen/Dense>

#include <random>

#include "ur5e_reference.hpp"

namespace ajar {
namespace {

HandJacobian random_jacobian(std::mt19937& generator, int inputs) {
  std::normal_distribution<double> normal;
  return HandJacobian::NullaryExpr(6, inputs, [&] { return normal(generator); });
}

InputVector random_weight(std::mt19937& generator, int inputs) {
  std::uniform_real_distribution<double> exponent(-1.0, 3.0);
  return InputVector::NullaryExpr(inputs, [&] { return std::pow(10.0, exponent(generator)); });
}

Kinematics golden_state() {
  JointVector q(6);
  q << 0.2, -1.6, 2.0, -2.0, -1.57, 0.3;
  return test::ur5e_kinematics({1.0, 0.5, 0.4}, q);
}

TEST(SquaredDamping, IsZeroAtTheOnsetAndLargestAtTheSingularity) {
  const Damping damping{0.05, 0.1, 0.3};
  EXPECT_EQ(squared_damping(0.05, damping), 0.0);
  EXPECT_EQ(squared_damping(0.06, damping), 0.0);
  EXPECT_NEAR(squared_damping(0.05 - 1e-9, damping), 0.0, 1e-8);
  EXPECT_NEAR(squared_damping(0.0, damping), 0.01, 1e-15);
}

TEST(DampedPseudoInverse, MinimisesResidualPlusWeightedRates) {
  std::mt19937 generator(6);
  const Damping damping{1e3, 0.4, 0.3};  // always damped
  const Vector6d scale = (Vector6d() << 1.0, 1.0, 1.0, 0.3, 0.3, 0.3).finished();
  for (int trial = 0; trial < 200; ++trial) {
    const HandJacobian J = random_jacobian(generator, 8);
    const InputVector weight = random_weight(generator, 8);
    const PseudoInverse inverse = damped_pseudo_inverse(J, weight, damping);
    ASSERT_GT(inverse.squared_damping, 0.0);
    const Eigen::MatrixXd A = scale.asDiagonal() * Eigen::MatrixXd(J);
    const Eigen::MatrixXd normal = A.transpose() * A + inverse.squared_damping * Eigen::MatrixXd(weight.asDiagonal());
    const Eigen::MatrixXd expected = normal.ldlt().solve(A.transpose() * Eigen::MatrixXd(scale.asDiagonal()));
    EXPECT_LT((Eigen::MatrixXd(inverse.matrix) - expected).norm(), 1e-8 * (1.0 + expected.norm()));
  }
}

TEST(DampedPseudoInverse, MeetsTheTaskAwayFromSingularities) {
  std::mt19937 generator(7);
  for (int trial = 0; trial < 200; ++trial) {
    const HandJacobian J = random_jacobian(generator, 8);
    const PseudoInverse inverse = damped_pseudo_inverse(J, random_weight(generator, 8), {1e-6, 0.05, 0.3});
    const Vector6d wanted = Vector6d::Random();
    EXPECT_LT((J * (inverse.matrix * wanted) - wanted).norm(), 1e-7);
  }
}

TEST(DampedPseudoInverse, StaysFiniteAtRankLoss) {
  std::mt19937 generator(8);
  HandJacobian J = random_jacobian(generator, 8);
  J.row(2) = J.row(1);
  const PseudoInverse inverse = damped_pseudo_inverse(J, InputVector::Ones(8), {0.05, 0.05, 0.3});
  EXPECT_NEAR(inverse.sigma_min, 0.0, 1e-7);
  EXPECT_LT(inverse.matrix.norm(), 6.0 / (2.0 * 0.05) + 10.0);  // 1/(2λ) bounds the gain of each damped direction
  EXPECT_TRUE(damped_pseudo_inverse(HandJacobian::Zero(6, 8), InputVector::Ones(8), {}).matrix.isZero());
  J(0, 0) = std::nan("");
  EXPECT_TRUE(damped_pseudo_inverse(J, InputVector::Ones(8), {}).matrix.isZero());
  EXPECT_TRUE(null_space_projector(J, InputVector::Ones(8)).isZero());
}

TEST(NullSpaceProjector, LeavesTheHandStillWhateverTheConditioning) {
  std::mt19937 generator(9);
  for (const double distance_to_rank_loss : {1.0, 1e-4, 1e-8, 1e-11, 0.0}) {
    for (int trial = 0; trial < 100; ++trial) {
      HandJacobian J = random_jacobian(generator, 8);
      J.row(5) = J.row(4) + distance_to_rank_loss * J.row(5);
      const InputVector weight = random_weight(generator, 8);
      const InputMatrix N = null_space_projector(J, weight);
      EXPECT_LT((J * N).norm(), 1e-12 * std::sqrt(weight.maxCoeff() / weight.minCoeff()) * J.norm());
      EXPECT_LT((N * N - N).norm(), 1e-11 * std::sqrt(weight.maxCoeff() / weight.minCoeff()));
      const InputMatrix WN = weight.asDiagonal() * N;
      EXPECT_LT((WN - WN.transpose()).norm(), 1e-11 * weight.maxCoeff());
    }
  }
}

TEST(NullSpaceProjector, GivesTheNearestMotionThatKeepsTheTask) {
  // u = J⁺ v + N z must be the W-nearest to z among all u with J u = v: its distance to z is W-orthogonal to N.
  std::mt19937 generator(10);
  for (int trial = 0; trial < 100; ++trial) {
    const HandJacobian J = random_jacobian(generator, 8);
    const InputVector weight = random_weight(generator, 8);
    const InputVector z = InputVector::Random(8);
    const InputVector u = damped_pseudo_inverse(J, weight, {1e-6, 0.05, 0.3}).matrix * Vector6d::Random() +
                          null_space_projector(J, weight) * z;
    const InputVector away = weight.cwiseProduct(u - z);
    EXPECT_LT((null_space_projector(J, weight).transpose() * away).norm(), 1e-6 * (1.0 + away.norm()));
  }
}

TEST(GoldenState, HandPoseAndTwistAgree) {
  const Kinematics k = golden_state();
  EXPECT_LT((k.X_WE.translation() - Vector3d(0.942576, 0.167965, 0.937943)).norm(), 1e-6);
  EXPECT_NEAR(k.distance, 0.336964, 1e-6);
  InputVector u(8);
  u << 0.1, -0.2, 0.3, -0.1, 0.2, -0.3, 0.25, 0.15;
  const Vector6d expected = (Vector6d() << 0.342730, 0.092581, -0.038590, -0.119011, -0.149588, 0.655712).finished();
  EXPECT_LT((k.J * u - expected).norm(), 2e-6);
}

TEST(GoldenState, RedundancyOfHeadingAndDistanceAgrees) {
  const Kinematics k = golden_state();
  const InputMatrix N = null_space_projector(k.J, InputVector::Ones(8));
  EXPECT_NEAR(N(6, 6), 0.660388, 1e-6);
  EXPECT_NEAR((k.distance_jacobian * N).dot(k.distance_jacobian), 0.033656, 1e-6);
}

}  // namespace
}  // namespace ajar
