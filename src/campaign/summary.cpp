#include "ajar/campaign/summary.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "ajar/log/csv_table.hpp"
#include "statistics.hpp"

namespace ajar {
namespace {

using Json = nlohmann::ordered_json;

/// A figure worth its distribution; `scale` and `unit` are for the table only.
struct Metric {
  const char* column;
  const char* title;
  double scale;
  const char* unit;
};
constexpr double kDegrees = 180.0 / 3.14159265358979323846;
/// Pulling within this of the true direction spends 87 % of its force on the motion.
constexpr double kFoundWithin = 30.0 / kDegrees;
constexpr double kGentleExcess = 15.0;  // [N]
constexpr double kQuickProbing = 5.0;   // [s]
constexpr std::array kMetrics{
    Metric{"peak_normal_force_free_N", "peak normal force before the stop", 1.0, "N"},
    Metric{"peak_normal_force_N", "peak normal force, stop included", 1.0, "N"},
    Metric{"late_normal_force_N", "normal force after 15 cm, mean", 1.0, "N"},
    Metric{"late_normal_force_peak_N", "normal force after 15 cm, peak", 1.0, "N"},
    Metric{"peak_pull_force_N", "peak pull force before the stop", 1.0, "N"},
    Metric{"stop_force_N", "force at the end stop", 1.0, "N"},
    Metric{"peak_torque_Nm", "peak torque", 1.0, "N m"},
    Metric{"peak_probe_force_N", "peak force of the probing", 1.0, "N"},
    Metric{"probe_force_over_need_N", "the same less the force needed", 1.0, "N"},
    Metric{"probe_direction_error_rad", "direction error after probing", kDegrees, "deg"},
    Metric{"direction_error_10cm_rad", "direction error at 10 cm", kDegrees, "deg"},
    Metric{"direction_error_20cm_rad", "direction error at 20 cm", kDegrees, "deg"},
    Metric{"direction_error_final_rad", "direction error at the end", kDegrees, "deg"},
    Metric{"curvature_error_20cm_per_m", "curvature error at 20 cm", 1.0, "1/m"},
    Metric{"curvature_error_40cm_per_m", "curvature error at 40 cm", 1.0, "1/m"},
    Metric{"path_error_max_m", "slip of the hand on the handle", 1e3, "mm"},
    Metric{"open_duration_s", "time of opening", 1.0, "s"},
    Metric{"probe_duration_s", "time of probing", 1.0, "s"},
    Metric{"duration_s", "time of the mission", 1.0, "s"},
    Metric{"real_time_factor", "real time factor", 1.0, "x"},
};

/// Columns that the summary reads beside the metrics.
struct Rows {
  CsvTable table;
  const std::vector<double>& number(const std::string& name) {
    auto& column = table.numbers[name];
    column.resize(table.rows, std::nan(""));
    return column;
  }
  const std::vector<std::string>& text(const std::string& name) {
    auto& column = table.texts[name];
    column.resize(table.rows);
    return column;
  }
};

Rows read_rows(const std::filesystem::path& file) {
  CsvColumns wanted;
  for (const Metric& metric : kMetrics) wanted.numbers.emplace_back(metric.column);
  for (const char* name :
       {"exit_code", "unwanted_contact_count", "limit_violations", "nonfinite_commands", "belief.direction_error_deg"}) {
    wanted.numbers.emplace_back(name);
  }
  wanted.texts = {"outcome", "reason", "mechanism_type_true"};
  return {read_csv(file, wanted)};
}

GroupSummary summarize_group(const std::string& name, Rows& rows, const std::function<bool(std::size_t)>& member) {
  GroupSummary group;
  group.name = name;
  const auto& outcome = rows.text("outcome");
  const auto& contacts = rows.number("unwanted_contact_count");
  const auto& exit_code = rows.number("exit_code");
  for (std::size_t i = 0; i < rows.table.rows; ++i) {
    if (!member(i)) continue;
    ++group.runs;
    const bool opened = outcome[i] == "opened";
    if (opened) ++group.opened;
    if (opened && contacts[i] == 0.0) ++group.opened_clean;
    if (contacts[i] > 0.0) ++group.contact_runs;
    if (exit_code[i] >= 2.0) ++group.errors;
  }
  for (const Metric& metric : kMetrics) {
    std::vector<double> values;
    const auto& column = rows.number(metric.column);
    for (std::size_t i = 0; i < rows.table.rows; ++i) {
      if (member(i) && std::isfinite(column[i])) values.push_back(column[i]);
    }
    MetricSummary& summary = group.metrics[metric.column];
    summary.count = static_cast<int>(values.size());
    summary.p50 = quantile(values, 0.5);
    summary.p90 = quantile(values, 0.9);
    summary.max = quantile(values, 1.0);
  }
  return group;
}

ProbingSummary summarize_probing(Rows& rows) {
  ProbingSummary probing;
  const auto& duration = rows.number("probe_duration_s");
  const auto& error = rows.number("probe_direction_error_rad");
  const auto& excess = rows.number("probe_force_over_need_N");
  for (std::size_t i = 0; i < rows.table.rows; ++i) {
    if (!std::isfinite(duration[i])) continue;
    ++probing.runs;
    probing.found += error[i] <= kFoundWithin ? 1 : 0;
    probing.gentle += excess[i] <= kGentleExcess ? 1 : 0;
    probing.quick += duration[i] <= kQuickProbing ? 1 : 0;
  }
  return probing;
}

Json json_of(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json share(int part, int whole) { return whole > 0 ? Json(static_cast<double>(part) / whole) : Json(nullptr); }

std::string cell(const std::optional<double>& value, double scale) {
  return value ? fmt::format("{:.3g}", *value * scale) : "-";
}

}  // namespace

CampaignSummary summarize(const std::filesystem::path& runs_csv) {
  Rows rows = read_rows(runs_csv);
  CampaignSummary summary;
  const std::vector<double> error = rows.number("belief.direction_error_deg");
  const std::vector<std::string> kind = rows.text("mechanism_type_true");
  const auto add = [&](const char* name, const std::function<bool(std::size_t)>& member) {
    GroupSummary group = summarize_group(name, rows, member);
    if (group.runs > 0 || summary.groups.empty()) summary.groups.push_back(std::move(group));
  };
  add("all", [](std::size_t) { return true; });
  add("direction_error_below_30_deg", [&](std::size_t i) { return error[i] < 30.0; });
  add("direction_error_30_deg_and_more", [&](std::size_t i) { return error[i] >= 30.0; });
  add("hinge", [&](std::size_t i) { return kind[i] == "hinge"; });
  add("slide", [&](std::size_t i) { return kind[i] == "slide"; });
  for (const std::string& reason : rows.text("reason")) ++summary.reasons[reason.empty() ? "none" : reason];
  summary.probing = summarize_probing(rows);
  const auto above_zero = [](const std::vector<double>& values) {
    return static_cast<int>(std::count_if(values.begin(), values.end(), [](double v) { return v > 0.0; }));
  };
  summary.limit_violations = above_zero(rows.number("limit_violations"));
  summary.nonfinite_commands = above_zero(rows.number("nonfinite_commands"));
  return summary;
}

std::string to_json(const CampaignSummary& summary) {
  Json json;
  const GroupSummary& all = summary.groups.front();
  json["runs"] = all.runs;
  json["opened_fraction"] = share(all.opened, all.runs);
  json["opened_without_contact_fraction"] = share(all.opened_clean, all.runs);
  json["reasons"] = summary.reasons;
  const ProbingSummary& probing = summary.probing;
  if (probing.runs > 0) {
    json["probing"] = {{"runs", probing.runs},
                       {"found_within_30_deg", probing.found},
                       {"at_most_15_N_over_need", probing.gentle},
                       {"at_most_5_s", probing.quick}};
  }
  json["runs_with_limit_violations"] = summary.limit_violations;
  json["runs_with_nonfinite_commands"] = summary.nonfinite_commands;
  for (const GroupSummary& group : summary.groups) {
    Json entry = {{"runs", group.runs},
                  {"opened", group.opened},
                  {"opened_without_contact", group.opened_clean},
                  {"opened_fraction", share(group.opened, group.runs)},
                  {"opened_without_contact_fraction", share(group.opened_clean, group.runs)},
                  {"runs_with_contact", group.contact_runs},
                  {"runs_with_error", group.errors}};
    for (const auto& [column, metric] : group.metrics) {
      entry["metrics"][column] = {
          {"count", metric.count}, {"p50", json_of(metric.p50)}, {"p90", json_of(metric.p90)}, {"max", json_of(metric.max)}};
    }
    json["groups"][group.name] = entry;
  }
  return json.dump(2) + "\n";
}

std::string format_summary(const CampaignSummary& summary) {
  std::string text =
      fmt::format("{:<31}{:>6}{:>8}{:>11}{:>8}{:>16}\n", "group", "runs", "opened", "no contact", "errors", "normal N, p90");
  for (const GroupSummary& group : summary.groups) {
    text += fmt::format("{:<31}{:>6}{:>8}{:>11}{:>8}{:>16}\n", group.name, group.runs, group.opened, group.opened_clean,
                        group.errors, cell(group.metrics.at("peak_normal_force_free_N").p90, 1.0));
  }
  text += "\nreasons: ";
  bool first = true;
  for (const auto& [reason, count] : summary.reasons) {
    text += fmt::format("{}{} {}", first ? "" : ", ", reason, count);
    first = false;
  }
  text += fmt::format("\nruns with limit violations {}, with commands that are not finite {}\n", summary.limit_violations,
                      summary.nonfinite_commands);
  const ProbingSummary& probing = summary.probing;
  if (probing.runs > 0) {
    text +=
        fmt::format("probing in {} runs: direction found within 30 deg {}, at most 15 N over the need {}, at most 5 s {}\n",
                    probing.runs, probing.found, probing.gentle, probing.quick);
  }
  text += fmt::format("\n{:<40}{:>9}{:>9}{:>9}{:>7}\n", "all", "p50", "p90", "max", "runs");
  for (const Metric& metric : kMetrics) {
    const MetricSummary& m = summary.groups.front().metrics.at(metric.column);
    if (m.count == 0) continue;
    text += fmt::format("{:<40}{:>9}{:>9}{:>9}{:>7}\n", fmt::format("{} [{}]", metric.title, metric.unit),
                        cell(m.p50, metric.scale), cell(m.p90, metric.scale), cell(m.max, metric.scale), m.count);
  }
  return text;
}

}  // namespace ajar
