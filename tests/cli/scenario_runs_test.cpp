// Strategy: every file of scenarios/ is run by the program as anyone would run it, and judged by result.json, which comes
// from the truth. Most must open without a single unwanted contact; those with a fault must stop for the reason that was
// injected. The bars are those of the product's promise, not of today's figures: force peaks stay below the limit of the
// scenario, a command is never outside the limits or without a number.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

namespace {

namespace fs = std::filesystem;

/// Scenarios in which something goes wrong on purpose, and the reason that the mission must give.
const std::map<std::string, std::string> kStops{{"locked", "locked"},
                                                {"sensor_nan", "sensor_invalid"},
                                                {"joint_nan", "sensor_invalid"},
                                                {"sensor_silent", "sensor_silent"},
                                                {"base_blocked", "base_blocked"},
                                                {"grasp_lost", "grasp_lost"}};

std::vector<std::string> scenario_names() {
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(std::string(AJAR_SOURCE_DIR) + "/scenarios")) {
    if (entry.path().extension() == ".toml") names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

/// Lines of a CSV file, header included, and whether the last one is complete.
std::pair<int, bool> rows_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream text;
  text << in.rdbuf();
  const std::string all = text.str();
  return {static_cast<int>(std::count(all.begin(), all.end(), '\n')), !all.empty() && all.back() == '\n'};
}

class ScenarioRun : public ::testing::TestWithParam<std::string> {};

TEST_P(ScenarioRun, EndsAsItsFirstLinePromises) {
  const std::string file = std::string(AJAR_SOURCE_DIR) + "/scenarios/" + GetParam() + ".toml";
  const fs::path folder = fs::temp_directory_path() / ("ajar_scenario_run_" + GetParam() + "_" + std::to_string(::getpid()));
  const std::string command =
      std::string(AJAR_PROGRAM) + " run " + file + " --quiet --out " + folder.string() + " > /dev/null";
  const int status = std::system(command.c_str());
  ASSERT_TRUE(WIFEXITED(status));
  const auto stop = kStops.find(GetParam());
  EXPECT_EQ(WEXITSTATUS(status), stop == kStops.end() ? 0 : 1);

  std::ifstream in(folder / "result.json");
  ASSERT_TRUE(in.good()) << folder;
  const auto result = nlohmann::json::parse(in);
  EXPECT_EQ(result.at("outcome"), stop == kStops.end() ? "opened" : "stopped") << result.at("reason");
  if (stop != kStops.end()) {
    EXPECT_EQ(result.at("reason"), stop->second);
  } else {
    EXPECT_LT(result.at("peak_normal_force_N").get<double>(), 45.0);
  }
  EXPECT_EQ(result.at("unwanted_contact_count"), 0) << result.at("unwanted_contacts");
  EXPECT_EQ(result.at("limit_violations"), 0);
  EXPECT_EQ(result.at("nonfinite_commands"), 0);

  // Header and one row per tick, complete to the last.
  const auto [rows, complete] = rows_of(folder / "log.csv");
  const double period = GetParam() == "slow_loop" ? 0.02 : 0.002;
  EXPECT_TRUE(complete);
  EXPECT_NEAR(rows - 1, result.at("duration_s").get<double>() / period, 2.0);
  fs::remove_all(folder);
}

INSTANTIATE_TEST_SUITE_P(All, ScenarioRun, ::testing::ValuesIn(scenario_names()), [](const auto& one) { return one.param; });

}  // namespace
