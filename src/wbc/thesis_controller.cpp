#include "ajar/wbc/thesis_controller.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "ajar/core/so3.hpp"
#include "ajar/wbc/printed_laws.hpp"

namespace ajar {
namespace {

// Below this planar speed, or this share of the speed, the direction of motion defines no heading.
constexpr double kLeastPlanarSpeed = 0.01;
constexpr double kLeastPlanarShare = 0.2;
// The driving sense changes only when the heading error passes a right angle by 15°.
constexpr double kSenseHysteresis = std::numbers::pi / 2.0 + std::numbers::pi / 12.0;
// Same meaning as in the QP: residual of the hand's linear rows and speed factor that count as missed and slowed.
constexpr double kMissedSpeed = 5e-3;
constexpr double kSlowedFactor = 0.999;

// Largest factor k in [0, 1] with start + k·step inside lower … upper and the wheels' reach.
double common_factor(const InputLimits& limits, const InputVector& lower, const InputVector& upper, const InputVector& start,
                     const InputVector& step) {
  double factor = 1.0;
  const auto hold = [&factor](double at, double change, double low, double high) {
    if (change > 0.0) {
      factor = std::min(factor, (high - at) / change);
    } else if (change < 0.0) {
      factor = std::min(factor, (low - at) / change);
    }
  };
  for (int i = 0; i < start.size(); ++i) {
    hold(start[i], step[i], lower[i], upper[i]);
  }
  if (limits.base_moves) {
    const int w = limits.joints;
    for (const double side : {-1.0, 1.0}) {
      const double reach = limits.half_track * side;
      hold(start[w + 1] + reach * start[w], step[w + 1] + reach * step[w], -limits.wheel_reach, limits.wheel_reach);
    }
  }
  return std::clamp(factor, 0.0, 1.0);
}

bool is_usable(const WbcProblem& problem, int joints) {
  return problem.kinematics != nullptr && problem.q != nullptr && problem.q->size() == joints && problem.q->allFinite() &&
         problem.kinematics->J.cols() == joints + 2 && problem.kinematics->J.allFinite() &&
         problem.kinematics->distance_jacobian.size() == joints + 2 && problem.kinematics->distance_jacobian.allFinite() &&
         std::isfinite(problem.kinematics->distance) && problem.tangential.allFinite() && problem.correction.allFinite();
}

}  // namespace

HeadingReference heading_reference(const Vector6d& twist) noexcept {
  const Vector3d v = twist.head<3>();
  const double planar = v.head<2>().norm();
  if (!(planar > std::max(kLeastPlanarSpeed, kLeastPlanarShare * v.norm()))) {
    return {};
  }
  const Vector3d change = twist.tail<3>().cross(v);
  return {std::atan2(v.y(), v.x()), (v.x() * change.y() - v.y() * change.x()) / (planar * planar), true};
}

InputVector distance_task(const Kinematics& kinematics, double wanted, double alpha) noexcept {
  return -alpha * (kinematics.distance - wanted) * kinematics.distance_jacobian.transpose();
}

ThesisController::ThesisController(const RobotModel& model, const ThesisConfig& config, const WbcConfig& limits,
                                   double period)
    : config_(config), limits_config_(limits) {
  config.validate();
  limits.validate();
  limits_ = make_input_limits(model, limits, period);
  const int n = limits_.joints;
  weight_ = InputVector::Ones(n + 2);
  // W = diag(ρ_i / u_i,max²): independent of the units of the inputs. A base that cannot move has no authority.
  for (int i = 0; i < n + 2; ++i) {
    const double largest = std::max(limits_.speed_upper[i], 1e-3);
    weight_[i] = config.unit_weights ? 1.0 : (i < n ? 1.0 : config.w_base) / (largest * largest);
  }
  last_ = InputVector::Zero(n + 2);
  forget();
}

void ThesisController::forget() noexcept {
  const InputVector rest = InputVector::Zero(limits_.joints + 2);
  parts_ = {rest, 0.0, rest};
}

void ThesisController::reset() noexcept {
  last_.setZero();
  forget();
  heading_integral_ = 0.0;
  drive_sense_ = 0;
  saturated_ = false;
}

void ThesisController::reset(const InputVector& last_command) noexcept {
  reset();
  if (last_command.size() == limits_.joints + 2 && last_command.allFinite()) {
    last_ = last_command;
    parts_.idle = last_command;
  }
}

// Signed error modulo π; which of the two senses counts is kept with hysteresis, or the nearer one at every instant.
double ThesisController::heading_error(double yaw, const HeadingReference& reference) noexcept {
  if (config_.heading == "folded") return wrap_half_turn(yaw - reference.heading);
  double error = wrap_angle(yaw - reference.heading - (drive_sense_ < 0 ? std::numbers::pi : 0.0));
  if (drive_sense_ == 0) {
    drive_sense_ = std::abs(error) <= std::numbers::pi / 2.0 ? 1 : -1;
  } else if (std::abs(error) > kSenseHysteresis) {
    drive_sense_ = -drive_sense_;
  }
  return wrap_angle(yaw - reference.heading - (drive_sense_ < 0 ? std::numbers::pi : 0.0));
}

double ThesisController::heading_task(double yaw, const Vector6d& twist) noexcept {
  const HeadingReference reference = heading_reference(twist);
  if (!reference.valid) return 0.0;
  const double error = config_.printed ? printed_heading_error(yaw, twist) : heading_error(yaw, reference);
  if (config_.feed_forward) return reference.rate - config_.alpha2 * error;
  if (!saturated_) {
    heading_integral_ = std::clamp(heading_integral_ + limits_.period * error, -config_.integral_max, config_.integral_max);
  }
  return -config_.alpha2 * error - config_.alpha3 * heading_integral_;
}

InputVector ThesisController::null_space_motion(const WbcProblem& problem) noexcept {
  const int n = limits_.joints;
  InputVector z = distance_task(*problem.kinematics, config_.distance, config_.alpha1);
  const double yaw = std::atan2(problem.kinematics->J(1, n + 1), problem.kinematics->J(0, n + 1));
  z[n] += heading_task(yaw, problem.tangential);
  return z;
}

ThesisController::Resolution ThesisController::resolve(const HandJacobian& J) const noexcept {
  Resolution out;
  out.inverse = damped_pseudo_inverse(J, weight_, {config_.epsilon, config_.lambda_max, limits_config_.length});
  if (config_.printed) {
    out.inverse.matrix = ridge_inverse(J, weight_, printed_damping(J, config_.lambda_max, config_.epsilon));
    out.projector = printed_projector(J, out.inverse.matrix);
    return out;
  }
  if (config_.constant_damping > 0.0) out.inverse.matrix = ridge_inverse(J, weight_, config_.constant_damping);
  out.projector = null_space_projector(J, weight_);
  return out;
}

// Every input alone at its limit: the direction of the motion is lost as soon as one of them is cut.
InputVector ThesisController::clipped(const InputBounds& bounds, const InputVector& wanted) noexcept {
  saturated_ = false;
  parts_.factor = 1.0;
  return wanted.cwiseMax(bounds.rate_lower).cwiseMin(bounds.rate_upper);
}

// Moves the parts of the last command towards the wanted ones as far as limits and accelerations allow.
InputVector ThesisController::scaled(const InputBounds& bounds, const InputVector& tangential,
                                     const Parts& wanted) noexcept {
  const InputVector rest = InputVector::Zero(limits_.joints + 2);
  Parts goal = wanted;
  const auto share = [&](const InputVector& start, const InputVector& step) {
    return common_factor(limits_, bounds.rate_lower, bounds.rate_upper, start, step);
  };
  goal.correction *= share(rest, wanted.correction);
  goal.factor = share(goal.correction, tangential);
  const double idle_share = share(goal.correction + goal.factor * tangential, wanted.idle);
  goal.idle *= idle_share;
  saturated_ = idle_share < 1.0;

  InputVector u = parts_.correction + parts_.factor * tangential + parts_.idle;
  const auto advance = [&](const InputVector& step) {
    const double factor = common_factor(limits_, bounds.lower, bounds.upper, u, step);
    u += factor * step;
    return factor;
  };
  const InputVector correction_step = goal.correction - parts_.correction;
  parts_.correction += advance(correction_step) * correction_step;
  const double factor_step = goal.factor - parts_.factor;
  parts_.factor += advance(factor_step * tangential) * factor_step;
  const InputVector idle_step = goal.idle - parts_.idle;
  parts_.idle += advance(idle_step) * idle_step;
  return u;
}

WbcStatus ThesisController::solve(const WbcProblem& problem, WbcSolution& out) noexcept {
  if (!is_usable(problem, limits_.joints)) {
    brake(out);
    return out.status = WbcStatus::Invalid;
  }
  const bool base_stands = !limits_.base_moves || problem.base_fixed;
  HandJacobian J = problem.kinematics->J;
  Parts wanted{InputVector(), 1.0, null_space_motion(problem)};
  if (base_stands) {
    J.rightCols<2>().setZero();
    wanted.idle.tail<2>().setZero();
  }
  const InputBounds bounds = input_bounds(limits_, *problem.q, last_, problem.base_fixed);
  const auto [inverse, N] = resolve(config_.printed ? printed_base_column(J) : J);
  wanted.correction = inverse.matrix * problem.correction;
  wanted.idle = N.lazyProduct(wanted.idle).eval();
  parts_.idle = N.lazyProduct(parts_.idle).eval();  // still without effect on the hand after the arm has moved

  const InputVector along = inverse.matrix * problem.tangential;
  if (config_.limits == "each") {
    out.u = clipped(bounds, wanted.correction + along + wanted.idle);
  } else {
    out.u = scaled(bounds, along, wanted).cwiseMax(bounds.lower).cwiseMin(bounds.upper);
  }
  limit_wheels(limits_, out.u);
  out.speed_factor = parts_.factor;
  out.sigma_min = inverse.sigma_min;
  out.slack = 0.0;
  out.binding = BindingLimit::None;
  const Vector6d missed = J * out.u - out.speed_factor * problem.tangential - problem.correction;
  out.residual = missed.head<3>().norm();
  out.status = out.residual > kMissedSpeed        ? WbcStatus::Limited
               : out.speed_factor < kSlowedFactor ? WbcStatus::Slowed
               : inverse.squared_damping > 0.0    ? WbcStatus::Damped
                                                  : WbcStatus::Ok;
  last_ = out.u;
  return out.status;
}

void ThesisController::brake(WbcSolution& out) noexcept {
  out = WbcSolution{};
  out.u = braked_input(limits_, last_);
  out.status = WbcStatus::Slowed;
  last_ = out.u;
  parts_.correction.setZero();
  parts_.factor = 0.0;
  parts_.idle = out.u;
}

}  // namespace ajar
