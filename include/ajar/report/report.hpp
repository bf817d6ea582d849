#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace ajar {

struct ReportConfig {
  double period = 0.01;  ///< One row of a log is shown per this time, extremes besides [s], > 0
};

/// Makes the page of one run folder, or of several on top of each other, from log.csv, ticks.csv, result.json, scene.json
/// and scenario.toml: one file without a network. Only the log must be there; a log that was cut off gives a page up to its
/// last complete row.
/// @throws IoError  if a folder has no readable log
[[nodiscard]] std::string make_report(const std::vector<std::filesystem::path>& run_folders,
                                      const ReportConfig& config = {});

/// Writes the page of one run to report.html of its folder. @throws IoError
void write_report(const std::filesystem::path& run_folder);

/// What a page needs to follow a run that goes on.
struct LivePage {
  std::vector<std::string> columns;  ///< Of the rows that will come
  std::vector<std::string> phase_names;
  int joints = 0;
  bool slide = false;
};

/// Makes the page that follows a run: it asks for server-sent events at `events` beside its own address, and sends a POST to
/// `stop`. Scene and scenario come from the run's folder.
[[nodiscard]] std::string make_live_page(const std::filesystem::path& run_folder, const LivePage& live);

/// What makes the runs of a campaign again.
struct CampaignOrigin {
  std::filesystem::path file;  ///< Campaign file
  std::uint64_t seed = 1;
};

/// `origin.json` of a campaign's folder. @throws IoError
[[nodiscard]] CampaignOrigin read_campaign_origin(const std::filesystem::path& folder);
void write_campaign_origin(const std::filesystem::path& folder, const CampaignOrigin& origin);

/// Makes the page of a campaign's folder from runs.csv and origin.json: one file without a network, which points to the
/// replays of the runs that were kept. @throws IoError
[[nodiscard]] std::string make_campaign_page(const std::filesystem::path& folder);

/// The last part of a path, also of one that ends in a slash.
[[nodiscard]] std::string folder_name(const std::filesystem::path& folder);

/// Writes a page to a file. @throws IoError
void write_page(const std::filesystem::path& file, const std::string& page);

}  // namespace ajar
