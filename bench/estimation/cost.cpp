// Time, heap requests and size of the whole estimator, both filters, one tick of 2 ms after the other. The same ticks are
// passed several times and each counts with its least time, so that what else the machine does stays out.
#include <chrono>

#include "../heap_count.hpp"
#include "ajar/estimation/mechanism_estimator.hpp"
#include "ajar/estimation/path_filter.hpp"
#include "cells.hpp"

namespace ajar::bench {
namespace {

constexpr double kTickPath = 0.0002;  // 0.1 m/s at 500 Hz [m]
constexpr int kTracks = 12;
constexpr int kPasses = 5;

}  // namespace

void judge_cost(Table& table) {
  using Clock = std::chrono::steady_clock;
  std::vector<double> micros;
  long requests = 0;
  for (int pass = 0; pass < kPasses; ++pass) {
    Random rng(3);
    std::size_t tick = 0;
    for (int run = 0; run < kTracks; ++run) {
      const test::TruePath path = test::random_path(run % 3 == 2 ? 0.0 : 0.6, rng);
      EstimatorConfig config;
      test::Measured measured(path, config.noise, rng);
      MechanismEstimator estimator(config);
      estimator.reset(path.start(), path.F.col(0));
      for (double s = 0.0; s < 0.7; s += kTickPath) {
        const PathSample sample = measured.at(s, run % 4 == 3 ? 0.0 : 1.0);
        EstimatorInput input;
        input.hand.translation() = sample.position;
        input.hand.linear() = sample.rotation;
        input.velocity = 0.1 * path.direction(s);
        input.base_travel = kTickPath;
        const long before = ajar_heap_count();
        const auto begin = Clock::now();
        (void)estimator.update(input);
        const double time = std::chrono::duration<double, std::micro>(Clock::now() - begin).count();
        requests += ajar_heap_count() - before;
        if (pass == 0) {
          micros.push_back(time);
        } else {
          micros[tick] = std::min(micros[tick], time);
        }
        ++tick;
      }
    }
  }
  const double median = quantile(micros, 0.5);
  const double tail = quantile(micros, 0.999);
  const double size = 2.0 * sizeof(PathFilter) / 1000.0;
  table.push_back({"one tick, both filters: median", "ajar", median, "us", "<= 2.5", median <= 2.5});
  table.push_back({"one tick, both filters: p99.9", "ajar", tail, "us", "<= 10", tail <= 10.0});
  table.push_back({"heap requests of all ticks", "ajar", static_cast<double>(requests), "-", "0", requests == 0});
  table.push_back({"size of both filters", "ajar", size, "kB", "<= 16", size <= 16.0});
}

}  // namespace ajar::bench
