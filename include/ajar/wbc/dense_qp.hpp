#pragma once

#include <memory>

#include "ajar/core/types.hpp"
#include "ajar/model/clearance.hpp"

namespace ajar {

/// Inputs, tangential speed factor and slack.
inline constexpr int kQpVariables = kMaxInputs + 2;
/// Clearance rows and the two-sided limits of two wheels.
inline constexpr int kQpRows = kMaxClearanceRows + 4;

using QpVector = Eigen::Matrix<double, kQpVariables, 1>;
using QpRowVector = Eigen::Matrix<double, kQpRows, 1>;

/// min ½ xᵀHx + gᵀx  subject to  lower ≤ x ≤ upper,  C x ≥ c (first `rows` rows).
struct QpProblem {
  Eigen::Matrix<double, kQpVariables, kQpVariables> H =
      Eigen::Matrix<double, kQpVariables, kQpVariables>::Identity();  ///< Positive definite
  QpVector g = QpVector::Zero();
  QpVector lower = QpVector::Zero();  ///< A bound beyond ±1e6 is none; lower = upper fixes the variable
  QpVector upper = QpVector::Zero();
  Eigen::Matrix<double, kQpRows, kQpVariables> C = Eigen::Matrix<double, kQpRows, kQpVariables>::Zero();
  QpRowVector c = QpRowVector::Zero();
  int rows = 0;
};

/// The minimum and its multipliers (all ≥ 0): Hx + g = lower_multiplier - upper_multiplier + Cᵀ row_multiplier.
struct QpSolution {
  QpVector x = QpVector::Zero();
  QpVector lower_multiplier = QpVector::Zero();
  QpVector upper_multiplier = QpVector::Zero();
  QpRowVector row_multiplier = QpRowVector::Zero();
  int iterations = 0;
};

enum class QpStatus {
  Solved,
  Failed  ///< No minimum found: x must not be used
};

/// Strictly convex QP of fixed size by a dual active-set method (Goldfarb and Idnani).
///
/// The method starts at the unconstrained minimum in every call, so there is nothing to warm-start: its cost follows
/// the number of active limits, not the distance to the last answer. (docs/equations.md#qp)
class DenseQp {
 public:
  DenseQp();
  ~DenseQp();
  DenseQp(const DenseQp&) = delete;
  DenseQp& operator=(const DenseQp&) = delete;

  /// No allocation, no exception, bounded time.
  [[nodiscard]] QpStatus solve(const QpProblem& problem, QpSolution& out) noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ajar
