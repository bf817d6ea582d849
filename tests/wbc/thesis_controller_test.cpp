// Strategy: the heading reference and the distance task against closed forms and finite differences; the controller on
// Heron for the properties that its equations promise: task met when limits are far, limits kept when they are near,
// distance and heading driven by the null space without moving the hand.
#include "ajar/wbc/thesis_controller.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"
#include "ur5e_reference.hpp"

namespace ajar {
namespace {

constexpr double kPeriod = 0.002;

TEST(HeadingReference, TurnsWithAVerticalHinge) {
  const Vector6d twist = (Vector6d() << 0.1 * std::cos(2.0), 0.1 * std::sin(2.0), 0.0, 0.0, 0.0, 0.125).finished();
  const HeadingReference reference = heading_reference(twist);
  EXPECT_TRUE(reference.valid);
  EXPECT_NEAR(reference.heading, 2.0, 1e-12);
  EXPECT_NEAR(reference.rate, 0.125, 1e-12);
}

TEST(HeadingReference, RateIsTheDerivativeOfTheHeadingForTiltedHinges) {
  std::srand(31);
  for (int trial = 0; trial < 100; ++trial) {
    const Vector3d x = Vector3d::Random().normalized();
    Vector3d k = Vector3d::Random();
    k -= x * x.dot(k);
    Vector6d twist;
    twist << 0.2 * x, 0.2 * k;
    const HeadingReference reference = heading_reference(twist);
    if (!reference.valid) {
      continue;
    }
    const auto heading_after = [&](double t) {
      const Vector3d v = exp_so3(0.2 * t * k) * x;
      return std::atan2(v.y(), v.x());
    };
    const double h = 1e-5;
    EXPECT_NEAR(reference.rate, wrap_angle(heading_after(h) - heading_after(-h)) / (2.0 * h),
                1e-6 * (1.0 + std::abs(reference.rate)));
  }
}

TEST(HeadingReference, IsUndefinedWithoutPlanarMotion) {
  Vector6d twist = Vector6d::Zero();
  EXPECT_FALSE(heading_reference(twist).valid);
  twist << 0.0099, 0.0, 0.0, 0.0, 0.0, 0.0;
  EXPECT_FALSE(heading_reference(twist).valid);
  twist << 0.0101, 0.0, 0.0, 0.0, 0.0, 0.0;
  EXPECT_TRUE(heading_reference(twist).valid);
  twist << 0.0101, 0.0, -0.1, 0.0, 0.0, 0.0;
  EXPECT_FALSE(heading_reference(twist).valid);
  twist[0] = std::nan("");
  EXPECT_FALSE(heading_reference(twist).valid);
}

TEST(DistanceTask, FollowsTheGradientOfTheDistance) {
  JointVector q(6);
  q << 0.2, -1.6, 2.0, -2.0, -1.57, 0.3;
  const BasePose base{1.0, 0.5, 0.4};
  const Kinematics k = test::ur5e_kinematics(base, q);
  const InputVector z = distance_task(k, 0.75, 20.0);
  const double h = 1e-6;
  for (int i = 0; i < 6; ++i) {
    JointVector up = q;
    JointVector down = q;
    up[i] += h;
    down[i] -= h;
    const double slope = (test::ur5e_kinematics(base, up).distance - test::ur5e_kinematics(base, down).distance) / (2.0 * h);
    EXPECT_NEAR(z[i], -20.0 * (k.distance - 0.75) * slope, 1e-7);
  }
  EXPECT_EQ(z[6], 0.0);
  EXPECT_EQ(z[7], 0.0);
}

class HeronThesis : public ::testing::Test {
 protected:
  HeronThesis() {
    q = JointVector(6);
    q << 1.54, -1.6, 2.0, -2.0, -1.57, 0.3;
    model.compute({}, q, kinematics);
  }

  WbcProblem problem() {
    WbcProblem p;
    p.kinematics = &kinematics;
    p.q = &q;
    return p;
  }

  RobotModel model = load_robot("heron");
  JointVector q;
  Kinematics kinematics;
};

TEST_F(HeronThesis, MeetsTheTaskOnceTheAccelerationsHaveBeenLeftBehind) {
  ThesisController controller(model, {}, {}, kPeriod);
  WbcProblem p = problem();
  p.tangential << -0.03, 0.01, 0.0, 0.0, 0.0, 0.02;
  p.correction << 0.0, 0.0, 0.005, 0.0, 0.01, 0.0;
  WbcSolution out;
  for (int tick = 0; tick < 2000; ++tick) {
    (void)controller.solve(p, out);
  }
  EXPECT_NEAR(out.speed_factor, 1.0, 1e-9);
  EXPECT_EQ(out.status, WbcStatus::Ok);
  EXPECT_LT((kinematics.J * out.u - p.tangential - p.correction).norm(), 1e-9);
}

TEST_F(HeronThesis, MovesTowardsTheWantedDistanceWhileTheHandStays) {
  ThesisConfig config;
  config.distance = kinematics.distance + 0.05;
  ThesisController controller(model, config, {}, kPeriod);
  WbcSolution out;
  for (int tick = 0; tick < 500; ++tick) {
    (void)controller.solve(problem(), out);
  }
  EXPECT_GT(kinematics.distance_jacobian.dot(out.u), 1e-4);
  EXPECT_LT((kinematics.J * out.u).norm(), 1e-9);
}

TEST_F(HeronThesis, TurnsTheBaseAlongTheMotion) {
  ThesisController controller(model, {}, {}, kPeriod);
  WbcProblem p = problem();
  p.tangential << 0.05 * std::cos(0.3), 0.05 * std::sin(0.3), 0.0, 0.0, 0.0, 0.0;
  WbcSolution out;
  for (int tick = 0; tick < 1000; ++tick) {
    (void)controller.solve(p, out);
  }
  EXPECT_GT(out.u[6], 0.01);  // base yaw 0, motion at 0.3 rad
}

TEST_F(HeronThesis, TracksADoorWithItsHeadingAlongTheMotion) {
  // 60° of a door of 0.8 m radius, pulled backward; feed-forward twist and pose feedback, exact integration.
  const Vector3d curvature(0.0, 0.0, -1.25);
  const Pose start = kinematics.X_WE;
  const Vector3d x0(-std::cos(0.1), -std::sin(0.1), 0.0);
  const Vector3d centre = start.translation() + curvature.cross(x0) / curvature.squaredNorm();
  ThesisController controller(model, {}, {}, kPeriod);
  BasePose base;
  WbcSolution out;
  double s = 0.0;
  double worst = 0.0;
  for (int tick = 0; tick < 20000 && 1.25 * s < std::numbers::pi / 3.0; ++tick) {
    const Matrix3d turned = exp_so3(s * curvature);
    const Vector3d wanted = centre + turned * (start.translation() - centre);
    worst = std::max(worst, (wanted - kinematics.X_WE.translation()).norm());
    const double speed = std::min(0.05, 0.05 * tick * kPeriod);
    WbcProblem p = problem();
    p.tangential << speed * (turned * x0), speed * curvature;
    p.correction << 2.0 * (wanted - kinematics.X_WE.translation()),
        2.0 * log_so3(turned * start.linear() * kinematics.X_WE.linear().transpose());
    (void)controller.solve(p, out);
    q += kPeriod * out.u.head(6);
    base = integrate_base(base, out.u[7], out.u[6], kPeriod);
    s += kPeriod * out.speed_factor * speed;
    model.compute(base, q, kinematics);
  }
  EXPECT_GE(1.25 * s, std::numbers::pi / 3.0 - 1e-9);
  EXPECT_LT(worst, 1e-3);
  const Vector3d x = exp_so3(s * curvature) * x0;
  const double error = wrap_angle(base.yaw - std::atan2(x.y(), x.x()) - std::numbers::pi);
  EXPECT_LT(std::abs(error), 0.06);  // z1 turns the base as well: the two tasks share two degrees of freedom
}

TEST_F(HeronThesis, KeepsItsLimitsOnRandomAndBrokenInput) {
  const WbcConfig wbc;
  ThesisController controller(model, {}, wbc, kPeriod);
  const InputLimits limits = make_input_limits(model, wbc, kPeriod);
  std::mt19937 generator(32);
  std::normal_distribution<double> normal;
  InputVector last = InputVector::Zero(8);
  WbcSolution out;
  double violation = 0.0;
  for (int tick = 0; tick < 20000; ++tick) {
    if (tick % 10 == 0) {
      q = JointVector::NullaryExpr(6, [&] { return 2.5 * normal(generator); });
      model.compute({}, q, kinematics);
    }
    WbcProblem p = problem();
    p.tangential = Vector6d::NullaryExpr([&] { return 0.2 * normal(generator); });
    p.correction = Vector6d::NullaryExpr([&] { return 0.05 * normal(generator); });
    p.base_fixed = tick % 7 == 0;
    if (tick % 50 == 49) {
      p.tangential[1] = std::numeric_limits<double>::quiet_NaN();
    }
    const InputBounds bounds = input_bounds(limits, q, last, p.base_fixed);
    const WbcStatus status = controller.solve(p, out);
    ASSERT_TRUE(out.u.size() == 8 && out.u.allFinite());
    EXPECT_EQ(status == WbcStatus::Invalid, tick % 50 == 49);
    if (status != WbcStatus::Invalid) {
      violation = std::max({violation, (out.u - bounds.upper).maxCoeff(), (bounds.lower - out.u).maxCoeff()});
    }
    last = out.u;
  }
  EXPECT_LE(violation, 1e-9);
}

TEST_F(HeronThesis, BendsTheHandsMotionWhenInputsAreClippedOneByOneAndKeepsItWhenScaledTogether) {
  ThesisConfig config;
  config.alpha1 = config.alpha2 = 0.0;
  config.feed_forward = false;
  config.alpha3 = 0.0;
  WbcProblem p = problem();
  p.tangential << -1.5, 0.4, 0.2, 0.0, 0.0, 0.5;  // more than the joints can do
  const Vector3d wanted = p.tangential.head<3>().normalized();
  for (const char* limits : {"each", "common"}) {
    config.limits = limits;
    ThesisController controller(model, config, {}, kPeriod);
    WbcSolution out;
    for (int tick = 0; tick < 1000; ++tick) (void)controller.solve(p, out);
    const Vector3d v = (kinematics.J * out.u).head<3>();
    const double aside = wanted.cross(v).norm() / v.norm();
    if (config.limits == "each") {
      EXPECT_GT(aside, 0.05);
    } else {
      EXPECT_LT(aside, 1e-6);
    }
  }
}

TEST_F(HeronThesis, RefusesWrongSettings) {
  ThesisConfig config;
  config.epsilon = 0.0;
  EXPECT_THROW(ThesisController(model, config, {}, kPeriod), ConfigError);
  config = {};
  config.limits = "some";
  EXPECT_THROW(ThesisController(model, config, {}, kPeriod), ConfigError);
  config = {};
  config.heading = "arccos";
  EXPECT_THROW(ThesisController(model, config, {}, kPeriod), ConfigError);
}

}  // namespace
}  // namespace ajar
