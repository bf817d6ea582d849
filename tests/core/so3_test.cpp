// Strategy: rotations are checked against Eigen's own angle-axis, against each other (log of exp, exp of log) and by
// central differences, in the regimes zero, 1e-8, around the switch of the series, random and next to a half turn.
#include "ajar/core/so3.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "ajar/core/random.hpp"

namespace {

using namespace ajar;
constexpr double kPi = std::numbers::pi;

const double kAngles[] = {0.0, 1e-10, 1e-8, 0.9e-4, 1e-4, 1.1e-4, 1e-3, 0.3, 1.0, 2.0, 3.0, kPi - 1e-3, kPi - 1e-5};

TEST(So3, HatTurnsTheCrossProductIntoAMatrix) {
  Random random(1);
  for (int i = 0; i < 100; ++i) {
    const Vector3d a = random.normal3(1.0);
    const Vector3d b = random.normal3(1.0);
    EXPECT_LT((hat(a) * b - a.cross(b)).norm(), 1e-14);
  }
}

TEST(So3, ExpEqualsRotationAboutAxisByAngle) {
  Random random(2);
  for (const double angle : kAngles) {
    const Vector3d axis = random.direction();
    const Matrix3d expected = Eigen::AngleAxisd(angle, axis).toRotationMatrix();
    EXPECT_LT((exp_so3(angle * axis) - expected).norm(), 1e-14) << angle;
  }
}

TEST(So3, LogUndoesExpUpToNearlyAHalfTurn) {
  Random random(3);
  for (const double angle : kAngles) {
    for (int i = 0; i < 20; ++i) {
      const Vector3d w = angle * random.direction();
      // Next to a half turn the antisymmetric part carries few digits: allow round-off over that part.
      EXPECT_LT((log_so3(exp_so3(w)) - w).norm(), angle > 3.1 ? 1e-9 : 1e-12) << angle;
    }
  }
}

TEST(So3, ExpUndoesLogAtAHalfTurn) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const Matrix3d R = Eigen::AngleAxisd(kPi, random.direction()).toRotationMatrix();
    const Vector3d w = log_so3(R);
    EXPECT_NEAR(w.norm(), kPi, 1e-7);
    EXPECT_LT((exp_so3(w) - R).norm(), 1e-7);
  }
}

TEST(So3, LeftJacobianIsTheDerivativeOfExp) {
  Random random(5);
  constexpr double kStep = 1e-6;
  for (const double angle : {0.0, 1e-8, 0.9e-4, 1.1e-4, 0.5, 2.0, 3.1}) {
    const Vector3d w = angle * random.direction();
    const Vector3d dw = random.direction();
    const Matrix3d difference = (exp_so3(w + kStep * dw) - exp_so3(w - kStep * dw)) / (2.0 * kStep);
    EXPECT_LT((hat(left_jacobian_so3(w) * dw) * exp_so3(w) - difference).norm(), 1e-8) << angle;
  }
}

TEST(So3, WrappedAnglesKeepTheirDirection) {
  for (double angle = -20.0; angle < 20.0; angle += 0.37) {
    const double wrapped = wrap_angle(angle);
    EXPECT_GT(wrapped, -kPi);
    EXPECT_LE(wrapped, kPi);
    EXPECT_NEAR(std::cos(wrapped), std::cos(angle), 1e-12);
    EXPECT_NEAR(std::sin(wrapped), std::sin(angle), 1e-12);
    const double folded = wrap_half_turn(angle);
    EXPECT_GT(folded, -kPi / 2.0);
    EXPECT_LE(folded, kPi / 2.0);
    EXPECT_NEAR(std::sin(folded - angle), 0.0, 1e-12);
  }
  EXPECT_EQ(wrap_angle(-kPi), kPi);
  EXPECT_EQ(wrap_half_turn(-kPi / 2.0), kPi / 2.0);
}

TEST(So3, PerpendicularIsUnitAndPerpendicular) {
  Random random(6);
  for (int i = 0; i < 100; ++i) {
    const Vector3d v = 1e-3 * random.normal3(1.0);
    const Vector3d p = any_perpendicular(v);
    EXPECT_NEAR(p.norm(), 1.0, 1e-12);
    EXPECT_NEAR(p.dot(v.normalized()), 0.0, 1e-12);
  }
  for (int axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(any_perpendicular(Vector3d::Unit(axis)).dot(Vector3d::Unit(axis)), 0.0, 1e-15);
}

}  // namespace
