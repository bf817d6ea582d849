#pragma once

#include <filesystem>
#include <string>

namespace ajar {

struct ReportConfig {
  int points = 1500;  ///< Largest number of samples per curve [-]
};

/// Makes the page of a run folder from log.csv, result.json, scene.json and scenario.toml: one file without a network.
/// Only the log must be there; a log that was cut off gives a page up to its last complete row.
/// @throws IoError  if the folder has no readable log
[[nodiscard]] std::string make_report(const std::filesystem::path& run_folder, const ReportConfig& config = {});

/// Writes the page to report.html of the folder. @throws IoError
void write_report(const std::filesystem::path& run_folder, const ReportConfig& config = {});

}  // namespace ajar
