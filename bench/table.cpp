#include <cstdio>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench.hpp"

namespace ajar::bench {

void TableReporter::ReportRuns(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    const auto& c = run.counters;
    if (c.find("median_us") == c.end()) continue;  // broken off
    rows_.push_back({run.run_name.function_name, run.report_label, c.at("median_us"), c.at("p99_us"), c.at("p999_us"),
                     c.at("allocations")});
  }
}

void TableReporter::Finalize() {
  if (json_) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Row& row : rows_) {
      list.push_back({{"bench", row.name},
                      {"contestant", "ajar"},
                      {"problem", row.problem},
                      {"median_us", row.median},
                      {"p99_us", row.p99},
                      {"p999_us", row.p999},
                      {"path_error_m", nullptr},
                      {"limit_excess", nullptr},
                      {"allocations", row.allocations}});
    }
    fmt::print("{}\n", list.dump(2));
    return;
  }
  fmt::print("{:<14} {:<11} {:<46} {:>12} {:>12} {:>12} {:>12}\n", "bench", "contestant", "problem", "median us", "p99 us",
             "p99.9 us", "allocations");
  for (const Row& row : rows_) {
    fmt::print("{:<14} {:<11} {:<46} {:>12.2f} {:>12.2f} {:>12.2f} {:>12.2f}\n", row.name, "ajar", row.problem, row.median,
               row.p99, row.p999, row.allocations);
  }
}

}  // namespace ajar::bench
