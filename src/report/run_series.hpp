#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace ajar {

/// The curves of a run, thinned to what a page can show. All have the length of `time`; NaN = nothing to show.
struct RunSeries {
  std::vector<double> time;  ///< [s]
  std::vector<std::string> phase_names;
  std::map<std::string, std::vector<double>> series;  ///< Angles in degrees where a plot shows degrees; "phase" = index
  int joints = 0;                                     ///< Number of cmd_dq columns
  std::size_t rows = 0;                               ///< Complete rows of the log
  bool cut_off = false;                               ///< The log's last line was incomplete
};

/// Reads log.csv of a run folder, ticks.csv if it is there, and derives what the page shows. @throws IoError
[[nodiscard]] RunSeries read_run_series(const std::filesystem::path& folder, bool slide, double period);

}  // namespace ajar
