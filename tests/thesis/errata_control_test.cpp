// Strategy: errata about tasks in the null space, the heading and navigation, each by a closed form or a short simulation
// in which the printed form fails and the mended one does not. The errata that need a whole experiment (8, 17, 36) are
// proven in statements_test.cpp.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ajar/core/error.hpp"
#include "ajar/core/random.hpp"
#include "ajar/core/so3.hpp"
#include "ajar/navigation/navigator.hpp"
#include "ajar/wbc/printed_laws.hpp"
#include "ajar/wbc/thesis_controller.hpp"
#include "ur5e_reference.hpp"

namespace ajar {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDt = 0.01;
const BasePose kGoal{-1.5, -1.15, 0.0};

NavigationConfig polar(double k1, double k2, double k3) {
  NavigationConfig config;
  config.law = "thesis";
  config.k_rho = k1;
  config.k_gamma = k2;
  config.k_delta = k3;
  return config;
}

double distance_to(const BasePose& a, const BasePose& b) { return std::hypot(a.x - b.x, a.y - b.y); }

TEST(Erratum01, PrintedBearingDrivesAwayFromEveryGoalAndTheMendedOneArrives) {
  Random random(5);
  for (int trial = 0; trial < 20; ++trial) {
    const BasePose start{random.uniform(-3.0, 3.0), random.uniform(-3.0, 3.0), random.uniform(-kPi, kPi)};
    for (const bool printed : {false, true}) {
      NavigationConfig config = polar(1.0, 2.0, 1.0);
      config.printed = printed;
      BasePose base = start;
      for (int i = 0; i < 800 && distance_to(base, kGoal) < 100.0; ++i) {
        const BaseTwist twist = polar_law(base, kGoal, config);
        base = integrate_base(base, twist.v, twist.w, kDt);
      }
      if (printed) {
        EXPECT_GT(distance_to(base, kGoal), distance_to(start, kGoal));
      } else {
        EXPECT_LT(distance_to(base, kGoal), 0.02);
      }
    }
  }
}

TEST(Erratum02, TheLawIsFiniteAndContinuousWhereTheGoalIsStraightAhead) {
  const NavigationConfig config = polar(1.0, 2.0, 1.0);
  const double bearing = std::atan2(kGoal.y, kGoal.x);
  const BaseTwist ahead = polar_law({0.0, 0.0, bearing}, kGoal, config);
  ASSERT_TRUE(std::isfinite(ahead.w));  // sin γ cos γ/γ is 0/0 there
  for (const double aside : {-1e-7, 1e-7}) {
    EXPECT_NEAR(polar_law({0.0, 0.0, bearing + aside}, kGoal, config).w, ahead.w, 1e-6);
  }
}

/// |ω/v| along the drive without limits, at two times [1/m].
std::pair<double, double> curvatures(const NavigationConfig& config, double early, double late) {
  BasePose base{0.0, 0.0, 0.0};
  std::pair<double, double> out;
  for (double t = 0.0; t < late + kDt; t += 1e-3) {
    const BaseTwist twist = polar_law(base, kGoal, config);
    const double kappa = std::abs(twist.w / twist.v);
    if (t <= early) out.first = kappa;
    out.second = kappa;
    base = integrate_base(base, twist.v, twist.w, 1e-3);
  }
  return out;
}

TEST(Erratum03, CurvatureGrowsWithTimeUnderTheThesissGainsAndFadesInsideTheRule) {
  const auto thesis = curvatures(polar(1.0, 2.0, 1.0), 4.0, 12.0);
  EXPECT_GT(thesis.second, 2.5 * thesis.first);  // linear in time
  const auto inside = curvatures(polar(0.5, 2.0, 4.0), 8.0, 16.0);
  EXPECT_LT(inside.second, inside.first);
  NavigationConfig refused = polar(1.0, 2.0, 1.0);
  refused.law = "polar";
  EXPECT_THROW(refused.validate(), ConfigError);
}

TEST(Erratum04, ClippingEachSpeedCostsWholeTurnsAndTheGoalItselfIsNoSingularPoint) {
  const NavigationConfig config = polar(1.0, 2.0, 1.0);
  const auto turned = [&](bool together) {
    BasePose base{0.0, 0.0, 0.0};
    double angle = 0.0;
    for (int i = 0; i < 12000 && distance_to(base, kGoal) > 0.01; ++i) {
      BaseTwist twist = polar_law(base, kGoal, config);
      const double excess = std::max({1.0, std::abs(twist.v) / 0.5, std::abs(twist.w) / 0.3});
      twist = together ? BaseTwist{twist.v / excess, twist.w / excess}
                       : BaseTwist{std::clamp(twist.v, -0.5, 0.5), std::clamp(twist.w, -0.3, 0.3)};
      base = integrate_base(base, twist.v, twist.w, kDt);
      angle += std::abs(twist.w) * kDt;
    }
    return angle * 180.0 / kPi;
  };
  EXPECT_NEAR(turned(true), 349.0, 20.0);
  EXPECT_GT(turned(false), 1.5 * turned(true));
  EXPECT_EQ(polar_law(kGoal, kGoal, config).w, 0.0);
}

TEST(Erratum13, AHeadingErrorWithoutSignTurnsAwayFromTheMotionOnOneSide) {
  const Vector6d twist = (Vector6d() << 0.08, 0.0, 0.0, 0.0, 0.0, 0.0).finished();
  EXPECT_DOUBLE_EQ(printed_heading_error(0.3, twist), printed_heading_error(-0.3, twist));
  double printed = -0.3;
  double mended = -0.3;
  for (int i = 0; i < 300; ++i) {
    printed -= kDt * 2.0 * printed_heading_error(printed, twist);
    mended -= kDt * 2.0 * wrap_angle(mended - heading_reference(twist).heading);
  }
  EXPECT_GT(std::abs(printed), 2.0);
  EXPECT_LT(std::abs(mended), 1e-2);
}

class ErrataNullSpace : public ::testing::Test {
 protected:
  ErrataNullSpace() : q(6) {
    q << 0.2, -1.6, 2.0, -2.0, -1.57, 0.3;
    kinematics = test::ur5e_kinematics({1.0, 0.5, 0.4}, q);
    N = null_space_projector(kinematics.J, InputVector::Ones(8));
  }
  JointVector q;
  Kinematics kinematics;
  InputMatrix N;
};

TEST_F(ErrataNullSpace, Erratum16TheDistanceGrowsThoughItIsTooLargeWhenTheHandMovesAway) {
  const Vector3d away = Vector3d(kinematics.X_WE.translation() - Vector3d(1.0, 0.5, 0.0));
  Vector6d V = Vector6d::Zero();
  V.head<2>() = 0.1 * away.head<2>().normalized();
  InputVector weight = InputVector::Ones(8);
  weight.tail<2>().setConstant(100.0);
  const InputVector u_task =
      damped_pseudo_inverse(kinematics.J, weight, {.onset = 1e-9, .largest = 0.0, .length = 0.3}).matrix * V;
  const InputVector z = distance_task(kinematics, kinematics.distance - 0.02, 20.0);  // 2 cm too far
  const InputVector u = u_task + null_space_projector(kinematics.J, weight) * z;
  EXPECT_LT(kinematics.distance_jacobian.dot(z), 0.0);  // the task itself asks for less
  EXPECT_GT(kinematics.distance_jacobian.dot(u), 0.0);
}

TEST_F(ErrataNullSpace, Erratum18TheDistanceTaskTurnsTheBase) {
  const InputVector z1 = kinematics.distance_jacobian.transpose();
  const InputVector u = N * z1;
  // Rate of turning per rate of the distance: not small against 1 rad/s per m/s.
  EXPECT_GT(std::abs(u[6]) / kinematics.distance_jacobian.dot(u), 0.3);
}

TEST_F(ErrataNullSpace, Erratum20DrivingDoesNotChangeTheDistanceToAHandBesideTheBase) {
  // The hand is held, the base drives with heading θ: ḋ = -v cos β.
  const Vector3d hand = kinematics.X_WE.translation();
  const double bearing = std::atan2(hand.y() - 0.5, hand.x() - 1.0);
  for (const double beta : {0.0, kPi / 3.0, kPi / 2.0}) {
    const BasePose before{1.0, 0.5, bearing - beta};
    const BasePose after = integrate_base(before, 0.1, 0.0, 1e-5);
    const auto distance = [&](const BasePose& base) { return std::hypot(hand.x() - base.x, hand.y() - base.y); };
    EXPECT_NEAR((distance(after) - distance(before)) / 1e-5, -0.1 * std::cos(beta), 1e-6);
  }
}

TEST(Erratum19, TurningAboutTheHingeTogetherKeepsTheDistanceWhateverTheRadii) {
  // Hinge at the origin, handle at 0.8 m, axle at 0.35 m beside it: the arm stays frozen.
  BasePose base{0.35, 0.0, kPi / 2.0};
  const double start = 0.45;
  double angle = 0.0;
  for (int i = 0; i < 90; ++i) {
    base = integrate_base(base, 0.35 * 0.1, 0.1, 0.1 * kPi / 18.0);
    angle += 0.1 * 0.1 * kPi / 18.0;
    EXPECT_NEAR(std::hypot(0.8 * std::cos(angle) - base.x, 0.8 * std::sin(angle) - base.y), start, 1e-9);
    EXPECT_NEAR(wrap_angle(base.yaw - angle - kPi / 2.0), 0.0, 1e-9);  // along the hand's motion
  }
}

}  // namespace
}  // namespace ajar
