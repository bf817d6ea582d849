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
// Most guesses need none to four repairs; one that does not settle within these rarely does later.
constexpr int kMaxRepairs = 8;
// Each iteration of the primal method adds or drops one limit. Random problems with 28 rows need at most some sixty, doors
// two or three.
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
  E_.topRows(problem.tasks) = problem.A.topRows(problem.tasks);
}

// E = A, already in place, and active rows of C; y = bounds of the held variables, wishes of the free ones; e = right side
// minus E y.
void TaskQp::gather(const QpProblem& problem) noexcept {
  for (int i = 0; i < kQpVariables; ++i) {
    const Side side = side_[static_cast<size_t>(i)];
    mobility_[i] = side == Side::Free ? 1.0 / problem.weight[i] : 0.0;
    target_[i] = side == Side::Free ? problem.wanted[i] : side == Side::Upper ? problem.upper[i] : problem.lower[i];
  }
  equations_ = problem.tasks + active_count_;
  for (int i = 0; i < problem.tasks; ++i) {
    e_[i] = problem.b[i] - E_.row(i).dot(target_);
  }
  for (int k = 0; k < active_count_; ++k) {
    const int row = active_[static_cast<size_t>(k)];
    E_.row(problem.tasks + k) = problem.C.row(row);
    e_[problem.tasks + k] = problem.c[row] - problem.C.row(row).dot(target_);
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

// L P Lᵀ = E D⁻¹ Eᵀ + W⁻¹ and, on the way, L⁻¹ e: no roots, whose time would add up. An active row that depends on those
// before it is no longer counted as active: its multiplier would be arbitrary.
void TaskQp::factorise(const QpProblem& problem) noexcept {
  std::array<double, kEquations> scaled;  // a row of L P
  for (int i = 0; i < equations_; ++i) {
    const QpVector moved = E_.row(i).transpose().cwiseProduct(mobility_);
    const double own = E_.row(i).dot(moved);
    double value = e_[i];
    double pivot = own + (i < problem.tasks ? 1.0 / problem.task_weight[i] : 0.0);
    for (int j = 0; j < i; ++j) {
      double sum = E_.row(j).dot(moved);
      for (int k = 0; k < j; ++k) {
        sum -= scaled[static_cast<size_t>(k)] * L_(j, k);
      }
      scaled[static_cast<size_t>(j)] = sum;
      L_(i, j) = sum * inverse_pivot_[j];
      pivot -= sum * L_(i, j);
      value -= L_(i, j) * half_[j];
    }
    if (i >= problem.tasks && pivot <= kDependent * own) {
      drop(problem, i - problem.tasks);
      --i;
      continue;
    }
    inverse_pivot_[i] = 1.0 / std::max(pivot, std::numeric_limits<double>::min());
    half_[i] = value;
  }
}

// Adds (L P Lᵀ)⁻¹ e to the multipliers and its effect to x; the half L⁻¹ e stands in `half`.
void TaskQp::back_substitute(EquationVector& half) noexcept {
  QpVector pull = QpVector::Zero();
  half.head(equations_) = half.head(equations_).cwiseProduct(inverse_pivot_.head(equations_));
  for (int i = equations_ - 1; i >= 0; --i) {
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
    half_[i] = rest;
  }
  back_substitute(half_);
}

// Multipliers less wrong than this are right up to round-off.
double TaskQp::sign_tolerance() const noexcept {
  const double largest = equations_ > 0 ? multiplier_.head(equations_).cwiseAbs().maxCoeff() : 0.0;
  return kAbsoluteSign + kRelativeSign * largest;
}

// Multiplier of a held variable: lower bound minus upper bound.
double TaskQp::force(const QpProblem& problem, int i) const noexcept {
  return problem.weight[i] * (target_[i] - problem.wanted[i]) - pull_[i];
}

// The limits that the minimum on the active ones breaks, and those that hold it back from where the cost falls.
TaskQp::Wrong TaskQp::find_wrong(const QpProblem& problem) const noexcept {
  Wrong wrong{.sides = side_, .tolerance = sign_tolerance()};
  double most = 0.0;
  for (int i = 0; i < kQpVariables; ++i) {
    Side& side = wrong.sides[static_cast<size_t>(i)];
    if (side == Side::Free) {
      const double below = problem.lower[i] - target_[i];
      const double miss = std::max(below, target_[i] - problem.upper[i]);
      const double share = miss / (problem.upper[i] - problem.lower[i]);
      if (!(miss > kRoundOff)) continue;
      side = below > 0.0 ? Side::Lower : Side::Upper;
      if (share > most) wrong.variable = i;
      most = std::max(most, share);
    } else if (side == Side::Fixed || (side == Side::Lower ? force(problem, i) : -force(problem, i)) >= -wrong.tolerance) {
      continue;
    } else {
      side = Side::Free;
    }
    ++wrong.count;
  }
  for (int k = 0; k < active_count_; ++k) {
    wrong.count += multiplier_[problem.tasks + k] < -wrong.tolerance ? 1 : 0;
  }
  most = kRoundOff;
  for (int i = 0; i < problem.rows; ++i) {
    const double miss = problem.c[i] - problem.C.row(i).dot(target_);
    if (miss > kRoundOff && !is_active(i)) {
      ++wrong.count;
      if (miss > most) wrong.row = i;
      most = std::max(most, miss);
    }
  }
  return wrong;
}

// Lets go of all that holds back; holds the variables that break a limit, all or the worst, and the worst of the rows.
void TaskQp::change_limits(const QpProblem& problem, const Wrong& wrong, bool all) noexcept {
  int kept = 0;
  for (int k = 0; k < active_count_; ++k) {
    if (multiplier_[problem.tasks + k] >= -wrong.tolerance) {
      active_[static_cast<size_t>(kept++)] = active_[static_cast<size_t>(k)];
    }
  }
  active_count_ = kept;
  if (wrong.row >= 0 && active_count_ < kQpVariables) {
    active_[static_cast<size_t>(active_count_++)] = wrong.row;
  }
  for (int i = 0; i < kQpVariables; ++i) {
    const Side side = wrong.sides[static_cast<size_t>(i)];
    if (all || side == Side::Free || i == wrong.variable) {
      side_[static_cast<size_t>(i)] = side;
    }
  }
}

// Changes the guess where the optimality conditions fail: in all places while fewer and fewer fail, then carefully. True:
// none fails, the minimum on the active limits is the answer.
bool TaskQp::repair(const QpProblem& problem, int& repairs) noexcept {
  int fewest = std::numeric_limits<int>::max();
  for (repairs = 0;; ++repairs) {
    minimise(problem);
    const Wrong wrong = find_wrong(problem);
    if (wrong.count == 0 || repairs == kMaxRepairs) {
      return wrong.count == 0;
    }
    change_limits(problem, wrong, wrong.count < fewest);
    fewest = std::min(fewest, wrong.count);
  }
}

// From the known point as far towards the guess as the rows allow; only what is met exactly stays active.
void TaskQp::retreat(const QpProblem& problem) noexcept {
  const QpVector way = target_.cwiseMax(problem.lower).cwiseMin(problem.upper) - problem.start;
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

// Moves to the minimum on the active limits, or to the first limit on the way, which becomes active. A limit that the
// minimum breaks by round-off only is none: held, it would push out the limit that stands there already. True: arrived.
bool TaskQp::advance(const QpProblem& problem) noexcept {
  const QpVector way = target_ - x_;
  double share = 1.0;
  int blocked = -1;  // variable, or kQpVariables + row
  for (int i = 0; i < kQpVariables; ++i) {
    const double bound = way[i] < 0.0 ? problem.lower[i] : problem.upper[i];
    const double room = std::max(way[i] < 0.0 ? x_[i] - bound : bound - x_[i], 0.0);
    const double length = mobility_[i] > 0.0 ? std::abs(way[i]) : 0.0;
    if (length > room + kRoundOff && room < share * length) {
      share = room / length;
      blocked = i;
    }
  }
  for (int i = 0; i < problem.rows; ++i) {
    const double change = problem.C.row(i).dot(way);
    const double room = std::max(problem.C.row(i).dot(x_) - problem.c[i], 0.0);
    if (-change > room + kRoundOff && room < -share * change && !is_active(i)) {
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
  double worst = sign_tolerance();
  int found = -1;
  for (int i = 0; i < kQpVariables; ++i) {
    const Side side = side_[static_cast<size_t>(i)];
    if (side == Side::Lower || side == Side::Upper) {
      const double wrong = side == Side::Lower ? -force(problem, i) : force(problem, i);
      if (wrong > worst) found = i;
      worst = std::max(worst, wrong);
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
      out.lower_multiplier[i] = std::max(force(problem, i), 0.0);
      out.upper_multiplier[i] = std::max(-force(problem, i), 0.0);
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
  const bool repaired = repair(problem, out.iterations);
  QpStatus status = repaired ? QpStatus::Solved : QpStatus::Stopped;
  bool arrived = false;
  if (repaired) {
    x_ = target_;
  } else {
    retreat(problem);
    minimise(problem);
  }
  for (++out.iterations; !repaired && out.iterations < kMaxIterations; ++out.iterations) {
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
