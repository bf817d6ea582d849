#pragma once

#include <vector>

#include "bench.hpp"

namespace ajar::bench {

/// The whole tick of a door being opened: kinematics, prediction, wrench, estimator, force and base law, clearances, QPs,
/// and the row of the log. Hot, one after the other; and paced by the clock at 500 Hz, as on a robot.
/// @throws Error
[[nodiscard]] std::vector<BenchRow> run_ticks();

}  // namespace ajar::bench
