#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace ajar {

/// Distribution of one figure over the runs that have it.
struct MetricSummary {
  int count = 0;
  std::optional<double> p50;
  std::optional<double> p90;
  std::optional<double> max;
};

/// Runs that have something in common.
struct GroupSummary {
  std::string name;  ///< all, direction_error_below_30_deg, …, hinge, slide
  int runs = 0;
  int opened = 0;
  int opened_clean = 0;                          ///< Opened without any unwanted contact
  int contact_runs = 0;                          ///< With an unwanted contact, opened or not
  int errors = 0;                                ///< Exit code 2 or 3
  std::map<std::string, MetricSummary> metrics;  ///< By column of runs.csv
};

/// Probing over the runs that had to: whether it found the way, how hard it pressed and how long it took.
struct ProbingSummary {
  int runs = 0;
  int found = 0;   ///< Pulling began within 30° of the true direction
  int gentle = 0;  ///< At most 15 N more than the mechanism needed
  int quick = 0;   ///< At most 5 s
};

struct CampaignSummary {
  std::vector<GroupSummary> groups;  ///< The first is "all"
  ProbingSummary probing;
  std::map<std::string, int> reasons;  ///< Runs per reason
  int limit_violations = 0;            ///< Runs with any
  int nonfinite_commands = 0;          ///< Runs with any
};

/// Summary of a runs.csv. @throws IoError
[[nodiscard]] CampaignSummary summarize(const std::filesystem::path& runs_csv);

[[nodiscard]] std::string to_json(const CampaignSummary& summary);

/// The same for people, on one screen: what summary.json has of the groups is left out.
[[nodiscard]] std::string format_summary(const CampaignSummary& summary);

}  // namespace ajar
