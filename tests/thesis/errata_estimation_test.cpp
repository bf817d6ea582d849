// Strategy: errata of the force law and the on-line estimator on a handle that moves exactly on a circle (or along a line);
// the printed law is repelled, drifts or forgets, the mended one converges.
#include <gtest/gtest.h>

#include <cmath>

#include "ajar/core/so3.hpp"
#include "ajar/estimation/direction_law.hpp"

namespace ajar {
namespace {

constexpr double kDt = 0.002;
const Vector3d kAxis(0.0, 0.0, 1.25);  // k of a door of 0.8 m [1/m]

double angle_between(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

/// Runs the law on a handle that goes round; the direction guess is wrong by 0.5 rad.
DirectionState run(const AdaptiveGains& gains, double speed, double time, Vector3d& truth) {
  truth = Vector3d::UnitX();
  DirectionState state{exp_so3(0.5 * Vector3d::UnitY()) * truth, kAxis};
  for (double t = 0.0; t < time; t += kDt) {
    truth = exp_so3(kDt * speed * kAxis) * truth;
    const Vector3d v = speed * truth;
    state = step_adaptive_law(state, v, state.x.dot(v) < 0.0 ? -speed : speed, gains, kDt);
  }
  return state;
}

TEST(Erratum22, ThePrintedSignRepelsTheDirectionAndPlusAlignsIt) {
  Vector3d truth;
  EXPECT_LT(angle_between(run({2000.0, 500.0, 2.0}, 0.08, 4.0, truth).x, truth), 0.02);
  const DirectionState printed = run({-2000.0, 500.0, 0.0}, 0.08, 4.0, truth);
  EXPECT_GT(std::abs(angle_between(printed.x, truth)), 1.2);  // held near a right angle by the switching sign
}

TEST(Erratum24, TheReferencesPartAlongTheDirectionIsTheWantedSpeedAndNotTheHandlesSpeed) {
  const Vector3d x = Vector3d::UnitX();
  const Vector3d v_f(0.03, 0.02, -0.01);
  const Vector3d v_ref = 0.05 * x - (v_f - x * x.dot(v_f));  // (5.0b)
  EXPECT_NEAR(x.dot(v_ref), 0.05, 1e-15);
  EXPECT_GT(v_ref.norm(), 0.054);
  EXPECT_NEAR(v_ref.norm(), 0.05 / std::cos(angle_between(x, v_ref)), 1e-15);
}

TEST(Erratum25, TheNormDriftsInSamplesUnlessTheStepStaysOnTheSphere) {
  Vector3d euler = Vector3d::UnitX();
  for (int i = 0; i < 5000; ++i) euler += kDt * (-0.08 * euler.cross(kAxis));  // (5.1) at its solution
  EXPECT_GT(euler.norm() - 1.0, 1e-5);
  Vector3d truth;
  EXPECT_NEAR(run({2000.0, 500.0, 2.0}, 0.08, 10.0, truth).x.norm(), 1.0, 1e-12);
}

TEST(Erratum26, ThePartOfTheCurvatureAlongTheDirectionStaysUnlessItIsTakenOut) {
  // A slide: the direction is constant and right, the curvature starts wrong along it.
  for (const double leak : {0.0, 2.0}) {
    DirectionState state{Vector3d::UnitX(), Vector3d(0.7, 0.0, 0.0)};
    for (double t = 0.0; t < 4.0; t += kDt) {
      state = step_adaptive_law(state, 0.08 * Vector3d::UnitX(), 0.08, {2000.0, 500.0, leak}, kDt);
    }
    EXPECT_NEAR(state.k.norm(), leak > 0.0 ? 0.7 * std::exp(-2.0 * 4.0) : 0.7, 1e-3);
  }
}

TEST(Erratum27, FedInAxesThatTurnWithTheHandItLearnsThatNothingBends) {
  DirectionState state{exp_so3(0.5 * Vector3d::UnitY()) * Vector3d::UnitX(), kAxis};
  for (double t = 0.0; t < 40.0; t += kDt) {
    state = step_adaptive_law(state, 0.08 * Vector3d::UnitX(), 0.08, {2000.0, 500.0, 2.0}, kDt);
  }
  EXPECT_LT(state.k.norm(), 0.01);  // 1.25 in truth
  Vector3d truth;
  EXPECT_NEAR(run({2000.0, 500.0, 2.0}, 0.08, 40.0, truth).k.norm(), 1.25, 0.02);
}

TEST(Erratum28, ConstantGainsConvergeAtTheSquareOfTheSpeedAndGainsOverItDoNot) {
  const auto error_after = [](const AdaptiveGains& gains, double speed) {
    Vector3d truth;
    const DirectionState state = run(gains, speed, 2.0, truth);
    return angle_between(state.x, truth);
  };
  const AdaptiveGains fixed{200.0, 25.0, 2.0};
  EXPECT_GT(error_after(fixed, 0.05), 5.0 * error_after(fixed, 0.2));
  const double slow = error_after(adaptive_gains(2.0, 1.0, 0.05), 0.05);
  const double fast = error_after(adaptive_gains(2.0, 1.0, 0.2), 0.2);
  EXPECT_LT(std::max(slow, fast), 2.0 * std::min(slow, fast));
}

}  // namespace
}  // namespace ajar
