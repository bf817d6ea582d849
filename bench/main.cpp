// ajar_bench [NAME] [--json]: medians and tails of the inner steps, heap requests per step. Every step is timed by itself;
// the clock's own 0.03 us are included.
#include <algorithm>
#include <chrono>
#include <cstring>
#include <string>

#include <fmt/format.h>

#include "allocation_guard.hpp"
#include "bench.hpp"

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
    const long before = ajar::test::allocations;
    const auto start = Clock::now();
    subject->step();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    allocations += ajar::test::allocations - before;
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

}  // namespace

int main(int argc, char** argv) {
  bool json = false;
  std::string wanted;
  for (int i = 1; i < argc; ++i) {
    if (std::strcmp(argv[i], "--json") == 0) {
      json = true;
    } else {
      wanted = argv[i];
    }
  }
  const std::vector<CaseInfo> cases = ajar::bench::all_cases();
  std::string names;
  bool any = false;
  for (const CaseInfo& info : cases) {
    names += " " + info.name;
    if (!wanted.empty() && info.name != wanted) continue;
    any = true;
    benchmark::RegisterBenchmark(info.name.c_str(), [info](benchmark::State& state) { run_case(state, info); })
        ->Iterations(info.steps)
        ->UseManualTime();
  }
  if (!any) {
    fmt::print(stderr, "ajar_bench: no benchmark '{}'; allowed:{}\n", wanted, names);
    return 2;
  }
  int count = 1;
  benchmark::Initialize(&count, argv);
  ajar::bench::TableReporter reporter(json);
  benchmark::RunSpecifiedBenchmarks(&reporter);
  return 0;
}
