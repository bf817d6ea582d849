#pragma once

#include <memory>
#include <string>
#include <vector>

#include "path_problem.hpp"

namespace ajar::bench {

/// One tick of a path problem.
struct PathTick {
  int step = 0;
  BasePose base;
  JointVector q;
  Pose target = Pose::Identity();  ///< Hand wanted at the end of this tick, world
  InputVector wishes;              ///< Secondary, shape (8)
};

/// Somebody's whole-body step: kinematics, building and solving. Only step() is timed.
class Contestant {
 public:
  virtual ~Contestant() = default;
  /// The path begins anew. Not timed.
  virtual void restart(const PathTick& /*first*/) {}
  /// @param[out] u  (q̇, ω, v), shape (8)
  virtual void step(const PathTick& tick, InputVector& u) = 0;
};

[[nodiscard]] std::unique_ptr<Contestant> make_kdl(const PathProblem& problem);
[[nodiscard]] std::unique_ptr<Contestant> make_ajar(const PathProblem& problem);

/// What is printed of one contestant on one problem. Values that do not exist are NaN.
struct ContestRow {
  std::string contestant;
  std::string problem;
  double median_us = 0.0;
  double p99_us = 0.0;
  double p999_us = 0.0;
  double work_p999_us = 0.0;  ///< Over the steps of a door, of each step's median over the doors
  double cold_us = 0.0;       ///< Median of the first step after another contestant had the core
  double path_error_m = 0.0;
  double rotation_error_rad = 0.0;
  double limit_excess = 0.0;   ///< [rad/s or m/s]
  double limited_share = 0.0;  ///< Steps with a velocity limit reached [-]
  double allocations = 0.0;    ///< Heap requests per step
};

/// Lets everyone solve both problems in turns on one core.
/// @param python  Interpreter that has the peers installed; empty = only the contestants in C++
/// @throws Error
[[nodiscard]] std::vector<ContestRow> run_contest(const std::string& python);

}  // namespace ajar::bench
