#pragma once

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

/// Writes a page to a file. @throws IoError
void write_page(const std::filesystem::path& file, const std::string& page);

}  // namespace ajar
