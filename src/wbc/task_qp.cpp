#include "ajar/wbc/task_qp.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ajar {
namespace {

// Bounds closer than this fix the variable.
constexpr double kFixedGap = 1e-12;
// A row whose squared part outside the others is less than this share of its square depends on them.
constexpr double kDependent = 1e-14;
// What round-off may leave of a limit, in units of the variables; bounds are met exactly afterwards.
constexpr double kRoundOff = 1e-10;
// Multipliers whose sign is round-off: of the largest one, and where all are small.
constexpr double kRelativeSign = 1e-12;
constexpr double kAbsoluteSign = 1e-9;
// Sum of multipliers above which the minimum is refined: 1e-16 of it times a mobility of 100 begins to show.
constexpr double kLargeMultiplier = 1e4;
// Each iteration adds or drops one limit. Random problems with 28 rows need at most some sixty, doors two or three.
constexpr int kMaxIterations = 200;

bool has_room(const QpProblem& problem, int i) { return problem.upper[i] - problem.lower[i] > kFixedGap; }

// Sums show a number that is not finite without a look at each; infinities of both signs give NaN.
bool is_usable(const QpProblem& p) {
  if (p.rows < 0 || p.rows > kQpRows || p.tasks < 0 || p.tasks > kQpTasks) {
    return false;
  }
  const double sum = p.weight.sum() + p.wanted.sum() + p.A.topRows(p.tasks).sum() + p.b.head(p.tasks).sum() +
                     p.C.topRows(p.rows).sum() + p.c.head(p.rows).sum() + p.start.sum();
  return std::isfinite(sum) && p.weight.minCoeff() > 0.0 && (p.upper - p.lower).minCoeff() >= 0.0 &&
         (p.tasks == 0 || p.task_weight.head(p.tasks).minCoeff() > 0.0);
}

}  // namespace

void TaskQp::forget() noexcept {
  side_.fill(Side::Free);
  active_count_ = 0;
}

bool TaskQp::is_active(int row) const noexcept {
  return std::find(active_.begin(), active_.begin() + active_count_, row) != active_.begin() + active_count_;
}

bool TaskQp::is_feasible(const QpProblem& problem, const QpVector& x) const noexcept {
  if ((problem.lower - x).maxCoeff() > kRoundOff || (x - problem.upper).maxCoeff() > kRoundOff) {
    return false;
  }
  for (int i = 0; i < problem.rows; ++i) {
    if (problem.C.row(i).dot(x) < problem.c[i] - kRoundOff) {
      return false;
    }
  }
  return true;
}

// The limits of the last call, as far as they exist now.
void TaskQp::guess(const QpProblem& problem) noexcept {
  for (int i = 0; i < kQpVariables; ++i) {
    Side& side = side_[static_cast<size_t>(i)];
    if (!has_room(problem, i)) {
      side = Side::Fixed;
    } else if (side == Side::Fixed) {
      side = Side::Free;
    }
  }
  active_count_ = static_cast<int>(
      std::remove_if(active_.begin(), active_.begin() + active_count_, [&](int row) { return row >= problem.rows; }) -
      active_.begin());
}

// E = active rows of A and C; y = bounds of the held variables, wishes of the free ones; e = right side minus E y.
void TaskQp::gather(const QpProblem& problem) noexcept {
  for (int i = 0; i < kQpVariables; ++i) {
    const Side side = side_[static_cast<size_t>(i)];
    mobility_[i] = side == Side::Free ? 1.0 / problem.weight[i] : 0.0;
    target_[i] = side == Side::Free ? problem.wanted[i] : side == Side::Upper ? problem.upper[i] : problem.lower[i];
  }
  equations_ = problem.tasks + active_count_;
  E_.topRows(problem.tasks) = problem.A.topRows(problem.tasks);
  e_.head(problem.tasks) = problem.b.head(problem.tasks);
  for (int k = 0; k < active_count_; ++k) {
    const int row = active_[static_cast<size_t>(k)];
    E_.row(problem.tasks + k) = problem.C.row(row);
    e_[problem.tasks + k] = problem.c[row];
  }
  for (int i = 0; i < equations_; ++i) {
    e_[i] -= E_.row(i).dot(target_);
  }
}

// Takes a row out of the active ones and out of E and e.
void TaskQp::drop(const QpProblem& problem, int place) noexcept {
  for (int k = place; k + 1 < active_count_; ++k) {
    active_[static_cast<size_t>(k)] = active_[static_cast<size_t>(k + 1)];
    E_.row(problem.tasks + k) = E_.row(problem.tasks + k + 1);
    e_[problem.tasks + k] = e_[problem.tasks + k + 1];
  }
  --active_count_;
  equations_ = problem.tasks + active_count_;
}

// Cholesky factor of E D⁻¹ Eᵀ + W⁻¹ and, on the way, L⁻¹ e. The diagonal holds the reciprocals. An active row that depends
// on those before it is no longer counted as active: its multiplier would be arbitrary.
void TaskQp::factorise(const QpProblem& problem) noexcept {
  for (int i = 0; i < equations_; ++i) {
    const QpVector moved = E_.row(i).transpose().cwiseProduct(mobility_);
    const double own = E_.row(i).dot(moved);
    double value = e_[i];
    double pivot = own + (i < problem.tasks ? 1.0 / problem.task_weight[i] : 0.0);
    for (int j = 0; j < i; ++j) {
      double sum = E_.row(j).dot(moved);
      for (int k = 0; k < j; ++k) {
        sum -= L_(i, k) * L_(j, k);
      }
      L_(i, j) = sum * L_(j, j);
      pivot -= L_(i, j) * L_(i, j);
      value -= L_(i, j) * half_[j];
    }
    if (i >= problem.tasks && pivot <= kDependent * own) {
      drop(problem, i - problem.tasks);
      --i;
      continue;
    }
    L_(i, i) = 1.0 / std::sqrt(std::max(pivot, std::numeric_limits<double>::min()));
    half_[i] = value * L_(i, i);
  }
}

// Adds (L Lᵀ)⁻¹ e to the multipliers and its effect to x; the half L⁻¹ e stands in `half`.
void TaskQp::back_substitute(EquationVector& half) noexcept {
  QpVector pull = QpVector::Zero();
  for (int i = equations_ - 1; i >= 0; --i) {
    half[i] *= L_(i, i);
    for (int j = 0; j < i; ++j) {
      half[j] -= L_(i, j) * half[i];
    }
    pull += half[i] * E_.row(i).transpose();
  }
  pull_ += pull;
  target_ += mobility_.cwiseProduct(pull);
  multiplier_.head(equations_) += half.head(equations_);
}

// x = y + D⁻¹ Eᵀ λ with (E D⁻¹ Eᵀ + W⁻¹) λ = e.
void TaskQp::minimise(const QpProblem& problem) noexcept {
  gather(problem);
  factorise(problem);
  pull_.setZero();
  multiplier_.setZero();
  back_substitute(half_);
  // Tasks that the limits forbid have multipliers of weight times miss, whose round-off shows: once more for the rest.
  if (!(multiplier_.head(equations_).cwiseAbs().sum() > kLargeMultiplier)) {
    return;
  }
  for (int i = 0; i < equations_; ++i) {
    const bool task = i < problem.tasks;
    const double wanted = task ? problem.b[i] : problem.c[active_[static_cast<size_t>(i - problem.tasks)]];
    double rest = wanted - E_.row(i).dot(target_) - (task ? multiplier_[i] / problem.task_weight[i] : 0.0);
    for (int j = 0; j < i; ++j) {
      rest -= L_(i, j) * half_[j];
    }
    half_[i] = rest * L_(i, i);
  }
  back_substitute(half_);
}

// From the known point as far towards the guess as the rows allow; only what is met exactly stays active.
void TaskQp::retreat(const QpProblem& problem) noexcept {
  const QpVector goal = target_.cwiseMax(problem.lower).cwiseMin(problem.upper);
  const QpVector way = goal - problem.start;
  double share = 1.0;
  for (int i = 0; i < problem.rows; ++i) {
    const double change = problem.C.row(i).dot(way);
    const double room = problem.C.row(i).dot(problem.start) - problem.c[i];
    if (change < 0.0 && room + change < 0.0) {
      share = std::min(share, std::max(room, 0.0) / -change);
    }
  }
  x_ = problem.start + share * way;
  active_count_ = 0;
  for (int i = 0; i < kQpVariables; ++i) {
    Side& side = side_[static_cast<size_t>(i)];
    if (side == Side::Fixed) {
      x_[i] = problem.lower[i];
    } else {
      x_[i] = std::clamp(x_[i], problem.lower[i], problem.upper[i]);
      side = x_[i] <= problem.lower[i] ? Side::Lower : x_[i] >= problem.upper[i] ? Side::Upper : Side::Free;
    }
  }
}

// Moves to the minimum on the active limits, or to the first limit on the way, which becomes active. True: arrived.
bool TaskQp::advance(const QpProblem& problem) noexcept {
  const QpVector way = target_ - x_;
  double share = 1.0;
  int blocked = -1;  // variable, or kQpVariables + row
  for (int i = 0; i < kQpVariables; ++i) {
    const double bound = way[i] < 0.0 ? problem.lower[i] : problem.upper[i];
    const double room = bound - x_[i];
    if (mobility_[i] > 0.0 && std::abs(way[i]) > std::abs(room) && std::abs(room) < share * std::abs(way[i])) {
      share = std::abs(room / way[i]);
      blocked = i;
    }
  }
  for (int i = 0; i < problem.rows; ++i) {
    const double change = problem.C.row(i).dot(way);
    const double room = std::max(problem.C.row(i).dot(x_) - problem.c[i], 0.0);
    if (change < -kRoundOff && room < -share * change && !is_active(i)) {
      share = room / -change;
      blocked = kQpVariables + i;
    }
  }
  if (blocked < 0) {
    x_ = target_;
    return true;
  }
  x_ += share * way;
  if (blocked < kQpVariables) {
    const bool down = way[blocked] < 0.0;
    x_[blocked] = down ? problem.lower[blocked] : problem.upper[blocked];
    side_[static_cast<size_t>(blocked)] = down ? Side::Lower : Side::Upper;
  } else if (active_count_ < kQpVariables) {
    active_[static_cast<size_t>(active_count_++)] = blocked - kQpVariables;
  }
  return false;
}

// Lets go of the limit whose multiplier has the wrong sign most. False: there is none, x is the minimum.
bool TaskQp::release(const QpProblem& problem) noexcept {
  double worst = kAbsoluteSign;
  if (equations_ > 0) {
    worst += kRelativeSign * multiplier_.head(equations_).cwiseAbs().maxCoeff();
  }
  int found = -1;
  for (int i = 0; i < kQpVariables; ++i) {
    const Side side = side_[static_cast<size_t>(i)];
    if (side == Side::Lower || side == Side::Upper) {
      const double force = problem.weight[i] * (x_[i] - problem.wanted[i]) - pull_[i];
      const double wrong = side == Side::Lower ? -force : force;
      if (wrong > worst) {
        worst = wrong;
        found = i;
      }
    }
  }
  for (int k = 0; k < active_count_; ++k) {
    const double wrong = -multiplier_[problem.tasks + k];
    if (wrong > worst) {
      worst = wrong;
      found = kQpVariables + k;
    }
  }
  if (found < 0) {
    return false;
  }
  if (found < kQpVariables) {
    side_[static_cast<size_t>(found)] = Side::Free;
  } else {
    drop(problem, found - kQpVariables);
  }
  return true;
}

void TaskQp::report(const QpProblem& problem, QpSolution& out) const noexcept {
  out.x = x_.cwiseMax(problem.lower).cwiseMin(problem.upper);
  for (int i = 0; i < kQpVariables; ++i) {
    if (mobility_[i] == 0.0) {
      const double force = problem.weight[i] * (x_[i] - problem.wanted[i]) - pull_[i];
      out.lower_multiplier[i] = std::max(force, 0.0);
      out.upper_multiplier[i] = std::max(-force, 0.0);
    }
  }
  for (int k = 0; k < active_count_; ++k) {
    out.row_multiplier[active_[static_cast<size_t>(k)]] = std::max(multiplier_[problem.tasks + k], 0.0);
  }
}

QpStatus TaskQp::solve(const QpProblem& problem, QpSolution& out) noexcept {
  out = QpSolution{};
  if (!is_usable(problem) || !is_feasible(problem, problem.start)) {
    forget();
    return QpStatus::Invalid;
  }
  guess(problem);
  minimise(problem);
  bool arrived = is_feasible(problem, target_);
  if (arrived) {
    x_ = target_;
  } else {
    retreat(problem);
    minimise(problem);
  }
  QpStatus status = QpStatus::Stopped;
  for (out.iterations = 1; out.iterations < kMaxIterations; ++out.iterations) {
    if (!arrived) {
      arrived = advance(problem);
    } else if (release(problem)) {
      arrived = false;
    } else {
      status = QpStatus::Solved;
      break;
    }
    if (!arrived) {
      minimise(problem);
    }
  }
  report(problem, out);
  if (!out.x.allFinite()) {
    forget();
    return QpStatus::Invalid;
  }
  return status;
}

}  // namespace ajar
