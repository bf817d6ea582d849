#include "ajar/wbc/dense_qp.hpp"

#include <algorithm>
#include <cmath>
#include <eiquadprog/eiquadprog-rt.hpp>

namespace ajar {
namespace {

constexpr int kInequalities = 2 * kQpVariables + kQpRows;
// Farther bounds are treated as absent: speeds in SI units stay far below.
constexpr double kNoBound = 1e6;
// Bounds closer than this fix the variable: two opposed active rows would be linearly dependent.
constexpr double kFixedGap = 1e-9;
// Rows with smaller coefficients cannot be influenced.
constexpr double kEmptyRow = 1e-12;
// The largest violation that the method's own stopping rule may leave; the caller clips it away.
constexpr double kTolerance = 1e-6;
// Each step adds or drops one of the limits; twice their number is never reached in practice.
constexpr int kMaxSteps = 2 * kInequalities;

}  // namespace

struct DenseQp::Impl {
  using Solver = eiquadprog::solvers::RtEiquadprog<kQpVariables, 0, kInequalities>;

  Solver solver;
  QpProblem reduced;
  Eigen::Matrix<double, 0, kQpVariables> no_rows;
  Eigen::Matrix<double, 0, 1> no_values;
  Eigen::Matrix<double, kInequalities, kQpVariables> G = Eigen::Matrix<double, kInequalities, kQpVariables>::Zero();
  Eigen::Matrix<double, kInequalities, 1> h = Eigen::Matrix<double, kInequalities, 1>::Ones();
  Eigen::Array<bool, kQpVariables, 1> fixed;
  QpVector value;

  void fix_variables();
  void place_bounds();
  void place_rows();
  void read_multipliers(const QpProblem& problem, QpSolution& out) const;
  [[nodiscard]] bool is_feasible(const QpProblem& problem, const QpVector& x) const;
};

// Moves variables without room into the constants.
void DenseQp::Impl::fix_variables() {
  value.setZero();
  for (int i = 0; i < kQpVariables; ++i) {
    fixed[i] = reduced.upper[i] - reduced.lower[i] < kFixedGap;
    if (!fixed[i]) {
      continue;
    }
    value[i] = 0.5 * (reduced.upper[i] + reduced.lower[i]);
    reduced.g += value[i] * reduced.H.col(i);
    reduced.c.head(reduced.rows) -= value[i] * reduced.C.col(i).head(reduced.rows);
    reduced.C.col(i).setZero();
    reduced.H.col(i).setZero();
    reduced.H.row(i).setZero();
    reduced.H(i, i) = 1.0;
    reduced.g[i] = 0.0;
  }
  reduced.g = fixed.select(0.0, reduced.g.array()).matrix();
}

void DenseQp::Impl::place_bounds() {
  for (int i = 0; i < kQpVariables; ++i) {
    const bool has_lower = !fixed[i] && reduced.lower[i] > -kNoBound;
    const bool has_upper = !fixed[i] && reduced.upper[i] < kNoBound;
    G(i, i) = has_lower ? 1.0 : 0.0;
    h[i] = has_lower ? -reduced.lower[i] : 1.0;
    G(kQpVariables + i, i) = has_upper ? -1.0 : 0.0;
    h[kQpVariables + i] = has_upper ? reduced.upper[i] : 1.0;
  }
}

void DenseQp::Impl::place_rows() {
  for (int i = 0; i < kQpRows; ++i) {
    const int row = 2 * kQpVariables + i;
    const bool used = i < reduced.rows && reduced.C.row(i).cwiseAbs().maxCoeff() > kEmptyRow;
    if (used) {
      G.row(row) = reduced.C.row(i);
      h[row] = -reduced.c[i];
    } else {
      G.row(row).setZero();
      h[row] = 1.0;
    }
  }
}

void DenseQp::Impl::read_multipliers(const QpProblem& problem, QpSolution& out) const {
  out.lower_multiplier.setZero();
  out.upper_multiplier.setZero();
  out.row_multiplier.setZero();
  for (int k = 0; k < solver.getActiveSetSize(); ++k) {
    const int index = solver.getActiveSet()[k];
    const double multiplier = solver.getLagrangeMultipliers()[k];
    if (index < kQpVariables) {
      out.lower_multiplier[index] = multiplier;
    } else if (index < 2 * kQpVariables) {
      out.upper_multiplier[index - kQpVariables] = multiplier;
    } else {
      out.row_multiplier[index - 2 * kQpVariables] = multiplier;
    }
  }
  if (!fixed.any()) {
    return;
  }
  const QpVector pull = problem.H * out.x + problem.g - problem.C.transpose() * out.row_multiplier;
  for (int i = 0; i < kQpVariables; ++i) {
    if (fixed[i]) {
      out.lower_multiplier[i] = std::max(pull[i], 0.0);
      out.upper_multiplier[i] = std::max(-pull[i], 0.0);
    }
  }
}

bool DenseQp::Impl::is_feasible(const QpProblem& problem, const QpVector& x) const {
  if (!x.allFinite() || (problem.lower - x).maxCoeff() > kTolerance || (x - problem.upper).maxCoeff() > kTolerance) {
    return false;
  }
  return (G * (fixed.select(0.0, x.array()).matrix()) + h).minCoeff() > -kTolerance;
}

DenseQp::DenseQp() : impl_(std::make_unique<Impl>()) { impl_->solver.setMaxIter(kMaxSteps); }
DenseQp::~DenseQp() = default;

QpStatus DenseQp::solve(const QpProblem& problem, QpSolution& out) noexcept {
  Impl& impl = *impl_;
  out = QpSolution{};
  impl.reduced = problem;
  if (problem.rows < 0 || problem.rows > kQpRows || !problem.H.allFinite() || !problem.g.allFinite() ||
      !problem.C.topRows(problem.rows).allFinite() || !problem.c.head(problem.rows).allFinite() ||
      !((problem.upper - problem.lower).minCoeff() >= 0.0)) {
    return QpStatus::Failed;
  }
  impl.fix_variables();
  impl.place_bounds();
  impl.place_rows();
  const auto status =
      impl.solver.solve_quadprog(impl.reduced.H, impl.reduced.g, impl.no_rows, impl.no_values, impl.G, impl.h, out.x);
  if (status != eiquadprog::solvers::RT_EIQUADPROG_OPTIMAL) {
    return QpStatus::Failed;
  }
  out.iterations = impl.solver.getIteratios();
  out.x = impl.fixed.select(impl.value.array(), out.x.array()).matrix();
  if (!impl.is_feasible(problem, out.x)) {
    return QpStatus::Failed;
  }
  impl.read_multipliers(problem, out);
  return QpStatus::Solved;
}

}  // namespace ajar
