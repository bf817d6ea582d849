// Strategy: golden numbers computed independently from the printed equations; the Lyapunov function of the polar law
// must fall along exact trajectories; symmetry (mirror, reversal) and limits of the graceful law; singular points and
// NaN give finite zeros. Left out: speed, which the navigator's test measures as a whole.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "ajar/core/error.hpp"
#include "ajar/core/random.hpp"
#include "ajar/core/so3.hpp"
#include "ajar/navigation/navigator.hpp"

namespace ajar {
namespace {

constexpr double kPi = std::numbers::pi;
const BasePose kTarget{-1.5, -1.15, 0.0};

NavigationConfig golden_gains() {
  NavigationConfig config;
  config.k_rho = 1.0;
  config.k_gamma = 2.0;
  config.k_delta = 1.0;
  config.w_max = 1.0;
  return config;
}

TEST(PolarLaw, EqualsTheGoldenNumbers) {
  const BaseTwist a = polar_law({0.0, 0.0, 0.0}, kTarget, golden_gains());
  EXPECT_NEAR(a.v, -1.5, 1e-6);
  EXPECT_NEAR(a.w, -4.00931, 1e-5);
  const BaseTwist b = polar_law({0.3, -0.2, 1.0}, kTarget, golden_gains());
  EXPECT_NEAR(b.v, -1.771942, 1e-6);
  EXPECT_NEAR(b.w, 5.259118, 1e-6);
}

TEST(PolarLaw, SeriesOfTheSincMeetsTheClosedForm) {
  const NavigationConfig config;
  const BasePose target{2.0, 0.0, 0.4};
  for (const double gamma : {0.99e-4, 1.01e-4}) {
    const BaseTwist twist = polar_law({0.0, 0.0, -gamma}, target, config);
    const double c = std::sin(2.0 * gamma) / (2.0 * gamma);
    const double delta = -target.yaw;
    EXPECT_NEAR(twist.w, config.k_gamma * gamma + config.k_rho * c * (gamma + config.k_delta * delta), 1e-14);
  }
}

TEST(PolarLaw, LyapunovFunctionFallsAtItsOwnRate) {
  const NavigationConfig config;
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const BasePose base{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-kPi, kPi)};
    const auto value = [&](const BasePose& p) {
      const double rho = std::hypot(p.x, p.y);
      const double gamma = wrap_angle(std::atan2(-p.y, -p.x) - p.yaw);
      const double delta = wrap_angle(gamma + p.yaw);
      return Vector3d(0.5 * (rho * rho + gamma * gamma + config.k_delta * delta * delta), rho, gamma);
    };
    const Vector3d now = value(base);
    if (now.y() < 0.3 || std::abs(now.z()) > 3.0 || std::abs(wrap_angle(now.z() + base.yaw)) > 3.0) continue;
    const BaseTwist twist = polar_law(base, {}, config);
    const double h = 1e-6;
    const double slope =
        (value(integrate_base(base, twist.v, twist.w, h)).x() - value(integrate_base(base, twist.v, twist.w, -h)).x()) /
        (2 * h);
    const double expected = -config.k_rho * std::pow(now.y() * std::cos(now.z()), 2) - config.k_gamma * now.z() * now.z();
    EXPECT_NEAR(slope, expected, 1e-5 * (1.0 + std::abs(expected)));
  }
}

TEST(GracefulLaw, EqualsTheGoldenNumbers) {
  const BaseTwist forward = graceful_law({}, kTarget, true, golden_gains());
  EXPECT_NEAR(forward.v, 0.152295, 1e-6);
  EXPECT_NEAR(forward.w, -0.363847, 1e-6);
  const BaseTwist backward = graceful_law({}, kTarget, false, golden_gains());
  EXPECT_NEAR(backward.v, -0.281827, 1e-6);
  EXPECT_NEAR(backward.w, 0.392068, 1e-6);
}

TEST(GracefulLaw, MirroredStartGivesMirroredTwist) {
  Random random(4);
  for (int i = 0; i < 100; ++i) {
    const BasePose base{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-3, 3)};
    const BasePose target{0.0, 0.0, random.uniform(-3, 3)};
    for (const bool forward : {true, false}) {
      const BaseTwist a = graceful_law(base, target, forward, {});
      const BaseTwist b = graceful_law({base.x, -base.y, -base.yaw}, {0.0, 0.0, -target.yaw}, forward, {});
      EXPECT_NEAR(a.v, b.v, 1e-12);
      EXPECT_NEAR(a.w, -b.w, 1e-12);
    }
  }
}

TEST(GracefulLaw, BackwardIsForwardOfTheRobotTurnedRound) {
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const BasePose base{random.uniform(-2, 2), random.uniform(-2, 2), random.uniform(-3, 3)};
    const BaseTwist a = graceful_law(base, {0.3, 0.1, 0.7}, false, {});
    const BaseTwist b = graceful_law({base.x, base.y, base.yaw + kPi}, {0.3, 0.1, 0.7 + kPi}, true, {});
    EXPECT_NEAR(a.v, -b.v, 1e-12);
    EXPECT_NEAR(a.w, b.w, 1e-12);
  }
}

TEST(GracefulLaw, TurningLimitKeepsTheCurvature) {
  NavigationConfig wide;
  wide.w_max = 1e9;
  NavigationConfig tight;
  tight.w_max = 0.05;
  const BasePose base{-1.0, 0.6, 1.0};
  const BaseTwist a = graceful_law(base, {}, true, wide);
  const BaseTwist b = graceful_law(base, {}, true, tight);
  ASSERT_GT(std::abs(a.w), 0.05);
  EXPECT_NEAR(std::abs(b.w), 0.05, 1e-12);
  EXPECT_NEAR(a.w / a.v, b.w / b.v, 1e-9);
}

TEST(Laws, SingularPointAndNanGiveZero) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const BasePose& bad : {BasePose{nan, 0, 0}, BasePose{0, nan, 0}, BasePose{0, 0, nan}, BasePose{1, 2, 0.5}}) {
    const BasePose target{1, 2, 0.3};
    EXPECT_EQ(polar_law(bad, target, {}).v, 0.0);
    EXPECT_EQ(polar_law(bad, target, {}).w, 0.0);
    EXPECT_EQ(graceful_law(bad, target, true, {}).v, 0.0);
    EXPECT_EQ(graceful_law(bad, target, false, {}).w, 0.0);
  }
}

TEST(NavigationConfig, RefusesGainsThatBendThePathWithoutBound) {
  NavigationConfig config;
  EXPECT_NO_THROW(config.validate());
  config.k_gamma = 2.0 * config.k_rho;
  EXPECT_THROW(config.validate(), ConfigError);
  config = {};
  config.k_delta = config.k_gamma / config.k_rho - 1.0;
  EXPECT_THROW(config.validate(), ConfigError);
  config = {};
  config.law = "dubins";
  EXPECT_THROW(config.validate(), ConfigError);
  config = {};
  config.w_max = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(config.validate(), ConfigError);
}

}  // namespace
}  // namespace ajar
