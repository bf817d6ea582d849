// Strategy: write run folders by hand with known values and look for them in the data of the page: thinned but with its
// peaks, error of the belief by a closed form, names of phases; text that looks like HTML must not become HTML; a log that
// was cut off and a folder without result still give a page. How the page looks is not tested here.
#include "ajar/report/report.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>

#include "ajar/core/error.hpp"

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

class ReportTest : public ::testing::Test {
 protected:
  fs::path folder = fs::temp_directory_path() / ("ajar_report_" + std::to_string(::getpid()));
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
  void write(const std::string& name, const std::string& text) const {
    std::ofstream(folder / name, std::ios::binary) << text;
  }
};

std::vector<double> series(const std::string& page, const std::string& name) {
  const std::string key = "\"" + name + "\":[";
  const auto begin = page.find(key);
  if (begin == std::string::npos) return {};
  std::vector<double> values;
  const char* at = page.c_str() + begin + key.size();
  while (*at != ']') {
    char* end = nullptr;
    values.push_back(std::strtod(at, &end));
    if (end == at) end = const_cast<char*>(std::strpbrk(at, ",]"));
    at = *end == ',' ? end + 1 : end;
  }
  return values;
}

TEST_F(ReportTest, ShowsDerivedCurvesThinnedWithTheirPeaks) {
  write("log.csv", synthetic_log(40000));
  const std::string page = make_report(folder);
  EXPECT_LT(page.size(), 4u << 20);
  const auto time = series(page, "time");
  ASSERT_GT(time.size(), 700u);
  EXPECT_LE(time.size(), 1500u);
  const auto normal = series(page, "normal_true");
  ASSERT_EQ(normal.size(), time.size());
  // One row of 1000 N among ten of a 20 ms window, the others 1 N.
  EXPECT_NEAR(*std::max_element(normal.begin(), normal.end()), 100.9, 0.01);
  const auto error = series(page, "direction_error");
  EXPECT_NEAR(error.back(), 0.1 * 180.0 / M_PI, 1e-3);
  EXPECT_NEAR(series(page, "curvature_2sigma").back(), 0.4, 1e-9);
  EXPECT_NEAR(series(page, "centre_x").back(), 0.0, 1e-5);
  EXPECT_NEAR(series(page, "opening").back(), 180.0 / M_PI, 0.01);
  EXPECT_NE(page.find("\"phase_names\":[\"approach\",\"open\"]"), std::string::npos);
  EXPECT_NE(page.find("\"joints\":2"), std::string::npos);
}

TEST_F(ReportTest, NeedsNoNetworkAndEscapesText) {
  write("log.csv", synthetic_log(100));
  write("result.json", R"({"outcome":"stopped","reason":"</script><script>alert(1)</script>","notes":["<img src=x>"]})");
  write("scenario.toml", "# </script><b>&\nrobot = \"heron\"\n");
  const std::string page = make_report(folder);
  EXPECT_EQ(page.find("<script>alert"), std::string::npos);
  EXPECT_EQ(page.find("<img"), std::string::npos);
  EXPECT_EQ(page.find("http://"), std::string::npos);
  EXPECT_EQ(page.find("https://"), std::string::npos);
  EXPECT_EQ(page.find("src="), page.find("src=x"));
  EXPECT_NE(page.find("default-src 'none'"), std::string::npos);
  EXPECT_NE(page.find("\\u003c/script\\u003e"), std::string::npos);
}

TEST_F(ReportTest, SurvivesACutOffRunWithoutResult) {
  const std::string log = synthetic_log(500);
  write("log.csv", log.substr(0, log.size() - 30));
  write("result.json", "{\"outcome\": \"ope");
  const std::string page = make_report(folder);
  EXPECT_NE(page.find("\"result\":null"), std::string::npos);
  EXPECT_NE(page.find("\"cut_off\":true"), std::string::npos);
  EXPECT_NEAR(series(page, "time").back(), 0.002 * 498, 1e-9);
}

TEST_F(ReportTest, ShowsARunOfNoTicks) {
  write("log.csv", synthetic_log(0));
  EXPECT_NE(make_report(folder).find("\"time\":[]"), std::string::npos);
}

TEST_F(ReportTest, ShowsNotANumberAsAGap) {
  std::string log = synthetic_log(3);
  log.replace(log.rfind(",-0.5"), 5, ",nan");
  write("log.csv", log);
  EXPECT_NE(make_report(folder).find("\"dq2\":[-0.5,-0.5,null]"), std::string::npos);
}

TEST_F(ReportTest, SlideIsShownInMetres) {
  write("log.csv", synthetic_log(100));
  write("scene.json", R"({"mechanism":{"type":"slide"},"robot":{"joint_rate_limit":[3.14,3.14]}})");
  const std::string page = make_report(folder);
  EXPECT_NE(page.find("\"slide\":true"), std::string::npos);
  EXPECT_NEAR(series(page, "opening").back(), 0.99, 1e-9);
  EXPECT_NE(page.find("\"joint_limits\":[3.14,3.14]"), std::string::npos);
}

TEST_F(ReportTest, WritesTheFileAndRefusesWhatIsNoRun) {
  EXPECT_THROW(write_report(folder), IoError);
  write("log.csv", "a,b\n1,2\n");
  EXPECT_THROW(write_report(folder), IoError);
  write("log.csv", synthetic_log(10));
  write_report(folder);
  EXPECT_TRUE(fs::exists(folder / "report.html"));
  EXPECT_THROW((void)make_report(folder, ReportConfig{3}), ConfigError);
}

}  // namespace
}  // namespace ajar
