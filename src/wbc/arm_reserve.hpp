#pragma once

#include "ajar/wbc/input_limits.hpp"
#include "ajar/wbc/task_qp.hpp"

namespace ajar {

/// Slows the base down in time for the arm to keep the hand on its path until the base stands. (docs/equations.md#reserve)
class ArmReserve {
 public:
  ArmReserve(const InputLimits& limits, const WbcConfig& config);

  /// Forgets the last tick's active limits.
  void forget() noexcept { solver_.forget(); }
  /// Lowers the bounds of a base whose braking would take a joint beyond its limit. No allocation, no exception, bounded
  /// time.
  /// @param tick  With the hand's rows of this tick, variables as in WholeBodyController
  /// @param q     Measured positions, shape (n)
  /// @param last  Last command, shape (n + 2)
  void bound_base(const QpProblem& tick, const JointVector& q, const InputVector& last, InputBounds& bounds) noexcept;

 private:
  [[nodiscard]] double share(const QpProblem& tick, const JointVector& q, const InputVector& last) noexcept;

  InputLimits limits_;
  QpProblem hold_;
  QpSolution held_;
  TaskQp solver_;
};

}  // namespace ajar
