#pragma once

#include <array>

#include "ajar/core/types.hpp"
#include "ajar/model/clearance.hpp"

namespace ajar {

/// Inputs, tangential speed factor and slack.
inline constexpr int kQpVariables = kMaxInputs + 2;
/// Rows of the hand twist and one about a free axis.
inline constexpr int kQpTasks = 7;
/// Clearance rows and the two-sided limits of two wheels.
inline constexpr int kQpRows = kMaxClearanceRows + 4;

using QpVector = Eigen::Matrix<double, kQpVariables, 1>;
using QpTaskVector = Eigen::Matrix<double, kQpTasks, 1>;
using QpRowVector = Eigen::Matrix<double, kQpRows, 1>;

/// min Σ ½ d_i (x_i - r_i)² + Σ ½ w_j (a_j·x - b_j)²  subject to  lower ≤ x ≤ upper,  C x ≥ c.
/// The first `tasks` rows of A and the first `rows` rows of C count.
struct QpProblem {
  QpVector weight = QpVector::Ones();               ///< d > 0
  QpVector wanted = QpVector::Zero();               ///< r
  QpTaskVector task_weight = QpTaskVector::Ones();  ///< w > 0
  Eigen::Matrix<double, kQpTasks, kQpVariables, Eigen::RowMajor> A =
      Eigen::Matrix<double, kQpTasks, kQpVariables, Eigen::RowMajor>::Zero();
  QpTaskVector b = QpTaskVector::Zero();
  int tasks = 0;
  QpVector lower = QpVector::Zero();  ///< lower = upper fixes the variable
  QpVector upper = QpVector::Zero();
  Eigen::Matrix<double, kQpRows, kQpVariables, Eigen::RowMajor> C =
      Eigen::Matrix<double, kQpRows, kQpVariables, Eigen::RowMajor>::Zero();
  QpRowVector c = QpRowVector::Zero();
  int rows = 0;
  QpVector start = QpVector::Zero();  ///< Some point that meets all limits
};

/// The minimum and its multipliers (all ≥ 0):
/// d (x - r) + Aᵀ w (A x - b) = lower_multiplier - upper_multiplier + Cᵀ row_multiplier.
struct QpSolution {
  QpVector x = QpVector::Zero();
  QpVector lower_multiplier = QpVector::Zero();
  QpVector upper_multiplier = QpVector::Zero();
  QpRowVector row_multiplier = QpRowVector::Zero();
  int iterations = 0;
};

enum class QpStatus {
  Solved,
  Stopped,  ///< Not the minimum, but x meets all limits
  Invalid   ///< A number is not finite, or the start breaks a limit: x must not be used
};

/// Strictly convex QP with a diagonal cost and a few task rows, by active-set methods in the space of the rows.
///
/// Begins with the limits that were active in the last call: while they stay the same, one factorisation of six or seven
/// rows is the whole work. Otherwise the guess is repaired; where that does not end soon, a primal method takes over, whose
/// every iterate meets the limits. (docs/equations.md#qp)
class TaskQp {
 public:
  /// Forgets the limits that were active in the last call; the next result no longer depends on them to round-off.
  void forget() noexcept;
  /// No allocation, no exception, bounded time.
  [[nodiscard]] QpStatus solve(const QpProblem& problem, QpSolution& out) noexcept;

 private:
  static constexpr int kEquations = kQpTasks + kQpVariables;
  enum class Side : signed char { Free, Lower, Upper, Fixed };
  using EquationVector = Eigen::Matrix<double, kEquations, 1>;
  // Where the minimum on the active limits fails the optimality conditions.
  struct Wrong {
    std::array<Side, kQpVariables> sides;  // where the variables should be
    double tolerance = 0.0;                // of multipliers
    int count = 0;
    int variable = -1;  // that breaks its limit by most of its range
    int row = -1;       // of C, broken most
  };

  void guess(const QpProblem& problem) noexcept;
  [[nodiscard]] bool repair(const QpProblem& problem, int& repairs) noexcept;
  [[nodiscard]] Wrong find_wrong(const QpProblem& problem) const noexcept;
  void change_limits(const QpProblem& problem, const Wrong& wrong, bool all) noexcept;
  void minimise(const QpProblem& problem) noexcept;
  void gather(const QpProblem& problem) noexcept;
  void drop(const QpProblem& problem, int place) noexcept;
  void factorise(const QpProblem& problem) noexcept;
  void back_substitute(EquationVector& half) noexcept;
  void retreat(const QpProblem& problem) noexcept;
  [[nodiscard]] bool advance(const QpProblem& problem) noexcept;
  [[nodiscard]] bool release(const QpProblem& problem) noexcept;
  [[nodiscard]] bool is_active(int row) const noexcept;
  [[nodiscard]] double sign_tolerance() const noexcept;
  [[nodiscard]] double force(const QpProblem& problem, int i) const noexcept;
  [[nodiscard]] bool is_feasible(const QpProblem& problem, const QpVector& x) const noexcept;
  void report(const QpProblem& problem, QpSolution& out) const noexcept;

  std::array<Side, kQpVariables> side_{};
  std::array<int, kQpVariables> active_{};  // rows of C that hold with equality
  int active_count_ = 0;
  int equations_ = 0;
  QpVector x_ = QpVector::Zero();
  QpVector target_ = QpVector::Zero();    // minimum on the active limits
  QpVector mobility_ = QpVector::Zero();  // 1/d of the free variables, 0 of the others
  QpVector pull_ = QpVector::Zero();      // Eᵀ λ
  EquationVector multiplier_ = EquationVector::Zero();
  EquationVector half_ = EquationVector::Zero();  // L⁻¹ e
  Eigen::Matrix<double, kEquations, kQpVariables, Eigen::RowMajor> E_ =
      Eigen::Matrix<double, kEquations, kQpVariables, Eigen::RowMajor>::Zero();
  EquationVector e_ = EquationVector::Zero();
  EquationVector inverse_pivot_ = EquationVector::Zero();  // P⁻¹
  Eigen::Matrix<double, kEquations, kEquations, Eigen::RowMajor> L_ =
      Eigen::Matrix<double, kEquations, kEquations, Eigen::RowMajor>::Zero();
};

}  // namespace ajar
