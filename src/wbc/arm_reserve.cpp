#include "arm_reserve.hpp"

#include <algorithm>
#include <cmath>

namespace ajar {
namespace {

constexpr int kHandRows = 6;
// Variables: joint rates, share of the base's motion that is taken back, speed factor of the hand.
constexpr int kShare = kMaxInputs;
constexpr int kHandSpeed = kMaxInputs + 1;
// The hand before the share, the share before the joint rates, as in the tick; the hand's speed is free.
constexpr double kHandWeight = 1e8;
constexpr double kShareWeight = 1e4;
constexpr double kFreeWeight = 1e-4;
// The path error that is allowed wherever a solution exists [m]: without it an arm with joints at their limits could never
// let the base begin to move.
constexpr double kAllowedError = 1e-3;
// A base slower than this at the hand is standing [m/s].
constexpr double kStanding = 1e-6;

}  // namespace

ArmReserve::ArmReserve(const InputLimits& limits, const WbcConfig& config) : limits_(limits) {
  const int n = limits_.joints;
  hold_.tasks = kHandRows;
  hold_.task_weight.setConstant(kHandWeight);
  hold_.weight.head(n) = config.rate_weight * limits_.speed_upper.head(n).cwiseMax(1e-3).array().square().inverse();
  hold_.weight[kShare] = kShareWeight;
  hold_.wanted[kShare] = 1.0;
  hold_.upper[kShare] = 1.0;
  hold_.weight[kHandSpeed] = kFreeWeight;
  hold_.upper[kHandSpeed] = 1.0;
}

// Square of the share of its speed that the base may keep. (docs/equations.md#reserve)
double ArmReserve::share(const QpProblem& tick, const JointVector& q, const InputVector& last) noexcept {
  const int n = limits_.joints;
  const double braking = (last.tail<2>().cwiseAbs().array() / limits_.deceleration.tail<2>().array()).maxCoeff();
  if (!(braking > limits_.period)) return 1.0;
  // Braking evenly, a joint goes on for half of its rate times this time.
  const JointVector up = (2.0 / braking) * (limits_.position_upper - q).cwiseMax(0.0);
  const JointVector down = (2.0 / braking) * (q - limits_.position_lower).cwiseMax(0.0);
  const auto most = limits_.speed_upper.head(n);
  if ((up.array() >= most.array()).all() && (down.array() >= most.array()).all()) return 1.0;
  hold_.A.topLeftCorner(kHandRows, n) = tick.A.topLeftCorner(kHandRows, n);
  const Vector6d carried = tick.A.block<kHandRows, 2>(0, n) * last.tail<2>();
  hold_.A.col(kShare).head<kHandRows>() = carried;
  hold_.A.col(kHandSpeed).head<kHandRows>() = tick.A.col(kMaxInputs).head<kHandRows>();
  hold_.upper.head(n) = up.cwiseMin(most);
  hold_.lower.head(n) = -down.cwiseMin(most);
  if (solver_.solve(hold_, held_) == QpStatus::Invalid) return 1.0;
  const double speed = std::max(carried.head<3>().norm(), kStanding);
  return std::clamp(held_.x[kShare] + 2.0 * kAllowedError / (braking * speed), 0.0, 1.0);
}

void ArmReserve::bound_base(const QpProblem& tick, const JointVector& q, const InputVector& last,
                            InputBounds& bounds) noexcept {
  const double square = share(tick, q, last);
  if (!(square < 1.0)) return;
  for (int i = limits_.joints; i < limits_.joints + 2; ++i) {
    const auto index = static_cast<size_t>(i);
    const double step = limits_.deceleration[i] * limits_.period;
    const double most = std::max(std::sqrt(square) * std::abs(last[i]), std::abs(last[i]) - step);
    if (last[i] > 0.0 && bounds.upper[i] > most) {
      bounds.upper[i] = most;
      bounds.lower[i] = std::min(bounds.lower[i], most);
      bounds.upper_limit[index] = BindingLimit::JointPosition;
    }
    if (last[i] < 0.0 && bounds.lower[i] < -most) {
      bounds.lower[i] = -most;
      bounds.upper[i] = std::max(bounds.upper[i], -most);
      bounds.lower_limit[index] = BindingLimit::JointPosition;
    }
  }
}

}  // namespace ajar
