// ajar_bench [NAME] [--json] [--peers PYTHON]: medians and tails of the inner steps, heap requests per step. Every step is
// timed by itself; the clock's own 0.03 us are included. The bench "wbc" lets others solve the same whole-body problem in
// turns; PYTHON is an interpreter that has them installed.
#include <algorithm>
#include <chrono>
#include <exception>
#include <string>

#include <fmt/format.h>

#include "bench.hpp"
#include "contest.hpp"
#include "heap_count.hpp"
#include "tick.hpp"

namespace {

using ajar::bench::CaseInfo;
using Clock = std::chrono::steady_clock;

double quantile(const std::vector<double>& sorted, double share) {
  return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(share * static_cast<double>(sorted.size())))];
}

void run_case(benchmark::State& state, const CaseInfo& info) {
  const auto subject = info.make();
  for (int i = 0; i < info.steps / 10; ++i) {  // warm caches
    subject->prepare();
    subject->step();
  }
  std::vector<double> times;
  times.reserve(static_cast<std::size_t>(state.max_iterations));
  long allocations = 0;
  for (auto unused : state) {
    static_cast<void>(unused);
    subject->prepare();
    const long before = ajar_heap_count();
    const auto start = Clock::now();
    subject->step();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    allocations += ajar_heap_count() - before;
    state.SetIterationTime(seconds);
    times.push_back(1e6 * seconds);
  }
  std::sort(times.begin(), times.end());
  state.SetLabel(info.problem);
  state.counters["median_us"] = quantile(times, 0.5);
  state.counters["p99_us"] = quantile(times, 0.99);
  state.counters["p999_us"] = quantile(times, 0.999);
  state.counters["allocations"] = static_cast<double>(allocations) / static_cast<double>(times.size());
}

struct Options {
  bool json = false;
  std::string bench;
  std::string peers;
};

Options read_options(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--json") {
      options.json = true;
    } else if (word == "--peers" && i + 1 < argc) {
      options.peers = argv[++i];
    } else {
      options.bench = word;
    }
  }
  return options;
}

// Registers the cases that are wanted. False when there is no such bench.
bool select(const Options& options, const std::vector<CaseInfo>& cases) {
  std::string names = " wbc tick";
  bool any = options.bench.empty() || options.bench == "wbc" || options.bench == "tick";
  for (const CaseInfo& info : cases) {
    names += " " + info.name;
    if (!options.bench.empty() && info.name != options.bench) continue;
    any = true;
    benchmark::RegisterBenchmark(info.name.c_str(), [info](benchmark::State& state) { run_case(state, info); })
        ->Iterations(info.steps)
        ->UseManualTime();
  }
  if (!any) fmt::print(stderr, "ajar_bench: no benchmark '{}'; allowed:{}\n", options.bench, names);
  return any;
}

}  // namespace

int main(int argc, char** argv) {
  const Options options = read_options(argc, argv);
  const std::vector<CaseInfo> cases = ajar::bench::all_cases();
  if (!select(options, cases)) return 2;
  std::vector<ajar::bench::BenchRow> rows;
  if (options.bench != "wbc" && options.bench != "tick") {
    int count = 1;
    benchmark::Initialize(&count, argv);
    ajar::bench::RowCollector collector(rows);
    benchmark::RunSpecifiedBenchmarks(&collector);
  }
  try {
    if (options.bench.empty() || options.bench == "tick") {
      for (const auto& row : ajar::bench::run_ticks()) rows.push_back(row);
    }
    if (options.bench.empty() || options.bench == "wbc") {
      for (const auto& row : ajar::bench::run_contest(options.peers)) rows.push_back({"wbc", row});
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "ajar_bench: {}\n", error.what());
    return 3;
  }
  options.json ? ajar::bench::print_json(rows) : ajar::bench::print_table(rows);
  return 0;
}
