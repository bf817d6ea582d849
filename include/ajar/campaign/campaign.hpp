#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "ajar/campaign/result.hpp"
#include "ajar/campaign/run.hpp"
#include "ajar/campaign/summary.hpp"
#include "ajar/scenario/scenario.hpp"

namespace ajar {

/// How one key of the scenario is drawn anew for every run, in the unit of the key.
struct SampledKey {
  enum class Law { Uniform, LogUniform, Choice, Chance };
  std::string key;  ///< Dotted, as in a scenario
  Law law = Law::Uniform;
  double lower = 0.0;                ///< Uniform, LogUniform
  double upper = 1.0;                ///< Uniform, LogUniform
  double probability = 0.5;          ///< Chance: of true [-]
  std::vector<std::string> choices;  ///< Choice: TOML values, equally likely
};

/// One campaign file: what is drawn or listed, what is the same for all runs.
struct Campaign {
  std::filesystem::path file;  ///< Where it was read from
  std::string text;            ///< Its bytes; a campaign is resumed only if they are the same
  int runs = 0;                ///< [-]
  std::uint64_t seed = 1;
  std::string base;                 ///< TOML of the scenario that all runs start from
  std::string draw;                 ///< Random mechanisms: name of the generator; empty = none
  std::filesystem::path table;      ///< Door table; empty = none
  std::vector<std::string> doors;   ///< Ids of the table, run i takes door i modulo their number
  std::vector<SampledKey> sampled;  ///< In the order of their names
};

/// Reads and checks a campaign file, its base scenario included.
/// @throws ConfigError, IoError  naming file, line, key, value and what is allowed
[[nodiscard]] Campaign load_campaign(const std::filesystem::path& file);

/// Names of the random mechanism generators that `draw` may name.
[[nodiscard]] std::vector<std::string> mechanism_draws();

/// One run of a campaign: its scenario and the values that were drawn for it.
struct CampaignRun {
  Scenario scenario;
  std::vector<ResultField> drawn;  ///< Same names and order for every run of a campaign
};

/// The scenario of run `index`; depends on campaign seed and index only. @throws ConfigError, IoError
[[nodiscard]] CampaignRun make_run(const Campaign& campaign, int index);

/// Seed of run `index`, the same for every number of jobs.
[[nodiscard]] std::uint64_t run_seed(std::uint64_t campaign_seed, int index) noexcept;

/// What remains of the run folders.
enum class Keep { Failed, All, None };

struct CampaignProgress {
  int done = 0;
  int runs = 0;
  int opened = 0;
};

struct CampaignOptions {
  std::filesystem::path out;  ///< Folder of runs.csv, summary.json and runs/NUMBER/
  int jobs = 0;               ///< Threads; 0 = one per processor
  Keep keep = Keep::Failed;
  bool resume = false;                                    ///< Goes on after the complete rows of runs.csv
  const std::atomic<bool>* stop = nullptr;                ///< Becomes true: runs under way are broken off and not written
  std::function<void(const CampaignProgress&)> progress;  ///< After every row, from any thread, one at a time
};

/// Makes one run; throws as run_mission does. Must be thread-safe.
using RunFunction = std::function<RunResult(const Scenario&, const RunOptions&)>;

/// Runs what is missing: rows go to runs.csv in the order of the runs as they complete, then summary.json is written.
/// A run that throws becomes a row with exit code 2 (input) or 3 (fault) and the message; the others go on.
/// The rows are the same whatever the number of jobs, columns that depend on the computer's speed (the last ones) aside.
/// @throws ConfigError, IoError
[[nodiscard]] CampaignSummary run_campaign(const Campaign& campaign, const RunFunction& run, const CampaignOptions& options);

/// Where the folder of run `index` stands in a campaign's folder.
[[nodiscard]] std::filesystem::path run_folder(const std::filesystem::path& out, int index);

/// Makes one run of a campaign again from its seed; the same bytes as when the campaign made it.
/// @throws ConfigError, IoError, and as `run` does
RunResult replay_run(const Campaign& campaign, int index, const RunFunction& run, const RunOptions& options);

}  // namespace ajar
