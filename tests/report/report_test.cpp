// Strategy: write run folders by hand with known values and look for them in the data of the page: thinned but with its
// peaks, error of the belief by a closed form, names of phases; text that looks like HTML must not become HTML; a log that
// was cut off and a folder without result still give a page. What the page does with its data is tested in web/tests.
#include "ajar/report/report.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "ajar/core/error.hpp"
#include "page_data.hpp"

namespace ajar {
namespace {

namespace fs = std::filesystem;

/// A hinge of radius 0.5 m about the origin, opened from 0 to 1 rad; the belief is off by 0.1 rad; one force peak at row
/// 777.
std::string synthetic_log(int rows) {
  std::string text =
      "time,phase,true_opening,true_dir_x,true_dir_y,true_dir_z,true_curv_x,true_curv_y,true_curv_z,true_handle_x,true_"
      "handle_y,"
      "true_handle_z,true_hand_x,true_hand_y,true_hand_z,est_dir_x,est_dir_y,est_dir_z,est_curv_x,est_curv_y,est_curv_z,"
      "est_dir_sigma,est_curv_sigma,true_force_x,true_force_y,true_force_z,base_yaw,true_base_yaw,true_base_x,true_base_y,"
      "cmd_dq1,cmd_dq2\n";
  for (int i = 0; i < rows; ++i) {
    const double q = static_cast<double>(i) / rows, e = q + 0.1;
    const double peak = i == 777 ? 1000.0 : 1.0;
    char line[512];
    std::snprintf(line, sizeof line,
                  "%.3f,%s,%g,%g,%g,0,0,0,2,%g,%g,1,%g,%g,1,%g,%g,0,0,0,1.5,0.05,0.2,0,0,%g,0,0,-1,0,0.25,-0.5\n", 0.002 * i,
                  i < rows / 4 ? "approach" : "open", q, -std::sin(q), std::cos(q), 0.5 * std::cos(q), 0.5 * std::sin(q),
                  0.5 * std::cos(q), 0.5 * std::sin(q), -std::sin(e), std::cos(e), peak);
    text += line;
  }
  return text;
}

using test::column;

class ReportTest : public ::testing::Test {
 protected:
  fs::path folder = fs::temp_directory_path() / ("ajar_report_" + std::to_string(::getpid()));
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
  /// The one run of the folder's page.
  [[nodiscard]] nlohmann::json run() const { return test::page_data(make_report({folder}))["runs"][0]; }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
  }
};

TEST_F(ReportTest, ShowsDerivedCurvesThinnedWithTheirPeaks) {
  write("log.csv", synthetic_log(40000));
  EXPECT_LT(make_report({folder}).size(), 4u << 20);
  const nlohmann::json data = run();
  const auto time = column(data, "time");
  // One row per 10 ms of 500 Hz, and what is kept beside them: at most one peak of two curves per 0.1 s, extremes.
  EXPECT_GE(time.size(), 8000u);
  EXPECT_LE(time.size(), 8000u + 2u * 800u + 100u);
  EXPECT_EQ(time.size(), data["rows"]);
  EXPECT_EQ(data["log_rows"], 40000);
  const auto normal = column(data, "normal_true");
  // One row of 1000 N among ten of a 20 ms window, the others 1 N.
  EXPECT_NEAR(*std::max_element(normal.begin(), normal.end()), 100.9, 0.01);
  EXPECT_NEAR(column(data, "direction_error").back(), 0.1 * 180.0 / M_PI, 1e-3);
  EXPECT_NEAR(column(data, "curvature_2sigma").back(), 0.4, 1e-6);
  EXPECT_NEAR(column(data, "opening").back(), 180.0 / M_PI, 0.01);
  EXPECT_EQ(data["phase_names"], (std::vector<std::string>{"approach", "open"}));
  EXPECT_EQ(data["joints"], 2);
}

TEST_F(ReportTest, KeepsTheInstantOfEveryChangeOfPhase) {
  write("log.csv", synthetic_log(4001));
  const nlohmann::json data = run();
  const auto phase = column(data, "phase"), time = column(data, "time");
  const auto change = std::adjacent_find(phase.begin(), phase.end(), std::not_equal_to<>());
  ASSERT_NE(change, phase.end());
  const auto row = static_cast<std::size_t>(change - phase.begin());
  EXPECT_NEAR(time[row], 0.002 * 999, 1e-6);
  EXPECT_NEAR(time[row + 1], 0.002 * 1000, 1e-6);
}

TEST_F(ReportTest, ShowsTheTimeOfTheTicksRowByRow) {
  write("log.csv", synthetic_log(100));
  std::string ticks = "time,tick_us\n";
  for (int i = 0; i < 60; ++i) ticks += std::to_string(0.002 * i) + "," + (i == 33 ? "900" : "20") + "\n";
  write("ticks.csv", ticks);
  const nlohmann::json data = run();
  const auto tick = column(data, "tick_us"), time = column(data, "time");
  const auto peak = std::find(tick.begin(), tick.end(), 900.0F);
  ASSERT_NE(peak, tick.end());
  EXPECT_NEAR(time[static_cast<std::size_t>(peak - tick.begin())], 0.066, 1e-6);
  EXPECT_TRUE(std::isnan(tick.back()));
}

TEST_F(ReportTest, NeedsNoNetworkAndEscapesText) {
  write("log.csv", synthetic_log(100));
  write("result.json", R"({"outcome":"stopped","reason":"</script><script>alert(1)</script>","notes":["<img src=x>"]})");
  write("scenario.toml", "# </script><b>&\nrobot = \"heron\"\n");
  const std::string page = make_report({folder});
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  EXPECT_EQ(page.find("<img src=x>"), std::string::npos);
  EXPECT_EQ(page.find(" src=\"http"), std::string::npos);
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  EXPECT_NE(page.find("\\u003c/script\\u003e"), std::string::npos);
  EXPECT_EQ(test::page_data(page)["runs"][0]["scenario"], "# </script><b>&\nrobot = \"heron\"\n");
}

TEST_F(ReportTest, EscapesTheNameOfTheFolderInTheTitle) {
  const fs::path odd = folder / "<b>&\"";
  fs::create_directories(odd);
  std::ofstream(odd / "log.csv", std::ios::binary) << synthetic_log(10);
  const std::string page = make_report({odd});
  EXPECT_NE(page.find("<title>&lt;b&gt;&amp;&quot; - Ajar</title>"), std::string::npos);
  EXPECT_EQ(test::page_data(page)["runs"][0]["name"], "<b>&\"");
}

TEST_F(ReportTest, SurvivesACutOffRunWithoutResult) {
  const std::string log = synthetic_log(500);
  write("log.csv", log.substr(0, log.size() - 30));
  write("result.json", "{\"outcome\": \"ope");
  const nlohmann::json data = run();
  EXPECT_TRUE(data["result"].is_null());
  EXPECT_EQ(data["cut_off"], true);
  EXPECT_EQ(data["log_rows"], 499);
  EXPECT_NEAR(column(data, "time").back(), 0.002 * 498, 1e-6);
}

TEST_F(ReportTest, ShowsARunOfNoTicks) {
  write("log.csv", synthetic_log(0));
  EXPECT_EQ(run()["rows"], 0);
}

TEST_F(ReportTest, ShowsNotANumberAsAGap) {
  std::string log = synthetic_log(3);
  log.replace(log.rfind(",-0.5"), 5, ",nan");
  write("log.csv", log);
  const auto rate = column(run(), "dq2");
  ASSERT_GE(rate.size(), 2u);
  EXPECT_EQ(rate.front(), -0.5F);
  EXPECT_TRUE(std::isnan(rate.back()));
}

TEST_F(ReportTest, SlideIsShownInMetres) {
  write("log.csv", synthetic_log(100));
  write("scene.json", R"({"mechanism":{"type":"slide"},"robot":{"joint_rate_limit":[3.14,3.14]}})");
  const nlohmann::json data = run();
  EXPECT_EQ(data["slide"], true);
  EXPECT_NEAR(column(data, "opening").back(), 0.99, 1e-6);
  EXPECT_EQ(data["scene"]["robot"]["joint_rate_limit"][1], 3.14);
}

TEST_F(ReportTest, ComparesRunsUnderNamesThatTellThemApart) {
  for (const char* name : {"one", "two", "two/one"}) {
    fs::create_directories(folder / name);
    std::ofstream(folder / name / "log.csv", std::ios::binary) << synthetic_log(100);
  }
  const nlohmann::json runs = test::page_data(make_report({folder / "one", folder / "two/"}))["runs"];
  ASSERT_EQ(runs.size(), 2u);
  EXPECT_EQ(runs[0]["name"], "one");
  EXPECT_EQ(runs[1]["name"], "two");
  const nlohmann::json same = test::page_data(make_report({folder / "one", folder / "two/one"}))["runs"];
  EXPECT_NE(same[0]["name"], same[1]["name"]);
}

TEST_F(ReportTest, WritesTheFileAndRefusesWhatIsNoRun) {
  EXPECT_THROW(write_report(folder), IoError);
  write("log.csv", "a,b\n1,2\n");
  EXPECT_THROW(write_report(folder), IoError);
  write("log.csv", synthetic_log(10));
  write_report(folder);
  EXPECT_TRUE(fs::exists(folder / "report.html"));
  EXPECT_THROW((void)make_report({folder}, ReportConfig{0.0}), ConfigError);
}

}  // namespace
}  // namespace ajar
