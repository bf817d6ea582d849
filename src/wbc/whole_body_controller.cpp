#include "ajar/wbc/whole_body_controller.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "ajar/wbc/input_limits.hpp"
#include "ajar/wbc/task_qp.hpp"
#include "arm_reserve.hpp"

namespace ajar {
namespace {

constexpr int kSpeedFactor = kMaxInputs;
constexpr int kSlack = kMaxInputs + 1;
// A quarter of the start speed 20 mm/s: the force law answers it with less than 2 N (v/α at α = 3e-3).
constexpr double kMissedSpeed = 5e-3;
// The rate and base terms hold s a few percent below 1 without any limit.
constexpr double kSlowedFactor = 0.95;
// Own body: rows may separate the robot from itself, but gently (world rows never demand separation).
constexpr double kSelfSeparation = 0.05;
// Round-off of the wheel rows.
constexpr double kWheelRoom = 1e-9;
// Reserve of distance rows: the approach speed that the stop distance of the arm (3 cm) takes away per second.
constexpr double kClearanceScale = 0.1;
// On a straight way the turning weight grows by this: clearances are then kept by slowing down and not by turning away.
constexpr double kHeadingWeight = 100.0;
// Room in which a base turning at 0.6 rad/s stops a body half a metre away with 2.5 rad/s²: v²/2a = 4 cm. From twice that
// the base may begin to brake harder.
constexpr double kBrakingRoom = 0.04;

bool is_usable(const ClearanceRow& row, int joints) {
  return row.row.size() == joints + 2 && row.row.allFinite() && std::isfinite(row.distance) && row.normal.allFinite() &&
         row.point_on_obstacle.allFinite();
}

// A distance that is not a number may hide a wall: such a problem is refused as a whole.
bool is_usable(const ClearanceResult& clearance, int joints) {
  for (int i = 0; i < std::clamp(clearance.count, 0, kMaxClearanceRows); ++i) {
    if (!is_usable(clearance.rows[static_cast<size_t>(i)], joints)) {
      return false;
    }
  }
  return true;
}

bool is_usable(const BaseMotion& motion) {
  return std::isfinite(motion.twist.v) && std::isfinite(motion.twist.w) && motion.share >= 0.0 && motion.share <= 1.0;
}

// A sum shows a number that is not finite without a look at each.
bool is_usable(const WbcProblem& problem, int joints) {
  const Kinematics* kinematics = problem.kinematics;
  if (kinematics == nullptr || problem.q == nullptr || problem.q->size() != joints || kinematics->J.cols() != joints + 2 ||
      (problem.rates.size() != 0 && problem.rates.size() != joints)) {
    return false;
  }
  const double sum = problem.q->sum() + kinematics->J.sum() + kinematics->X_WE.translation().sum() +
                     problem.tangential.sum() + problem.correction.sum() + problem.free_axis.sum() + problem.free_axis_rate +
                     problem.base.v + problem.base.w + problem.rates.sum() + problem.leaf_velocity_at_hand.sum() +
                     problem.leaf_turn.sum();
  return std::isfinite(sum) && (!problem.base_motion || is_usable(*problem.base_motion)) &&
         (problem.clearance == nullptr || is_usable(*problem.clearance, joints));
}

const ClearanceLimits& limits_of(const ClearanceConfig& config, ClearanceKind kind) {
  switch (kind) {
    case ClearanceKind::Self: return config.self;
    case ClearanceKind::ArmWorld: return config.arm_world;
    default: return config.base_world;
  }
}

// Slowest allowed change of a distance: never demands separation from the world. (docs/equations.md#qp)
double least_rate(const ClearanceRow& row, const ClearanceConfig& config) {
  const ClearanceLimits& limits = limits_of(config, row.kind);
  const double rate = -limits.rate * (row.distance - limits.stop);
  return std::min(rate, row.kind == ClearanceKind::Self ? kSelfSeparation : 0.0);
}

// How much the base needs its brakes: 0 with room on all sides … 1 where a body comes within the braking room.
double braking_need(const WbcProblem& problem) {
  if (problem.clearance == nullptr) return 0.0;
  double room = 2.0 * kBrakingRoom;
  for (int i = 0; i < std::clamp(problem.clearance->count, 0, kMaxClearanceRows); ++i) {
    const ClearanceRow& row = problem.clearance->rows[static_cast<size_t>(i)];
    room = std::min(room, row.distance - limits_of(problem.clearance_config, row.kind).stop);
  }
  return std::clamp(2.0 - room / kBrakingRoom, 0.0, 1.0);
}

}  // namespace

struct WholeBodyController::Impl {
  Impl(const RobotModel& model, const WbcConfig& wbc, double period)
      : config(wbc), limits(make_input_limits(model, wbc, period)), n(limits.joints), reserve(limits, wbc) {
    last = plan = InputVector::Zero(n + 2);
    inverse_square_limit = limits.speed_upper.head(n).cwiseMax(1e-3).array().square().inverse();
    qp.weight[n + 1] = config.base_speed_weight;
    qp.weight[kSpeedFactor] = config.speed_weight;
    qp.wanted[kSpeedFactor] = 1.0;
    qp.upper[kSpeedFactor] = 1.0;
    qp.weight[kSlack] = config.slack_weight;
  }

  WbcConfig config;
  InputLimits limits;
  int n;
  ArmReserve reserve;
  JointVector inverse_square_limit;
  InputVector last;
  InputVector plan;  // last plan: the base's command, and the joint rates that suit it
  SigmaTrack sigma_track;
  InputBounds bounds;
  QpProblem qp;
  QpSolution answer;
  TaskQp solver;
  TaskQp arm_solver;
  std::array<double, kQpRows> row_scale{};
  int clearance_rows = 0;
  bool stopped = false;  // the solver, before the minimum

  void build_cost(const WbcProblem& problem, double sigma_min);
  void add_task(const WbcProblem& problem);
  void build_bounds(const WbcProblem& problem);
  void start_slack();
  void fix_base(const WbcProblem& problem, const BaseMotion& motion);
  bool make_plan(const WbcProblem& problem, WbcSolution& out);
  bool move_arm(const WbcProblem& problem, const BaseMotion& motion, WbcSolution& out);
  void add_wheel_rows();
  void add_clearance_rows(const WbcProblem& problem);
  void read(const WbcProblem& problem, WbcSolution& out);
  [[nodiscard]] BindingLimit binding_limit(int inputs) const;
};

// Rows S (J u - s V_t - V_c), those about a free axis exchanged.
void WholeBodyController::Impl::add_task(const WbcProblem& problem) {
  auto& A = qp.A;
  auto& b = qp.b;
  const auto set_column = [&](int i, const auto& column) {
    A.col(i).head<3>() = column.template head<3>();
    A.col(i).segment<3>(3) = config.length * column.template tail<3>();
  };
  for (int i = 0; i < n + 2; ++i) set_column(i, problem.kinematics->J.col(i));
  set_column(kSpeedFactor, -problem.tangential);
  b.head<6>() = problem.correction;
  b.segment<3>(3) *= config.length;
  qp.tasks = 6;
  const double axis_length = problem.free_axis.norm();
  if (axis_length <= 0.5) {
    return;
  }
  const Vector3d axis = problem.free_axis / axis_length;
  A.row(6) = axis.transpose() * A.middleRows<3>(3);
  A(6, kSpeedFactor) = 0.0;
  b[6] = config.length * problem.free_axis_rate;
  qp.tasks = config.free_axis_weight > 0.0 ? 7 : 6;
  const Matrix3d P = Matrix3d::Identity() - axis * axis.transpose();
  A.middleRows<3>(3) = (P * A.middleRows<3>(3)).eval();
  b.segment<3>(3) = (P * b.segment<3>(3)).eval();
}

// The hand's rows outweigh all others; near a singular arm the joints are spared, at the cost of the base.
void WholeBodyController::Impl::build_cost(const WbcProblem& problem, double sigma_min) {
  add_task(problem);
  const double nearness = std::max(0.0, 1.0 - sigma_min / config.singular_onset);
  const double softness = nearness * nearness;
  qp.task_weight.setConstant(config.hand_weight);
  qp.task_weight[6] = config.free_axis_weight;
  const double rate_weight = config.rate_weight + config.singular_damping * softness;
  for (int i = 0; i < n; ++i) {
    qp.weight[i] = rate_weight * inverse_square_limit[i];
    qp.wanted[i] = problem.rates.size() == 0 ? 0.0 : problem.rates[i] * config.rate_weight / rate_weight;
  }
  qp.weight[n] = config.base_turn_weight * (problem.keep_heading ? kHeadingWeight : 1.0);
  qp.wanted[n] = problem.base.w;
  qp.wanted[n + 1] = problem.base.v;
}

void WholeBodyController::Impl::build_bounds(const WbcProblem& problem) {
  const InputVector& before = problem.base_motion ? plan : last;
  bounds = input_bounds(limits, *problem.q, before, problem.base_fixed, braking_need(problem));
  if (!problem.base_fixed && limits.base_moves) reserve.bound_base(qp, *problem.q, before, bounds);
  qp.lower.head(n + 2) = bounds.lower;
  qp.upper.head(n + 2) = bounds.upper;
  qp.upper[kSlack] = 0.0;
  // The slowest motion that the bounds allow meets them all; the base's share of it must also suit the wheels.
  qp.start.head(n + 2) = bounds.lower.cwiseMax(0.0).cwiseMin(bounds.upper);
  qp.rows = 0;
  clearance_rows = 0;
  if (problem.clearance != nullptr) {
    add_clearance_rows(problem);
  }
  if (limits.base_moves) {
    InputVector start = qp.start.head(n + 2);
    limit_wheels(limits, start);
    qp.start.head(n + 2) = start;
    add_wheel_rows();
  }
  start_slack();
}

// The slack with which the start meets the clearance rows.
void WholeBodyController::Impl::start_slack() {
  qp.start[kSlack] = 0.0;
  for (int i = 0; i < clearance_rows; ++i) {
    qp.start[kSlack] = std::max(qp.start[kSlack], qp.c[i] - qp.C.row(i).head(n + 2).dot(qp.start.head(n + 2)));
  }
}

// The same problem for the arm alone, with the base moving as it will: not yet as it is told now.
void WholeBodyController::Impl::fix_base(const WbcProblem& problem, const BaseMotion& motion) {
  const Vector2d told(answer.x[n], answer.x[n + 1]);
  // Bounded against wild readings.
  const Vector2d moving = (Vector2d(motion.twist.w, motion.twist.v) + motion.share * (told - last.tail<2>()))
                              .cwiseMax(2.0 * limits.speed_lower.tail<2>())
                              .cwiseMin(2.0 * limits.speed_upper.tail<2>());
  bounds = input_bounds(limits, *problem.q, last, problem.base_fixed, 0.0);
  qp.lower.head(n) = bounds.lower.head(n);
  qp.upper.head(n) = bounds.upper.head(n);
  qp.start.head(n) = bounds.lower.head(n).cwiseMax(0.0).cwiseMin(bounds.upper.head(n));
  qp.lower.segment<2>(n) = moving;
  qp.upper.segment<2>(n) = moving;
  qp.start.segment<2>(n) = moving;
  qp.rows = clearance_rows;
  start_slack();
}

// |v ± ω b/2| ≤ rim speed.
void WholeBodyController::Impl::add_wheel_rows() {
  for (const double side : {-1.0, 1.0}) {
    for (const double sign : {-1.0, 1.0}) {
      qp.C.row(qp.rows).setZero();
      qp.C(qp.rows, n) = sign * side * limits.half_track;
      qp.C(qp.rows, n + 1) = sign;
      qp.c[qp.rows] = -limits.wheel_reach - kWheelRoom;
      row_scale[static_cast<size_t>(qp.rows)] = limits.wheel_reach;
      ++qp.rows;
    }
  }
}

// row·u - s n·v_leaf + slack ≥ least rate, one slack for all: the problem stays feasible.
void WholeBodyController::Impl::add_clearance_rows(const WbcProblem& problem) {
  const Vector3d hand = problem.kinematics->X_WE.translation();
  const int count = std::clamp(problem.clearance->count, 0, kMaxClearanceRows);
  for (int i = 0; i < count; ++i) {
    const ClearanceRow& row = problem.clearance->rows[static_cast<size_t>(i)];
    qp.C.row(qp.rows).setZero();
    qp.C.row(qp.rows).head(n + 2) = row.row;
    if (row.obstacle >= 0 && row.obstacle == problem.leaf_obstacle) {
      const Vector3d v_leaf = problem.leaf_velocity_at_hand + problem.leaf_turn.cross(row.point_on_obstacle - hand);
      qp.C(qp.rows, kSpeedFactor) = -row.normal.dot(v_leaf);
    }
    qp.C(qp.rows, kSlack) = 1.0;
    qp.c[qp.rows] = least_rate(row, problem.clearance_config);
    row_scale[static_cast<size_t>(qp.rows)] = kClearanceScale;
    ++qp.rows;
    ++clearance_rows;
  }
  if (clearance_rows > 0) {
    qp.upper[kSlack] = std::numeric_limits<double>::max();
  }
}

// The limit whose doubling would lower the cost most: multiplier times the amount by which it enters the bound. Of the
// first inputs, i.e. all or the arm's.
BindingLimit WholeBodyController::Impl::binding_limit(int inputs) const {
  BindingLimit best = BindingLimit::None;
  double gain = 1e-4;  // below the round-off of the multipliers times any limit
  const auto offer = [&](double multiplier, double scale, BindingLimit limit) {
    if (multiplier * scale > gain) {
      gain = multiplier * scale;
      best = limit;
    }
  };
  for (int i = 0; i < inputs; ++i) {
    const double step = limits.acceleration[i] * limits.period;
    const auto scale = [&](BindingLimit limit) {
      const bool acceleration = limit == BindingLimit::JointAcceleration || limit == BindingLimit::BaseAcceleration;
      return acceleration ? step : limits.speed_upper[i];
    };
    const BindingLimit low = bounds.lower_limit[static_cast<size_t>(i)];
    const BindingLimit high = bounds.upper_limit[static_cast<size_t>(i)];
    offer(answer.lower_multiplier[i], scale(low), low);
    offer(answer.upper_multiplier[i], scale(high), high);
  }
  for (int i = 0; i < qp.rows; ++i) {
    const bool wheel = i >= clearance_rows;
    offer(answer.row_multiplier[i], row_scale[static_cast<size_t>(i)],
          wheel ? BindingLimit::WheelSpeed : BindingLimit::Clearance);
  }
  return best;
}

// Base and arm together, as if the base followed at once: what the base is told, and how fast the path is made.
bool WholeBodyController::Impl::make_plan(const WbcProblem& problem, WbcSolution& out) {
  build_bounds(problem);
  const QpStatus status = solver.solve(qp, answer);
  if (status == QpStatus::Invalid) return false;
  stopped = status == QpStatus::Stopped;
  out.u = answer.x.head(n + 2).cwiseMax(bounds.lower).cwiseMin(bounds.upper);
  limit_wheels(limits, out.u);
  out.binding = binding_limit(n + 2);
  plan = out.u;
  return true;
}

// The arm against the base as it moves.
bool WholeBodyController::Impl::move_arm(const WbcProblem& problem, const BaseMotion& motion, WbcSolution& out) {
  fix_base(problem, motion);
  const QpStatus status = arm_solver.solve(qp, answer);
  if (status == QpStatus::Invalid) return false;
  stopped = stopped || status == QpStatus::Stopped;
  out.u.head(n) = answer.x.head(n).cwiseMax(bounds.lower.head(n)).cwiseMin(bounds.upper.head(n));
  const BindingLimit binding = binding_limit(n);
  if (binding != BindingLimit::None) out.binding = binding;
  return true;
}

void WholeBodyController::Impl::read(const WbcProblem& problem, WbcSolution& out) {
  out.speed_factor = std::clamp(answer.x[kSpeedFactor], 0.0, 1.0);
  out.slack = std::max(0.0, answer.x[kSlack]);
  const HandJacobian& J = problem.kinematics->J;
  const Vector3d velocity = J.topRows<3>() * answer.x.head(n + 2);
  out.residual = (velocity - out.speed_factor * problem.tangential.head<3>() - problem.correction.head<3>()).norm();
  if (stopped) {
    out.status = WbcStatus::Stopped;
  } else if (out.residual > kMissedSpeed) {
    out.status = WbcStatus::Limited;
  } else if (out.speed_factor < kSlowedFactor) {
    out.status = WbcStatus::Slowed;
  } else {
    out.status = out.sigma_min < config.singular_onset ? WbcStatus::Damped : WbcStatus::Ok;
  }
}

WholeBodyController::WholeBodyController(const RobotModel& model, const WbcConfig& config, double period) {
  config.validate();
  impl_ = std::make_unique<Impl>(model, config, period);
}

WholeBodyController::~WholeBodyController() = default;

void WholeBodyController::reset() noexcept { reset(InputVector::Zero(impl_->n + 2)); }

void WholeBodyController::reset(const InputVector& last_command) noexcept {
  const bool usable = last_command.size() == impl_->n + 2 && last_command.allFinite();
  impl_->last = usable ? last_command : InputVector(InputVector::Zero(impl_->n + 2));
  impl_->plan = impl_->last;
  impl_->solver.forget();
  impl_->arm_solver.forget();
  impl_->reserve.forget();
  impl_->sigma_track = {};
}

WbcStatus WholeBodyController::solve(const WbcProblem& problem, WbcSolution& out) noexcept {
  Impl& impl = *impl_;
  if (!is_usable(problem, impl.n)) {
    brake(out);
    return out.status = WbcStatus::Invalid;
  }
  out.sigma_min = arm_sigma_min(*problem.kinematics, impl.config.length, impl.sigma_track);
  impl.build_cost(problem, std::isfinite(out.sigma_min) ? out.sigma_min : 0.0);
  if (!impl.make_plan(problem, out) || (problem.base_motion && !impl.move_arm(problem, *problem.base_motion, out))) {
    brake(out);
    return out.status = WbcStatus::Invalid;
  }
  impl.read(problem, out);
  impl.last = out.u;
  return out.status;
}

void WholeBodyController::brake(WbcSolution& out) noexcept {
  Impl& impl = *impl_;
  out = WbcSolution{};
  out.u = braked_input(impl.limits, impl.last);
  out.status = WbcStatus::Slowed;
  impl.last = impl.plan = out.u;
}

}  // namespace ajar
