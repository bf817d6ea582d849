// Strategy: a campaign's folder written by hand: which columns become numbers and which stay text (seeds must keep every
// digit), what counts as drawn, which replays are there, and that foreign or missing files are refused.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "ajar/core/error.hpp"
#include "ajar/report/report.hpp"
#include "page_data.hpp"

namespace ajar {
namespace {

namespace fs = std::filesystem;

class CampaignPageTest : public ::testing::Test {
 protected:
  fs::path folder = fs::temp_directory_path() / ("ajar_campaign_page_" + std::to_string(::getpid()));
  void SetUp() override { fs::create_directories(folder); }
  void TearDown() override { fs::remove_all(folder); }
  void write(const fs::path& name, const std::string& text) const {
    fs::create_directories((folder / name).parent_path());
    std::ofstream(folder / name, std::ios::binary) << text;
  }
  void write_rows() const {
    write("runs.csv",
          "run,seed,exit_code,mechanism.type,mechanism.radius,outcome,reason,explanation,peak_normal_force_N\n"
          "0,123456789012345,0,hinge,0.5,opened,goal_reached,,7.5\n"
          "1,123456789012346,1,slide,,stopped,locked,\"<b>60 N, nothing\",\n");
    write_campaign_origin(folder, {"/somewhere/pull.toml", 7});
  }
  [[nodiscard]] nlohmann::json data() const { return test::page_data(make_campaign_page(folder))["campaign"]; }
};

std::string text(const nlohmann::json& campaign, const std::string& column, std::size_t row) {
  const nlohmann::json& texts = campaign["texts"][column];
  return texts["values"][texts["index"][row].get<std::size_t>()];
}

TEST_F(CampaignPageTest, KeepsNumbersAsNumbersAndSeedsToTheLastDigit) {
  write_rows();
  const nlohmann::json campaign = data();
  EXPECT_EQ(campaign["numbers"], (std::vector<std::string>{"run", "exit_code", "mechanism.radius", "peak_normal_force_N"}));
  const auto columns = test::unpack(campaign["data"], 4, campaign["rows"]);
  EXPECT_EQ(columns[3][0], 7.5F);
  EXPECT_TRUE(std::isnan(columns[3][1]));
  EXPECT_EQ(text(campaign, "seed", 1), "123456789012346");
  EXPECT_EQ(text(campaign, "explanation", 1), "<b>60 N, nothing");
  EXPECT_EQ(make_campaign_page(folder).find("<b>60"), std::string::npos);
}

TEST_F(CampaignPageTest, KnowsWhatWasDrawnAndWhereItCameFrom) {
  write_rows();
  const nlohmann::json campaign = data();
  EXPECT_EQ(campaign["parameters"], (std::vector<std::string>{"mechanism.type", "mechanism.radius"}));
  EXPECT_EQ(campaign["origin"], "/somewhere/pull.toml");
  EXPECT_EQ(campaign["seed"], "7");
}

TEST_F(CampaignPageTest, PointsToTheReplaysThatWereKept) {
  write_rows();
  write("runs/00001/report.html", "x");
  write("runs/00002/log.csv", "x");
  write("runs/other/report.html", "x");
  EXPECT_EQ(data()["stored"], std::vector<int>{1});
}

TEST_F(CampaignPageTest, RefusesWhatIsNoCampaign) {
  EXPECT_THROW((void)make_campaign_page(folder), IoError);
  write("runs.csv", "a,b\n1,2\n");
  EXPECT_THROW((void)make_campaign_page(folder), IoError);
  write_rows();
  write("origin.json", "{\"campaign\": 3}");
  EXPECT_THROW((void)make_campaign_page(folder), IoError);
}

}  // namespace
}  // namespace ajar
