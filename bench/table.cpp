#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "bench.hpp"

namespace ajar::bench {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

nlohmann::ordered_json or_null(double value) {
  return std::isfinite(value) ? nlohmann::ordered_json(value) : nlohmann::ordered_json(nullptr);
}

std::string cell(double value, int digits) { return std::isfinite(value) ? fmt::format("{:.{}f}", value, digits) : "-"; }

void print_steps(const std::vector<BenchRow>& rows) {
  fmt::print("{:<14} {:<46} {:>10} {:>10} {:>10} {:>12}\n", "bench", "problem", "median us", "p99 us", "p99.9 us",
             "allocations");
  for (const auto& [bench, row] : rows) {
    fmt::print("{:<14} {:<46} {:>10.2f} {:>10.2f} {:>10.2f} {:>12}\n", bench, row.problem, row.median_us, row.p99_us,
               row.p999_us, cell(row.allocations, 2));
  }
}

// Medians are compared with KDL's on the same problem.
void print_contest(const std::vector<BenchRow>& rows) {
  std::map<std::string, ContestRow> kdl;
  for (const auto& [bench, row] : rows) {
    if (row.contestant == "kdl_wdls") kdl[row.problem] = row;
  }
  fmt::print("{:<15} {:<11} {:>9} {:>7} {:>9} {:>9} {:>7} {:>8} {:>9} {:>9} {:>11} {:>8} {:>7}\n", "wbc", "contestant",
             "median us", "/ KDL", "p99 us", "work99.9", "/ KDL", "cold us", "path mm", "turn mrad", "over limit", "limited",
             "allocs");
  for (const auto& [bench, row] : rows) {
    const ContestRow& base = kdl[row.problem];
    fmt::print(
        "{:<15} {:<11} {:>9.2f} {:>7.2f} {:>9.2f} {:>9} {:>7} {:>8.1f} {:>9.4f} {:>9.4f} {:>11.1e} {:>7.0f}% {:>7.1f}\n",
        row.problem, row.contestant, row.median_us, row.median_us / base.median_us, row.p99_us, cell(row.work_p999_us, 2),
        cell(row.work_p999_us / base.work_p999_us, 2), row.cold_us, 1e3 * row.path_error_m, 1e3 * row.rotation_error_rad,
        row.limit_excess, 100.0 * row.limited_share, row.allocations);
  }
}

}  // namespace

void RowCollector::ReportRuns(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    const auto& c = run.counters;
    if (c.find("median_us") == c.end()) continue;  // broken off
    rows_.push_back({run.run_name.function_name,
                     {.contestant = "ajar",
                      .problem = run.report_label,
                      .median_us = c.at("median_us"),
                      .p99_us = c.at("p99_us"),
                      .p999_us = c.at("p999_us"),
                      .work_p999_us = kNone,
                      .cold_us = kNone,
                      .path_error_m = kNone,
                      .rotation_error_rad = kNone,
                      .limit_excess = kNone,
                      .limited_share = kNone,
                      .allocations = c.at("allocations")}});
  }
}

void print_table(const std::vector<BenchRow>& rows) {
  std::vector<BenchRow> steps;
  std::vector<BenchRow> contest;
  for (const BenchRow& row : rows) (row.bench == "wbc" ? contest : steps).push_back(row);
  if (!steps.empty()) print_steps(steps);
  if (!steps.empty() && !contest.empty()) fmt::print("\n");
  if (!contest.empty()) print_contest(contest);
}

void print_json(const std::vector<BenchRow>& rows) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const auto& [bench, row] : rows) {
    list.push_back({{"bench", bench},
                    {"contestant", row.contestant},
                    {"problem", row.problem},
                    {"median_us", or_null(row.median_us)},
                    {"p99_us", or_null(row.p99_us)},
                    {"p999_us", or_null(row.p999_us)},
                    {"work_p999_us", or_null(row.work_p999_us)},
                    {"cold_us", or_null(row.cold_us)},
                    {"path_error_m", or_null(row.path_error_m)},
                    {"rotation_error_rad", or_null(row.rotation_error_rad)},
                    {"limit_excess", or_null(row.limit_excess)},
                    {"limited_share", or_null(row.limited_share)},
                    {"allocations", or_null(row.allocations)}});
  }
  fmt::print("{}\n", list.dump(2));
}

}  // namespace ajar::bench
