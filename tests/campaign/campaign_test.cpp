// Strategy: the function that makes a run is replaced by one whose result is a function of the seed, with delays that
// scramble the order of completion: rows must be in order, the same for every number of jobs, complete after a kill and a
// resume. Bad files are refused with file, line, key, value and what is allowed. Real runs: run_test.cpp and the scenario
// tests.
#include "ajar/campaign/campaign.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <fstream>
#include <iterator>
#include <mutex>
#include <set>
#include <thread>

#include "ajar/core/error.hpp"
#include "ajar/log/csv_table.hpp"

namespace ajar {
namespace {

namespace fs = std::filesystem;

const char* const kPull = R"(runs = 24
seed = 5
[sample]
draw = "pull"
[sample.keys]
"plant.grasp.stiffness" = { log_uniform = [5e3, 3e4] }
"plant.grasp.pivots" = { chance = 0.25 }
"control.delay_ms" = { choice = [0, 0, 10, 20] }
"belief.direction_error_deg" = { uniform = [0, 60] }
[base.goal]
opening_deg = 90
)";

class CampaignTest : public ::testing::Test {
 protected:
  fs::path folder = fs::temp_directory_path() / ("ajar_campaign_" + std::to_string(::getpid()));
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }

  fs::path write(const std::string& text, const std::string& name = "c.toml") const {
    std::ofstream(folder / name, std::ios::binary) << text;
    return folder / name;
  }
  static std::string read(const fs::path& file) {
    std::ifstream stream(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  }
  CampaignOptions options(const std::string& out, int jobs) const {
    CampaignOptions result;
    result.out = folder / out;
    result.jobs = jobs;
    return result;
  }
};

/// A function of the scenario alone; every third run fails, every fifth touches something.
RunResult fake_run(const Scenario& scenario, const RunOptions&) {
  std::this_thread::sleep_for(std::chrono::microseconds(scenario.seed % 3000));
  RunResult result;
  result.outcome = scenario.seed % 3 == 0 ? "stopped" : "opened";
  result.reason = scenario.seed % 3 == 0 ? "locked" : "goal_reached";
  result.mechanism_type_true = scenario.mechanism.described.type;
  result.peak_normal_force_free = scenario.plant.grasp.stiffness / 1000.0;
  if (scenario.seed % 5 == 0) result.unwanted_contacts.push_back({1.0, "a + b", 2.0});
  return result;
}

TEST_F(CampaignTest, RowsAreInOrderAndTheSameForAnyNumberOfJobs) {
  const Campaign campaign = load_campaign(write(kPull));
  (void)run_campaign(campaign, fake_run, options("one", 1));
  (void)run_campaign(campaign, fake_run, options("four", 4));
  EXPECT_EQ(read(folder / "one/runs.csv"), read(folder / "four/runs.csv"));
  EXPECT_EQ(read(folder / "one/summary.json"), read(folder / "four/summary.json"));
  const CsvTable table = read_csv(folder / "four/runs.csv",
                                  {{"run", "plant.grasp.stiffness", "belief.direction_error_deg"}, {"mechanism.type"}});
  ASSERT_EQ(table.rows, 24u);
  for (std::size_t i = 0; i < 24; ++i) {
    EXPECT_EQ(table.numbers.at("run")[i], static_cast<double>(i));
    EXPECT_GE(table.numbers.at("plant.grasp.stiffness")[i], 5e3);
    EXPECT_LE(table.numbers.at("plant.grasp.stiffness")[i], 3e4);
    EXPECT_LE(table.numbers.at("belief.direction_error_deg")[i], 60.0);
  }
}

TEST_F(CampaignTest, SummaryCountsAsTheRowsSay) {
  const Campaign campaign = load_campaign(write(kPull));
  const CampaignSummary summary = run_campaign(campaign, fake_run, options("sum", 2));
  int opened = 0, clean = 0;
  std::vector<double> stiffness;
  for (int i = 0; i < campaign.runs; ++i) {
    const CampaignRun run = make_run(campaign, i);
    const bool good = run.scenario.seed % 3 != 0;
    if (good) ++opened;
    if (good && run.scenario.seed % 5 != 0) ++clean;
    stiffness.push_back(run.scenario.plant.grasp.stiffness / 1000.0);
  }
  const GroupSummary& all = summary.groups.front();
  EXPECT_EQ(all.runs, 24);
  EXPECT_EQ(all.opened, opened);
  EXPECT_EQ(all.opened_clean, clean);
  EXPECT_EQ(summary.reasons.at("goal_reached"), opened);
  EXPECT_NEAR(all.metrics.at("peak_normal_force_free_N").max.value(), *std::max_element(stiffness.begin(), stiffness.end()),
              1e-6);
  EXPECT_NE(format_summary(summary).find("direction_error_below_30_deg"), std::string::npos);
  int split = 0;
  for (const GroupSummary& group : summary.groups) {
    if (group.name.rfind("direction_error", 0) == 0) split += group.runs;
  }
  EXPECT_EQ(split, 24);
}

TEST_F(CampaignTest, SummaryCountsWhatProbingFound) {
  const auto probing = [](const Scenario& scenario, const RunOptions& run) {
    RunResult result = fake_run(scenario, run);
    switch (scenario.seed % 4) {
      case 0: break;  // did not probe
      case 1:         // found, hard and slow
        result.probe_duration = 5.1;
        result.probe_force_over_need = 15.1;
        result.probe_direction_error = 29.0 * M_PI / 180.0;
        break;
      case 2:  // the wrong way, gently and quickly
        result.probe_duration = 4.9;
        result.probe_force_over_need = 14.9;
        result.probe_direction_error = 31.0 * M_PI / 180.0;
        break;
      default: result.probe_duration = 9.0;  // nothing found
    }
    return result;
  };
  const Campaign campaign = load_campaign(write(kPull));
  const CampaignSummary summary = run_campaign(campaign, probing, options("probing", 2));
  int of[4] = {0, 0, 0, 0};
  for (int i = 0; i < campaign.runs; ++i) ++of[make_run(campaign, i).scenario.seed % 4];
  EXPECT_EQ(summary.probing.runs, 24 - of[0]);
  EXPECT_EQ(summary.probing.found, of[1]);
  EXPECT_EQ(summary.probing.gentle, of[2]);
  EXPECT_EQ(summary.probing.quick, of[2]);
  EXPECT_NE(format_summary(summary).find("direction found within 30 deg"), std::string::npos);
}

TEST_F(CampaignTest, LeavesAPageAndReplaysARunFromItsSeed) {
  const Campaign campaign = load_campaign(write(kPull));
  (void)run_campaign(campaign, fake_run, options("page", 2));
  EXPECT_NE(read(folder / "page/report.html").find("\"kind\":\"campaign\""), std::string::npos);
  RunOptions asked;
  asked.folder = run_folder("page", 7);
  EXPECT_EQ(asked.folder, fs::path("page/runs/00007"));
  const auto look = [&](const Scenario& scenario, const RunOptions& given) {
    EXPECT_EQ(scenario.seed, run_seed(campaign.seed, 7));
    EXPECT_EQ(given.folder, asked.folder);
    return fake_run(scenario, given);
  };
  EXPECT_EQ(replay_run(campaign, 7, look, asked).outcome, run_seed(campaign.seed, 7) % 3 == 0 ? "stopped" : "opened");
  EXPECT_THROW((void)replay_run(campaign, 24, look, asked), ConfigError);
}

TEST_F(CampaignTest, ResumeGoesOnAfterTheLastCompleteRow) {
  const Campaign campaign = load_campaign(write(kPull));
  (void)run_campaign(campaign, fake_run, options("whole", 2));
  const std::string whole = read(folder / "whole/runs.csv");
  (void)run_campaign(campaign, fake_run, options("cut", 2));
  fs::resize_file(folder / "cut/runs.csv", whole.size() * 3 / 5);  // killed in the middle of a row
  std::atomic<int> made{0};
  const auto counting = [&](const Scenario& scenario, const RunOptions& run_options) {
    ++made;
    return fake_run(scenario, run_options);
  };
  CampaignOptions resumed = options("cut", 3);
  resumed.keep = Keep::None;
  EXPECT_THROW((void)run_campaign(campaign, counting, resumed), ConfigError);  // would overwrite rows
  resumed.resume = true;
  (void)run_campaign(campaign, counting, resumed);
  EXPECT_EQ(read(folder / "cut/runs.csv"), whole);
  EXPECT_EQ(read(folder / "cut/summary.json"), read(folder / "whole/summary.json"));
  EXPECT_LT(made.load(), 24);
  EXPECT_GT(made.load(), 0);
  Campaign other = campaign;
  other.seed = 6;
  EXPECT_THROW((void)run_campaign(other, counting, resumed), ConfigError);
}

TEST_F(CampaignTest, StopLeavesCompleteRowsOnly) {
  const Campaign campaign = load_campaign(write(kPull));
  std::atomic<bool> stop{false};
  CampaignOptions stopped = options("stop", 2);
  stopped.keep = Keep::None;
  stopped.stop = &stop;
  stopped.progress = [&](const CampaignProgress& progress) { stop = progress.done >= 5; };
  (void)run_campaign(campaign, fake_run, stopped);
  const std::size_t rows = read_csv(folder / "stop/runs.csv", {}).rows;
  EXPECT_GE(rows, 5u);
  EXPECT_LT(rows, 24u);
  stop = false;
  CampaignOptions resumed = options("stop", 2);
  resumed.resume = true;
  (void)run_campaign(campaign, fake_run, resumed);
  (void)run_campaign(campaign, fake_run, options("fresh", 2));
  EXPECT_EQ(read(folder / "stop/runs.csv"), read(folder / "fresh/runs.csv"));
}

TEST_F(CampaignTest, FailedRunsAreMadeAgainWithAFolder) {
  const Campaign campaign = load_campaign(write(kPull));
  for (const Keep keep : {Keep::Failed, Keep::All, Keep::None}) {
    std::mutex mutex;
    std::set<std::string> folders;
    const auto noting = [&](const Scenario& scenario, const RunOptions& run_options) {
      const std::lock_guard lock(mutex);
      if (!run_options.folder.empty()) folders.insert(run_options.folder.filename().string());
      return fake_run(scenario, run_options);
    };
    CampaignOptions kept = options("keep" + std::to_string(static_cast<int>(keep)), 2);
    kept.keep = keep;
    const CampaignSummary summary = run_campaign(campaign, noting, kept);
    const GroupSummary& all = summary.groups.front();
    const int expected = keep == Keep::Failed ? all.runs - all.opened : keep == Keep::All ? all.runs : 0;
    EXPECT_EQ(static_cast<int>(folders.size()), expected);
  }
}

TEST_F(CampaignTest, ARunThatThrowsIsARowAndTheOthersGoOn) {
  const Campaign campaign = load_campaign(write(kPull));
  const auto failing = [](const Scenario& scenario, const RunOptions& run_options) -> RunResult {
    if (scenario.seed % 3 == 0) throw ModelError("bad, \"worse\"\nworst");
    if (scenario.seed % 3 == 1) throw std::runtime_error("bug");
    return fake_run(scenario, run_options);
  };
  const CampaignSummary summary = run_campaign(campaign, failing, options("throw", 2));
  EXPECT_EQ(summary.groups.front().runs, 24);
  EXPECT_EQ(summary.groups.front().errors, summary.reasons.at("bad_input") + summary.reasons.at("fault"));
  const CsvTable table = read_csv(folder / "throw/runs.csv", {{"exit_code"}, {"explanation"}});
  for (std::size_t i = 0; i < table.rows; ++i) {
    if (table.numbers.at("exit_code")[i] == 2.0) {
      EXPECT_EQ(table.texts.at("explanation")[i], "bad, \"worse\" worst");
    }
  }
}

TEST_F(CampaignTest, RunsDifferAndRepeat) {
  const Campaign campaign = load_campaign(write(kPull));
  std::set<std::uint64_t> seeds;
  std::set<double> radii;
  for (int i = 0; i < 24; ++i) {
    const CampaignRun run = make_run(campaign, i), again = make_run(campaign, i);
    EXPECT_EQ(to_toml(run.scenario), to_toml(again.scenario));
    seeds.insert(run.scenario.seed);
    radii.insert(run.scenario.mechanism.described.mass);
  }
  EXPECT_EQ(seeds.size(), 24u);
  EXPECT_GT(radii.size(), 20u);
  EXPECT_NE(run_seed(1, 0), run_seed(0, 1));
}

TEST_F(CampaignTest, AKeptScenarioGivesTheSameRunAgain) {
  const Campaign campaign = load_campaign(write(kPull));
  for (int i = 0; i < 8; ++i) {
    const std::string text = to_toml(make_run(campaign, i).scenario);
    EXPECT_EQ(to_toml(load_scenario(write(text, "again.toml"))), text);
  }
}

TEST_F(CampaignTest, DoorTableGivesOneRunPerDoor) {
  const fs::path table = fs::path(AJAR_SOURCE_DIR) / "campaigns/doors.csv";
  const Campaign campaign =
      load_campaign(write("[table]\nfrom = \"" + table.string() + "\"\n[base.limits]\nforce_N = 70\n"));
  EXPECT_EQ(campaign.runs, static_cast<int>(list_doors(table).size()));
  const CampaignRun second = make_run(campaign, 1);
  EXPECT_EQ(second.scenario.mechanism.id, list_doors(table)[1]);
  EXPECT_EQ(second.drawn.front().name, "mechanism.id");
  EXPECT_NEAR(second.scenario.mission.limits.force, 70.0, 1e-12);
}

TEST_F(CampaignTest, TheCampaignsOfTheRepositoryAreValid) {
  int found = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(AJAR_SOURCE_DIR) / "campaigns")) {
    if (entry.path().extension() != ".toml") continue;
    ++found;
    EXPECT_NO_THROW((void)load_campaign(entry.path())) << entry.path();
  }
  EXPECT_GE(found, 4);
}

TEST_F(CampaignTest, NamesWhatIsWrongWithAFile) {
  const auto refuse = [&](const std::string& text, const std::vector<std::string>& parts) {
    try {
      (void)load_campaign(write(text));
      ADD_FAILURE() << "accepted: " << text;
    } catch (const ConfigError& error) {
      for (const std::string& part : parts) {
        EXPECT_NE(std::string(error.what()).find(part), std::string::npos)
            << "'" << error.what() << "' lacks '" << part << "'";
      }
      EXPECT_EQ(std::string(error.what()).find('\n'), std::string::npos) << error.what();
    }
  };
  refuse("", {"c.toml:1:", "empty"});
  refuse("runs = ", {"c.toml:1:", "not TOML"});
  refuse("runs = 1\nrnus = 2\n", {"c.toml:2:", "rnus", "unknown key", "runs"});
  refuse("runs = 0\n[sample]\ndraw = \"pull\"\n", {"c.toml:1:", "runs = 0", "at least 1"});
  refuse("runs = 1.5\n", {"c.toml:1:", "runs = 1.5"});
  refuse("[sample]\ndraw = \"pull\"\n", {"runs: missing"});
  refuse("runs = 1\nseed = -1\n", {"c.toml:2:", "seed = -1"});
  refuse("runs = 1\n[sample]\ndraw = \"windows\"\n", {"c.toml:3:", "windows", "pull"});
  refuse("runs = 1\n[sample]\ndraw = \"pull\"\n[sample.keys]\n\"belief.direction_error_deg\" = { uniform = [60, 0] }\n",
         {"c.toml:5:", "lower <= upper"});
  refuse("runs = 1\n[sample]\ndraw = \"pull\"\n[sample.keys]\n\"plant.grasp.stiffness\" = { log_uniform = [0, 1] }\n",
         {"c.toml:5:", "0 < lower"});
  refuse("runs = 1\n[sample]\ndraw = \"pull\"\n[sample.keys]\n\"plant.grasp.pivots\" = { chance = 2 }\n",
         {"c.toml:5:", "0 to 1"});
  refuse("runs = 1\n[sample]\ndraw = \"pull\"\n[sample.keys]\n\"plant.grasp.pivots\" = { chance = 0.2, uniform = [0, 1] }\n",
         {"exactly one"});
  refuse("runs = 1\n[sample]\ndraw = \"pull\"\n[sample.keys]\n\"plant.grasp.stifness\" = { uniform = [5e3, 6e3] }\n",
         {"c.toml:5:", "plant.grasp.stifness", "plant.grasp.stiffness"});
  refuse("runs = 1\n[sample]\ndraw = \"pull\"\n[base.goal]\nopening_dge = 90\n",
         {"c.toml:5:", "opening_dge", "opening_deg"});
  refuse("runs = 1\n[sample]\ndraw = \"pull\"\n[base.goal]\nopening_deg = -90\n", {"c.toml:5:", "opening_deg = -90"});
  refuse("runs = 1\n[base.goal]\nopening_deg = 90\n", {"mechanism"});
  refuse("runs = 1\n[table]\nids = \"all\"\n", {"c.toml:2:", "table.from", "missing"});
  const std::string doors = (fs::path(AJAR_SOURCE_DIR) / "campaigns/doors.csv").string();
  refuse("[table]\nfrom = \"" + doors + "\"\nids = [\"db9999\"]\n", {"c.toml:3:", "db9999"});
  EXPECT_THROW((void)load_campaign(folder / "missing.toml"), IoError);
  EXPECT_THROW((void)load_campaign(folder), IoError);
  EXPECT_ANY_THROW((void)load_campaign(write("[table]\nfrom = \"missing.csv\"\n")));
}

TEST_F(CampaignTest, UnwritableOutputIsToldBeforeAnyRun) {
  const Campaign campaign = load_campaign(write(kPull));
  int made = 0;
  const auto counting = [&](const Scenario&, const RunOptions&) {
    ++made;
    return RunResult{};
  };
  CampaignOptions bad = options("c.toml/below_a_file", 1);
  EXPECT_THROW((void)run_campaign(campaign, counting, bad), IoError);
  bad.out.clear();
  EXPECT_THROW((void)run_campaign(campaign, counting, bad), ConfigError);
  EXPECT_EQ(made, 0);
}

}  // namespace
}  // namespace ajar
