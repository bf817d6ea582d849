// Strategy: each erratum of the thesis's kinematics is shown on a robot whose kinematics are written out independently
// (UR5e by its table, on a unicycle), against finite differences or algebra: the printed form misses, the mended one does
// not. docs/errata.md names the test of every erratum.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <numbers>

#include "ajar/core/so3.hpp"
#include "ajar/wbc/printed_laws.hpp"
#include "ajar/wbc/thesis_controller.hpp"
#include "ur5e_reference.hpp"

namespace ajar {
namespace {

constexpr double kStep = 1e-6;

JointVector posture() {
  JointVector q(6);
  q << 0.2, -1.6, 2.0, -2.0, -1.57, 0.3;
  return q;
}

const BasePose kBase{1.0, 0.5, 0.4};

/// Pose of the arm's foot, as the fixture mounts it.
Pose arm_foot(const BasePose& base) {
  Pose X = to_pose(base) * Eigen::Translation3d(0.15, 0.05, 0.60);
  X.rotate(Eigen::AngleAxisd(0.3, Vector3d::UnitZ()));
  return X;
}

/// The geometric Jacobian of the arm in the axes of its foot.
HandJacobian geometric(const Kinematics& k, const Pose& X_WA) {
  HandJacobian J = k.J.leftCols(6);
  J.topRows<3>() = X_WA.linear().transpose() * J.topRows<3>();
  J.bottomRows<3>() = X_WA.linear().transpose() * J.bottomRows<3>();
  return J;
}

/// Velocity of the hand for joint rates, by differences.
Vector3d hand_velocity(const JointVector& q, const JointVector& dq) {
  const JointVector up = q + kStep * dq;
  const JointVector down = q - kStep * dq;
  return (test::ur5e_kinematics(kBase, up).X_WE.translation() - test::ur5e_kinematics(kBase, down).X_WE.translation()) /
         (2.0 * kStep);
}

/// Joint rates that turn the hand about a horizontal axis.
JointVector tilting_rates() {
  JointVector dq = JointVector::Zero(6);
  dq[3] = 0.25;
  return dq;
}

TEST(Erratum05, PrintedAdjointMissesTheVelocityOfATiltingHand) {
  const JointVector q = posture();
  const Kinematics k = test::ur5e_kinematics(kBase, q);
  const Pose X_WA = arm_foot(kBase);
  const HandJacobian J_A = geometric(k, X_WA);
  // The spatial Jacobian in foot axes, for which the adjoint is meant: the twist of the point at the foot's origin.
  const Vector3d p_A = X_WA.inverse() * k.X_WE.translation();
  HandJacobian spatial = J_A;
  for (int i = 0; i < 6; ++i) spatial.col(i).head<3>() += p_A.cross(Vector3d(J_A.col(i).tail<3>()));
  const Vector6d twist = printed_arm_jacobian(spatial, X_WA) * tilting_rates();
  const Matrix3d R = X_WA.linear();
  const Vector6d spatial_twist = spatial * tilting_rates();
  const Vector3d right = X_WA.translation().cross(Vector3d(R * spatial_twist.tail<3>())) + R * spatial_twist.head<3>();
  EXPECT_GT((twist.head<3>() - right).norm(), 0.05);  // of 0.25 rad/s; the foot is 1.3 m from the origin
  // The right adjoint gives the twist of the world's origin, which moved to the hand is the hand's velocity.
  const Vector3d at_hand = right + (R * spatial_twist.tail<3>()).cross(k.X_WE.translation());
  EXPECT_LT((at_hand - hand_velocity(q, tilting_rates())).norm(), 1e-8);
}

TEST(Erratum06, AdjointOfAGeometricJacobianIsNotTheHandsVelocityButItsRotationIs) {
  const JointVector q = posture();
  const Kinematics k = test::ur5e_kinematics(kBase, q);
  const Pose X_WA = arm_foot(kBase);
  const Vector6d local = geometric(k, X_WA) * tilting_rates();
  const Vector3d truth = hand_velocity(q, tilting_rates());
  const Vector3d rotated = X_WA.linear() * local.head<3>();
  const Vector3d moved = rotated + X_WA.translation().cross(Vector3d(X_WA.linear() * local.tail<3>()));
  EXPECT_LT((rotated - truth).norm(), 1e-8);
  EXPECT_GT((moved - truth).norm(), 0.1);
}

TEST(Erratum07, TurningTheBaseMovesTheHandThoughThePrintedColumnSaysNo) {
  const JointVector q = posture();
  const Kinematics k = test::ur5e_kinematics(kBase, q);
  const auto turned = [&](double w) -> Vector3d {
    return test::ur5e_kinematics({kBase.x, kBase.y, kBase.yaw + w}, q).X_WE.translation();
  };
  const Vector3d truth = (turned(kStep) - turned(-kStep)) / (2.0 * kStep);
  EXPECT_LT((k.J.col(6).head<3>() - truth).norm(), 1e-8);
  EXPECT_EQ(printed_base_column(k.J).col(6).head<3>().norm(), 0.0);
  EXPECT_NEAR(truth.norm(), k.distance, 1e-8);  // as fast as the hand is far: 1 rad/s
}

TEST(Erratum09, DampedInverseSolvesTheRidgeProblemAndNotTheConstrainedOne) {
  const Kinematics k = test::ur5e_kinematics(kBase, posture());
  const InputVector weight = InputVector::Ones(8);
  const Vector6d V = (Vector6d() << 0.05, -0.02, 0.01, 0.02, 0.0, 0.1).finished();
  const double lambda = 1e-3;
  const InputVector u = ridge_inverse(k.J, weight, lambda) * V;
  const double missed = (k.J * u - V).norm() / V.norm();
  EXPECT_GT(missed, 1e-4);
  // Stationary point of |J u - V|² + λ |u|².
  EXPECT_LT((k.J.transpose() * (k.J * u - V) + lambda * u).norm(), 1e-12);
  const InputVector heavy = ridge_inverse(k.J, 10.0 * weight, lambda) * V;
  EXPECT_NEAR((k.J * heavy - V).norm() / V.norm() / missed, 10.0, 2.0);  // a scale of W is a scale of λ
}

TEST(Erratum10, PrintedDampingNeverVanishes) {
  const Kinematics k = test::ur5e_kinematics(kBase, posture());
  const InputVector weight = InputVector::Ones(8);
  const double lambda = printed_damping(k.J, 1e-3, 1e-3);
  EXPECT_GT(lambda, 1e-3);  // far from any singularity
  const Vector6d V = (Vector6d() << 0.08, 0.0, 0.0, 0.0, 0.0, 0.0).finished();
  const double printed = (k.J * (ridge_inverse(k.J, weight, lambda) * V) - V).norm();
  const PseudoInverse adaptive = damped_pseudo_inverse(k.J, weight, {.onset = 0.05, .largest = 0.05, .length = 0.3});
  EXPECT_EQ(adaptive.squared_damping, 0.0);
  EXPECT_LT((k.J * (adaptive.matrix * V) - V).norm(), 1e-12);
  EXPECT_GT(printed, 1e-4);
}

TEST(Erratum11, ManipulabilityOfTheWholeJacobianHidesAStretchedArmAndDependsOnUnits) {
  JointVector q = posture();
  const auto whole = [](const HandJacobian& J) {
    return std::sqrt(Eigen::Matrix<double, 6, 6>(J * J.transpose()).determinant());
  };
  const auto arm = [](const HandJacobian& J) {
    return std::abs(Eigen::Matrix<double, 6, 6>(J.leftCols<6>()).determinant());
  };
  const double bent = whole(test::ur5e_kinematics(kBase, q).J);
  const double arm_bent = arm(test::ur5e_kinematics(kBase, q).J);
  q[2] = 1e-3;  // the elbow straight
  const Kinematics k = test::ur5e_kinematics(kBase, q);
  EXPECT_LT(arm(k.J), 2e-3 * arm_bent);  // the arm has all but lost a direction ...
  EXPECT_GT(whole(k.J), 0.02 * bent);    // ... which the base hides
  HandJacobian in_millimetres = k.J;
  in_millimetres.topRows<3>() *= 1e3;
  EXPECT_NEAR(whole(in_millimetres) / whole(k.J), 1e9, 1e3);
}

TEST(Erratum12, DampedProjectorMovesTheHand) {
  const Kinematics k = test::ur5e_kinematics(kBase, posture());
  InputVector weight = InputVector::Ones(8);
  weight.tail<2>().setConstant(100.0);
  const InputVector z = InputVector::Constant(8, 0.2);
  const double free = (k.J * z).norm();
  const InputMatrix leaking = printed_projector(k.J, ridge_inverse(k.J, weight, 1e-2));
  EXPECT_GT((k.J * (leaking * z)).norm() / free, 5e-3);
  EXPECT_LT((k.J * (null_space_projector(k.J, weight) * z)).norm() / free, 1e-12);
}

TEST(Erratum14, TheGradientOverNineCoordinatesIsNoCommandOfEightInputs) {
  const JointVector q = posture();
  const auto distance = [&](const BasePose& base) {
    const Vector3d hand = test::ur5e_kinematics(kBase, q).X_WE.translation();  // of a hand that stays where it is
    return std::hypot(hand.x() - base.x, hand.y() - base.y);
  };
  const double slope =
      (distance({kBase.x + kStep, kBase.y, kBase.yaw}) - distance({kBase.x - kStep, kBase.y, kBase.yaw})) / (2.0 * kStep);
  EXPECT_GT(std::abs(slope), 0.1);  // a coordinate of the base has a slope while the hand is held ...
  const Kinematics k = test::ur5e_kinematics(kBase, q);
  EXPECT_EQ(k.distance_jacobian.tail<2>().norm(), 0.0);  // ... but no input of the base changes the distance by itself
  const BasePose driven = integrate_base(kBase, 0.3, 0.5, 1e-3);
  EXPECT_NEAR(test::ur5e_kinematics(driven, q).distance, k.distance, 1e-12);
}

TEST(Erratum15, TheFirstTwoRowsOfTheThesisAreAngular) {
  const JointVector q = posture();
  const Kinematics k = test::ur5e_kinematics(kBase, q);
  const Vector3d reach = k.X_WE.translation() - Vector3d(kBase.x, kBase.y, 0.0);
  for (int i = 0; i < 6; ++i) {
    JointVector up = q;
    JointVector down = q;
    up[i] += kStep;
    down[i] -= kStep;
    const double slope =
        (test::ur5e_kinematics(kBase, up).distance - test::ur5e_kinematics(kBase, down).distance) / (2.0 * kStep);
    EXPECT_NEAR(reach.head<2>().dot(k.J.col(i).head<2>()) / k.distance, slope, 1e-8);
  }
  // With the angular rows the distance would change with the wrist's roll axes.
  const InputRow angular = reach.head<2>().transpose() / k.distance * k.J.middleRows<2>(3);
  EXPECT_GT((angular - k.distance_jacobian).norm(), 0.3);
}

TEST(Erratum21, UnweightedAnswersDependOnUnitsAndWeightsOverTheLimitsDoNot) {
  const Kinematics k = test::ur5e_kinematics(kBase, posture());
  const Vector6d V = (Vector6d() << 0.05, 0.02, 0.0, 0.0, 0.0, 0.1).finished();
  const Damping damping{.onset = 1e-9, .largest = 0.0, .length = 0.3};
  HandJacobian J_mm = k.J;
  J_mm.col(7) *= 1e-3;  // v in mm/s
  const auto v_of = [&](const HandJacobian& J, const InputVector& weight) {
    return (damped_pseudo_inverse(J, weight, damping).matrix * V)[7];
  };
  const InputVector one = InputVector::Ones(8);
  EXPECT_GT(std::abs(1e-3 * v_of(J_mm, one) - v_of(k.J, one)), 0.3 * std::abs(v_of(k.J, one)));
  InputVector limits(8);
  limits << InputVector::Constant(6, 3.14), 1.0, 0.8;
  InputVector limits_mm = limits;
  limits_mm[7] *= 1e3;
  EXPECT_NEAR(1e-3 * v_of(J_mm, limits_mm.cwiseAbs2().cwiseInverse()), v_of(k.J, limits.cwiseAbs2().cwiseInverse()), 1e-9);
}

TEST(Erratum30, TheWholeJacobianIsWide) {
  const Kinematics k = test::ur5e_kinematics(kBase, posture());
  EXPECT_LT(k.J.rows(), k.J.cols());
  EXPECT_EQ(Eigen::FullPivLU<Eigen::MatrixXd>(Eigen::MatrixXd(k.J)).rank(), 6);
}

TEST(Erratum31, TheBasesInputIsItsForwardSpeedAndNotAVelocityInTheWorld) {
  const BasePose sideways{0.0, 0.0, std::numbers::pi / 2.0};
  const BasePose driven = integrate_base(sideways, 1.0, 0.0, 0.1);
  EXPECT_NEAR(driven.x, 0.0, 1e-12);
  EXPECT_NEAR(driven.y, 0.1, 1e-12);
}

TEST(Erratum32, TheProjectorOnTheNormalPlaneIsSymmetricAndIdempotent) {
  const Vector3d x = Vector3d(1.0, 2.0, -0.5).normalized();
  const Matrix3d P = Matrix3d::Identity() - x * x.transpose();
  EXPECT_LT((P - P.transpose()).norm(), 1e-15);
  EXPECT_LT((P * P - P).norm(), 1e-15);
  EXPECT_GT((P + P.transpose()).norm(), 1.0);  // skew-symmetric would be 0
}

TEST(Erratum34, TheTurningRateIsTheSeventhInput) {
  const Kinematics k = test::ur5e_kinematics(kBase, posture());
  EXPECT_EQ(k.J(5, 6), 1.0);
  EXPECT_EQ(k.J(5, 7), 0.0);
}

}  // namespace
}  // namespace ajar
