#include "ajar/wbc/input_limits.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "ajar/core/error.hpp"

namespace ajar {
namespace {

// Rim speed of the faster wheel.
double wheel_load(const InputLimits& limits, double w, double v) { return std::abs(v) + limits.half_track * std::abs(w); }

// A bound of one input and the limit that it comes from.
struct Bound {
  double rate;
  BindingLimit limit;
};

// Steps of one input in one tick.
struct Step {
  double up;    // away from zero
  double down;  // towards zero, at least as large
};

// Range of the acceleration limits around the last command, moved into the range that must hold anyway.
void set_bounds(InputBounds& bounds, int i, double last, Step step, const Bound& low, const Bound& high,
                BindingLimit step_limit) {
  bounds.rate_lower[i] = low.rate;
  bounds.rate_upper[i] = high.rate;
  bounds.lower[i] = std::clamp(std::min(last - step.up, std::max(last - step.down, 0.0)), low.rate, high.rate);
  bounds.upper[i] = std::clamp(std::max(last + step.up, std::min(last + step.down, 0.0)), low.rate, high.rate);
  bounds.lower_limit[static_cast<size_t>(i)] = bounds.lower[i] > low.rate ? step_limit : low.limit;
  bounds.upper_limit[static_cast<size_t>(i)] = bounds.upper[i] < high.rate ? step_limit : high.limit;
}

// min(V, stopping rate). d/(nT) + A T (n - 1)/2 is at least √(2 A d) - A T/2 for every n: far from the limit V is the
// answer.
double stopping_rate_below(double top, double distance, double deceleration, double period) {
  const double reach = top + 0.5 * deceleration * period;
  if (2.0 * deceleration * distance > reach * reach) {
    return top;
  }
  return std::min(top, stopping_rate(distance, deceleration, period));
}

double brake_step(double last, double step) { return last - std::clamp(last, -step, step); }

// The base bounds must leave at least one pair (ω, v) that the wheels can turn: acceleration yields.
void reach_wheel_limit(const InputLimits& limits, InputBounds& bounds) {
  const int w = limits.joints;
  const int v = w + 1;
  const double w_least = std::clamp(0.0, bounds.lower[w], bounds.upper[w]);
  const double v_least = std::clamp(0.0, bounds.lower[v], bounds.upper[v]);
  const double load = wheel_load(limits, w_least, v_least);
  if (load <= limits.wheel_reach) {
    return;
  }
  const double scale = limits.wheel_reach / load;
  bounds.lower[w] = std::min(bounds.lower[w], scale * w_least);
  bounds.upper[w] = std::max(bounds.upper[w], scale * w_least);
  bounds.lower[v] = std::min(bounds.lower[v], scale * v_least);
  bounds.upper[v] = std::max(bounds.upper[v], scale * v_least);
}

}  // namespace

InputLimits make_input_limits(const RobotModel& model, const WbcConfig& config, double period) {
  if (!(period > 0.0 && period <= 0.1)) {
    throw ConfigError("control period = " + std::to_string(period) + " s: must be in (0, 0.1]");
  }
  const RobotLimits& robot = model.limits();
  const int n = model.joints();
  InputLimits limits;
  limits.joints = n;
  limits.base_moves = model.base_type() == BaseType::Differential;
  limits.period = period;
  // A range narrower than two margins keeps a tenth of itself on each side.
  const JointVector margin = (0.1 * (robot.position_upper - robot.position_lower)).cwiseMin(config.position_margin);
  limits.position_lower = robot.position_lower + margin;
  limits.position_upper = robot.position_upper - margin;
  limits.speed_lower = InputVector::Zero(n + 2);
  limits.speed_upper = InputVector::Zero(n + 2);
  limits.acceleration = InputVector::Constant(n + 2, config.joint_acceleration);
  limits.speed_upper.head(n) = config.rate_scale * robot.velocity;
  limits.speed_lower.head(n) = -limits.speed_upper.head(n);
  limits.acceleration.head(n) = robot.acceleration.cwiseMin(config.joint_acceleration);
  limits.acceleration[n] = std::min(config.base_yaw_acceleration, robot.base_yaw_acceleration);
  limits.acceleration[n + 1] = std::min(config.base_acceleration, robot.base_acceleration);
  limits.deceleration = limits.acceleration;
  limits.deceleration[n] = std::min(config.base_braking * config.base_yaw_acceleration, robot.base_yaw_acceleration);
  limits.deceleration[n + 1] = std::min(config.base_braking * config.base_acceleration, robot.base_acceleration);
  if (limits.base_moves) {
    limits.speed_upper[n] = std::min(config.base_yaw_rate, robot.base_yaw_rate);
    limits.speed_lower[n] = -limits.speed_upper[n];
    limits.speed_upper[n + 1] = std::min(config.base_forward, robot.base_forward);
    limits.speed_lower[n + 1] = -std::min(config.base_reverse, robot.base_reverse);
    limits.wheel_reach = robot.wheel_speed * model.wheel_radius();
    limits.half_track = 0.5 * model.wheel_track();
  }
  return limits;
}

double stopping_rate(double distance, double deceleration, double period) noexcept {
  if (!(distance > 0.0)) {
    return 0.0;
  }
  // Stopping from n full steps A T takes n(n + 1)/2 units of A T²; between these rates the distance is linear.
  const double unit = deceleration * period * period;
  const double steps = std::max(1.0, std::ceil(0.5 * (std::sqrt(1.0 + 8.0 * distance / unit) - 1.0)));
  return distance / (steps * period) + 0.5 * deceleration * period * (steps - 1.0);
}

InputBounds input_bounds(const InputLimits& limits, const JointVector& q, const InputVector& last, bool base_fixed,
                         double need) noexcept {
  const int n = limits.joints;
  InputBounds bounds;
  bounds.rate_lower = InputVector::Zero(n + 2);
  bounds.rate_upper = InputVector::Zero(n + 2);
  bounds.lower = InputVector::Zero(n + 2);
  bounds.upper = InputVector::Zero(n + 2);
  for (int i = 0; i < n; ++i) {
    const double A = limits.acceleration[i];
    const double up = stopping_rate_below(limits.speed_upper[i], limits.position_upper[i] - q[i], A, limits.period);
    const double down = stopping_rate_below(-limits.speed_lower[i], q[i] - limits.position_lower[i], A, limits.period);
    const bool near_upper = up < limits.speed_upper[i];
    const bool near_lower = -down > limits.speed_lower[i];
    const Bound low{-down, near_lower ? BindingLimit::JointPosition : BindingLimit::JointRate};
    const Bound high{up, near_upper ? BindingLimit::JointPosition : BindingLimit::JointRate};
    const double step = A * limits.period;
    set_bounds(bounds, i, last[i], {step, step}, low, high, BindingLimit::JointAcceleration);
  }
  for (int i = n; i < n + 2; ++i) {
    const double up = limits.acceleration[i];
    const double down = base_fixed ? limits.deceleration[i] : up + need * (limits.deceleration[i] - up);
    const Step step{up * limits.period, down * limits.period};
    set_bounds(bounds, i, last[i], step, {limits.speed_lower[i], BindingLimit::BaseSpeed},
               {limits.speed_upper[i], BindingLimit::BaseSpeed}, BindingLimit::BaseAcceleration);
    if (base_fixed || !limits.base_moves) {
      const double stopping = std::clamp(brake_step(last[i], step.down), limits.speed_lower[i], limits.speed_upper[i]);
      bounds.rate_lower[i] = 0.0;
      bounds.rate_upper[i] = 0.0;
      bounds.lower[i] = stopping;
      bounds.upper[i] = stopping;
    }
  }
  if (limits.base_moves) {
    reach_wheel_limit(limits, bounds);
  }
  return bounds;
}

InputVector braked_input(const InputLimits& limits, const InputVector& last) noexcept {
  InputVector u = last;
  for (int i = 0; i < u.size(); ++i) {
    u[i] = std::clamp(brake_step(last[i], limits.deceleration[i] * limits.period), limits.speed_lower[i],
                      limits.speed_upper[i]);
  }
  limit_wheels(limits, u);
  return u;
}

void limit_wheels(const InputLimits& limits, InputVector& u) noexcept {
  const int n = limits.joints;
  const double load = wheel_load(limits, u[n], u[n + 1]);
  if (limits.base_moves && load > limits.wheel_reach) {
    u.tail<2>() *= limits.wheel_reach / load;
  }
}

}  // namespace ajar
