// Strategy: the set-up of the stability proof in closed form. A rigid grasp on a hinge with perfect velocity tracking makes
// the reference parallel to the true motion; the true x and k are known at each instant. The Lyapunov function must fall,
// the linearised error must decay at the placed bandwidth at any speed, and the sign as printed in the source must diverge.
#include "ajar/estimation/direction_law.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

constexpr double kDt = 0.002;
const Vector3d kTrueK(0.0, 0.0, 1.25);  // hinge of 0.8 m about the vertical

struct LawRun {
  double direction_error = 0.0;  // [rad]
  double curvature_error = 0.0;  // [1/m]
  bool lyapunov_falls = true;
};

// Rigid grasp, handle moved at `speed` along its true path for `duration`; gamma_sign = -1 is the printed (5.4).
LawRun rigid_grasp(double speed, double duration, double initial_error, double gamma_sign) {
  Vector3d x = Vector3d::UnitX();
  DirectionState state;
  state.x = exp_so3(initial_error * Vector3d(0.3, 0.2, 1.0).normalized()) * x;
  AdaptiveGains gains = adaptive_gains(1.0, 1.0, speed);
  gains.gamma *= gamma_sign;
  LawRun run;
  double lyapunov = 1e9;
  for (int i = 0; i < static_cast<int>(duration / kDt); ++i) {
    const Vector3d v = speed * x;
    const double s = std::copysign(speed, state.x.dot(v));
    state = step_adaptive_law(state, v, s, gains, kDt);
    x = exp_so3(kDt * speed * kTrueK) * x;
    const double W = 1.0 - state.x.dot(x) + 0.5 * (state.k - kTrueK).squaredNorm() / gains.Gamma;
    if (W > lyapunov + 1e-5) run.lyapunov_falls = false;
    lyapunov = W;
  }
  run.direction_error = std::atan2(state.x.cross(x).norm(), state.x.dot(x));
  run.curvature_error = (state.k - kTrueK).norm();
  return run;
}

TEST(AdaptiveLaw, ConvergesAtTheSameRateAtAnySpeed) {
  for (const double speed : {0.03, 0.05, 0.1, 0.2}) {
    const LawRun run = rigid_grasp(speed, 10.0, 25.0 * std::numbers::pi / 180.0, 1.0);
    EXPECT_LT(run.direction_error, 0.02) << "speed " << speed;
    EXPECT_LT(run.curvature_error, 0.1 * kTrueK.norm()) << "speed " << speed;
  }
}

TEST(AdaptiveLaw, LyapunovFunctionNeverRises) {
  EXPECT_TRUE(rigid_grasp(0.05, 8.0, 0.4, 1.0).lyapunov_falls);
  EXPECT_TRUE(rigid_grasp(0.1, 8.0, 0.8, 1.0).lyapunov_falls);
}

TEST(AdaptiveLaw, PrintedSignOfTheVelocityFormDiverges) {
  const LawRun run = rigid_grasp(0.05, 8.0, 0.4, -1.0);
  EXPECT_GT(run.direction_error, 1.0);
  EXPECT_FALSE(run.lyapunov_falls);
}

TEST(AdaptiveLaw, GainsPlaceBothPolesAtTheBandwidth) {
  // s² + γ v² s + Γ v² = (s + w0)² for ζ = 1.
  for (const double speed : {0.02, 0.05, 0.2}) {
    const AdaptiveGains gains = adaptive_gains(1.5, 1.0, speed);
    EXPECT_NEAR(gains.gamma * speed * speed, 3.0, 1e-12);
    EXPECT_NEAR(gains.Gamma * speed * speed, 2.25, 1e-12);
  }
  EXPECT_EQ(adaptive_gains(1.5, 1.0, 0.0).gamma, adaptive_gains(1.5, 1.0, 0.02).gamma);
}

TEST(AdaptiveLaw, LeakRemovesCurvatureAlongTheMotion) {
  DirectionState state;
  state.k = Vector3d(1.0, 0.0, 0.5);
  for (int i = 0; i < 1000; ++i) state = step_adaptive_law(state, 0.0 * state.x, 0.0, adaptive_gains(1.5, 1.0, 0.05), kDt);
  EXPECT_NEAR(state.k.x(), std::exp(-2.0 * 2.0), 1e-3);  // λ_k 2 1/s for 2 s
  EXPECT_NEAR(state.k.z(), 0.5, 1e-12);
}

TEST(AdaptiveLaw, KeepsTheEstimateOnNaN) {
  const DirectionState state;
  const DirectionState next =
      step_adaptive_law(state, Vector3d::Constant(std::nan("")), 0.05, adaptive_gains(1.5, 1.0, 0.05), kDt);
  EXPECT_EQ(next.x, state.x);
  EXPECT_EQ(next.k, state.k);
}

TEST(StuckHandle, TurnsAwayFromTheReactionAtTheStatedRate) {
  // The robot presses the handle to +y, so the handle's free direction lies to -y.
  Vector3d x = Vector3d::UnitX();
  for (int i = 0; i < 500; ++i) x = turn_from_reaction(x, Vector3d(10.0, 12.0, 0.0), 0.15, kDt);
  EXPECT_LT(x.y(), 0.0);
  EXPECT_NEAR(std::atan2(-x.y(), x.x()), 0.15, 1e-3);
  EXPECT_EQ(turn_from_reaction(Vector3d::UnitX(), Vector3d(30.0, 1.5, 0.0), 0.15, kDt), Vector3d::UnitX());
  EXPECT_EQ(turn_from_reaction(Vector3d::UnitX(), Vector3d::Constant(std::nan("")), 0.15, kDt), Vector3d::UnitX());
}

TEST(TurnTowards, StopsAtTheTargetAndAtTheLimit) {
  const Vector3d x = Vector3d::UnitX();
  EXPECT_EQ(turn_towards(x, Vector3d::UnitY(), 2.0), Vector3d::UnitY());
  EXPECT_NEAR(turn_towards(x, Vector3d::UnitY(), 0.1).y(), std::sin(0.1), 1e-12);
  EXPECT_NEAR(turn_towards(x, -x, 0.1).x(), std::cos(0.1), 1e-12);
}

TEST(AdaptiveLaw, PullOfAHandleThatResistsDoesNotTurnADirectionWithinItsDoubt) {
  // The handle needs 30 N along its way; x̂ is off by δ and sees f = 30 N (cos δ, sin δ).
  const double doubt = std::sin(0.15);
  for (const double off : {0.02, 0.08, 0.14}) {
    EXPECT_EQ(unexplained_share(30.0 * std::cos(off), 30.0 * std::sin(off), doubt), 0.0) << off;
  }
  // A constraint that pushes back with twice what the pull explains is believed by half.
  EXPECT_NEAR(unexplained_share(30.0, 2.0 * 30.0 * doubt, doubt), 0.5, 1e-12);
  EXPECT_EQ(unexplained_share(30.0, 1.0, 0.0), 1.0);  // a guess whose error nobody knows
  EXPECT_EQ(unexplained_share(std::nan(""), 1.0, doubt), 0.0);
}

}  // namespace
}  // namespace ajar
