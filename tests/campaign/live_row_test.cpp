// Strategy: one tick with known values: every column is written and none beyond, values that follow from geometry (a force
// of 3 and 4 N along and across, a belief turned by 0.1 rad, degrees), gaps where nothing is believed. That viewers do not
// slow the loop is measured by tools/measure_live.py and not tested here.
#include "ajar/campaign/live_row.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "allocation_guard.hpp"

namespace ajar {
namespace {

constexpr double kUntouched = -12345.0;

/// A hinge of radius 0.5 m about z, a quarter radian open.
struct Tick {
  RobotState state;
  Truth truth;
  MissionRecord record;
  Command command;

  Tick() {
    state.time = 2.5;
    state.q = truth.q = JointVector::Constant(2, 0.7);
    command.dq = JointVector::Constant(2, -0.3);
    record.phase = Phase::Open;
    truth.opening = 0.25;
    truth.opening_rate = 0.1;
    truth.curvature = Vector3d(0.0, 0.0, 2.0);
    truth.force = Vector3d(3.0, 4.0, 0.0);
    record.estimate.direction = Vector3d(std::cos(0.1), std::sin(0.1), 0.0);
    record.estimate.direction_sigma = 0.05;
    record.estimate.angle = 0.2;
  }
  [[nodiscard]] TickView view() const { return {state, truth, record, command, 42.0}; }
};

class LiveRowTest : public ::testing::Test {
 protected:
  LiveRow row{JointKind::Hinge, 2};
  Tick tick;
  std::vector<double> values = std::vector<double>(row.names().size() + 1, kUntouched);

  double value(const std::string& name) {
    row.fill(tick.view(), values);
    const auto found = std::find(row.names().begin(), row.names().end(), name);
    EXPECT_NE(found, row.names().end()) << name;
    return values[static_cast<std::size_t>(found - row.names().begin())];
  }
};

TEST_F(LiveRowTest, FillsEveryColumnAndNoneBeyond) {
  row.fill(tick.view(), values);
  EXPECT_EQ(values.back(), kUntouched);
  values.pop_back();
  EXPECT_EQ(std::count(values.begin(), values.end(), kUntouched), 0);
  std::vector<std::string> names = row.names();
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

TEST_F(LiveRowTest, SaysWhatTheTickWas) {
  EXPECT_EQ(value("time"), 2.5);
  EXPECT_EQ(phase_names()[static_cast<std::size_t>(value("phase"))], "open");
  EXPECT_NEAR(value("opening"), 0.25 * 180.0 / M_PI, 1e-9);
  EXPECT_EQ(value("opening_q"), 0.25);
  EXPECT_NEAR(value("true_speed"), 0.05, 1e-12);
  EXPECT_NEAR(value("pull_true"), 3.0, 1e-12);
  EXPECT_NEAR(value("normal_true"), 4.0, 1e-12);
  EXPECT_NEAR(value("direction_error"), 0.1 * 180.0 / M_PI, 1e-9);
  EXPECT_NEAR(value("direction_2sigma"), 0.1 * 180.0 / M_PI, 1e-9);
  EXPECT_NEAR(value("opening_estimated"), 0.2 * 180.0 / M_PI, 1e-9);
  EXPECT_EQ(value("q2"), 0.7);
  EXPECT_EQ(value("dq1"), -0.3);
  EXPECT_EQ(value("tick_us"), 42.0);
}

TEST_F(LiveRowTest, BelievesNothingBeforeTheHandleIsHeld) {
  tick.record.phase = Phase::Approach;
  EXPECT_TRUE(std::isnan(value("direction_error")));
  EXPECT_TRUE(std::isnan(value("est_dir_x")));
  EXPECT_EQ(value("opening_q"), 0.25);
}

TEST_F(LiveRowTest, FillsWithoutAllocation) {
  const long before = test::allocations;
  row.fill(tick.view(), values);
  EXPECT_EQ(test::allocations, before);
}

}  // namespace
}  // namespace ajar
