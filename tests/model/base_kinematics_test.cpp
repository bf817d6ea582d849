// Strategy: the arc in closed form against many small straight steps, at, below and above the switch to the series; wheel
// speeds by the rolling condition of each wheel.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "model_fixtures.hpp"

namespace ajar {
namespace {

TEST(BaseKinematics, ArcEqualsManySmallSteps) {
  for (const double w : {-2.0, -0.5, 2e-4, 1e-9, 0.0, 0.7}) {
    const double v = 0.6, dt = 1.5;
    const BasePose start{0.3, -0.2, 0.4};
    const BasePose arc = integrate_base(start, v, w, dt);
    constexpr int steps = 20000;
    double x = start.x, y = start.y;
    for (int i = 0; i < steps; ++i) {  // midpoint rule, error (w dt / steps)^2 / 24 of the way: below 1e-9
      const double yaw = start.yaw + w * dt * (i + 0.5) / steps;
      x += v * dt / steps * std::cos(yaw);
      y += v * dt / steps * std::sin(yaw);
    }
    EXPECT_NEAR(arc.x, x, 1e-8) << w;
    EXPECT_NEAR(arc.y, y, 1e-8) << w;
    EXPECT_NEAR(arc.yaw, start.yaw + w * dt, 1e-12) << w;
  }
}

TEST(BaseKinematics, ArcIsContinuousAcrossTheSwitchToTheSeries) {
  const BasePose below = integrate_base({}, 1.0, 2.0 * 0.99999e-4, 1.0);
  const BasePose above = integrate_base({}, 1.0, 2.0 * 1.00001e-4, 1.0);
  EXPECT_NEAR(below.x, above.x, 1e-12);
  EXPECT_NEAR(below.y, above.y, 2.1e-9);  // the turning rates themselves differ by 4e-9
}

TEST(BaseKinematics, DrivingBackUndoesDrivingForth) {
  const BasePose there = integrate_base({1.0, 2.0, 0.3}, 0.5, 0.8, 0.7);
  const BasePose back = integrate_base(there, 0.5, 0.8, -0.7);
  EXPECT_NEAR(back.x, 1.0, 1e-12);
  EXPECT_NEAR(back.y, 2.0, 1e-12);
  EXPECT_NEAR(back.yaw, 0.3, 1e-12);
}

TEST(BaseKinematics, EachWheelRollsWithItsGroundSpeed) {
  const RobotModel model = load_robot("heron");
  const double v = 0.4, w = 0.6;
  const Vector2d wheels = wheel_speeds(model, v, w);  // left, right
  EXPECT_NEAR(wheels[0] * model.wheel_radius(), v - w * 0.5 * model.wheel_track(), 1e-12);
  EXPECT_NEAR(wheels[1] * model.wheel_radius(), v + w * 0.5 * model.wheel_track(), 1e-12);
  EXPECT_NEAR(wheel_speeds(model, 0.0, 1.0).sum(), 0.0, 1e-12);
}

TEST(BaseKinematics, StaysFiniteForNonFiniteInputs) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const BasePose base = integrate_base({1.0, 2.0, 3.0}, nan, 0.1, 0.1);
  EXPECT_EQ(base.x, 1.0);
  EXPECT_EQ(base.yaw, 3.0);
  EXPECT_EQ(wheel_speeds(load_robot("heron"), nan, 0.0).norm(), 0.0);
}

}  // namespace
}  // namespace ajar
