// Strategy: result.json must hold every key that readers rely on, be valid JSON whatever the text, and give the same scalars
// as the row of a campaign.
#include "ajar/campaign/result.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>

namespace ajar {
namespace {

TEST(RunResult, HasEveryKeyThatReadersRelyOn) {
  const std::string json = to_json(RunResult{});
  for (const char* key : {"outcome",
                          "phase",
                          "reason",
                          "mechanism_type_true",
                          "mechanism_type_estimated",
                          "opening",
                          "opening_fraction",
                          "duration_s",
                          "open_duration_s",
                          "handle_travel_m",
                          "peak_normal_force_N",
                          "mean_normal_force_N",
                          "peak_pull_force_N",
                          "peak_torque_Nm",
                          "peak_probe_force_N",
                          "probe_force_over_need_N",
                          "probe_direction_error_rad",
                          "unwanted_contact_count",
                          "unwanted_contacts",
                          "min_clearance_m",
                          "path_error_max_m",
                          "distance_min_m",
                          "distance_max_m",
                          "heading_error_rms_rad",
                          "heading_error_max_rad",
                          "min_singular_value",
                          "direction_error_final_rad",
                          "curvature_error_final_per_m",
                          "curvature_sigma_final_per_m",
                          "angle_error_final_rad",
                          "limit_violations",
                          "nonfinite_commands",
                          "missed_ticks",
                          "tick_us",
                          "p50",
                          "p99",
                          "p999",
                          "max",
                          "real_time_factor",
                          "seed",
                          "version"}) {
    std::string quoted(1, '"');
    quoted.append(key).append("\":");
    EXPECT_NE(json.find(quoted), std::string::npos) << key;
  }
}

TEST(RunResult, QuotesTextAndListsContacts) {
  RunResult result;
  result.explanation = "said \"no\"\nand \xff stopped";
  result.unwanted_contacts.push_back({1.5, "hand + wall", 12.0});
  result.notes = {"latch"};
  const std::string json = to_json(result);
  EXPECT_NE(json.find("said \\\"no\\\"\\nand"), std::string::npos);
  EXPECT_NE(json.find("\"bodies\": \"hand + wall\""), std::string::npos);
  EXPECT_NE(json.find("\"unwanted_contact_count\": 1"), std::string::npos);
  EXPECT_NE(json.find("\"latch\""), std::string::npos);
}

TEST(RunResult, NotFiniteIsNotApplicable) {
  RunResult result;
  result.opening = std::numeric_limits<double>::quiet_NaN();
  result.stop_force = std::numeric_limits<double>::infinity();
  EXPECT_NE(to_json(result).find("\"opening\": null"), std::string::npos);
  EXPECT_NE(to_json(result).find("\"stop_force_N\": null"), std::string::npos);
}

TEST(RunResult, FiguresThatDependOnTheComputerStandLast) {
  const auto fields = result_fields(RunResult{});
  const auto first =
      std::find_if(fields.begin(), fields.end(), [](const ResultField& f) { return f.name == "missed_ticks"; });
  ASSERT_NE(first, fields.end());
  for (auto field = first + 1; field != fields.end(); ++field) {
    EXPECT_TRUE(field->name.rfind("tick_us", 0) == 0 || field->name == "real_time_factor") << field->name;
  }
}

}  // namespace
}  // namespace ajar
