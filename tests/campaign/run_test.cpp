// Strategy: start pose and guess by geometry; the loop with a blind plant that records what it is told, so that a mission
// ends at once for a known reason: files complete, same seed same bytes, stop flag, nothing half-made when the set-up fails.
// Missions that open something: the scenario tests.
#include "ajar/campaign/run.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <fstream>
#include <iterator>

#include "ajar/campaign/judge.hpp"
#include "ajar/core/error.hpp"
#include "ajar/log/csv_table.hpp"

namespace ajar {
namespace {

namespace fs = std::filesystem;

/// Sees nothing, stands still.
class BlindPlant : public Plant, public Witness {
 public:
  BlindPlant(const BasePose& start, const JointVector& home) {
    state_.base = start;
    state_.q = home;
    state_.dq = JointVector::Zero(home.size());
    truth_.base = start;
    truth_.q = home;
    truth_.dq = state_.dq;
  }
  void reset(std::uint64_t) override { state_.time = 0.0; }
  void apply(const Command& command) noexcept override { finite_ = finite_ && command.dq.allFinite(); }
  void advance(double dt) noexcept override { state_.time += dt; }
  RobotState measure() noexcept override {
    state_.wrench_time = state_.time;
    return state_;
  }
  const Truth& truth() const noexcept override { return truth_; }
  const std::vector<Contact>& contacts() const noexcept override { return contacts_; }

 private:
  RobotState state_;
  Truth truth_;
  std::vector<Contact> contacts_;
  bool finite_ = true;
};

SimulatedPlant make_blind(const PlantRequest& request) {
  SimulatedPlant made;
  auto plant = std::make_unique<BlindPlant>(request.start(*request.mechanism), request.home);
  made.witness = plant.get();
  made.plant = std::move(plant);
  made.truth = *request.mechanism;
  made.truth.latched = true;
  made.truth.latch = "knob";
  return made;
}

std::string read(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

class RunTest : public ::testing::Test {
 protected:
  fs::path folder = fs::temp_directory_path() / ("ajar_run_" + std::to_string(::getpid()));
  Scenario scenario;
  void SetUp() override {
    scenario.belief.direction_error = 0.5;
    scenario.seed = 3;
  }
  void TearDown() override { fs::remove_all(folder); }
};

TEST_F(RunTest, WritesACompleteFolderAndTheSameBytesAgain) {
  RunOptions options;
  for (const char* name : {"a", "b"}) {
    options.folder = folder / name;
    const RunResult result = run_mission(scenario, make_blind, options);
    EXPECT_EQ(result.outcome, "stopped");
    EXPECT_FALSE(result.reason.empty());
    EXPECT_NE(result.reason, "running");
    EXPECT_EQ(result.nonfinite_commands, 0);
    EXPECT_EQ(result.seed, 3u);
    ASSERT_EQ(result.notes.size(), 1u);
    EXPECT_NE(result.notes[0].find("knob"), std::string::npos);
    for (const char* file : {"scenario.toml", "result.json", "log.csv", "report.html", "version.txt", "scene.json"}) {
      EXPECT_TRUE(fs::exists(options.folder / file)) << file;
    }
    const CsvTable log = read_csv(options.folder / "log.csv", {{"time"}, {"phase", "status"}});
    EXPECT_NEAR(static_cast<double>(log.rows) * scenario.mission.period, result.duration, 1e-6);
    EXPECT_EQ(log.texts.at("status").back(), result.reason);
  }
  for (const char* file : {"scenario.toml", "log.csv", "scene.json"})
    EXPECT_EQ(read(folder / "a" / file), read(folder / "b" / file)) << file;
}

TEST_F(RunTest, LogHasEveryColumnThatReadersRelyOn) {
  RunOptions options;
  options.folder = folder;
  (void)run_mission(scenario, make_blind, options);
  const CsvTable log = read_csv(folder / "log.csv", {});
  std::vector<std::string> names{
      "time",        "phase",         "status",   "base_x",        "base_y",    "base_yaw",      "base_v",
      "base_w",      "gripper",       "distance", "heading_error", "sigma_min", "est_dir_sigma", "est_curv_sigma",
      "est_type",    "cmd_v",         "cmd_w",    "solver_status", "tick_us",   "true_opening",  "true_base_x",
      "true_base_y", "true_base_yaw", "hand_qw",  "hand_qx",       "hand_qy",   "hand_qz",       "ref_vx",
      "ref_vy",      "ref_vz",        "ref_wx",   "ref_wy",        "ref_wz"};
  for (const char* prefix : {"force", "torque", "hand", "est_dir", "est_curv", "true_hand", "true_handle", "true_dir",
                             "true_curv", "true_force"}) {
    for (const char* axis : {"_x", "_y", "_z"}) names.push_back(std::string(prefix) + axis);
  }
  for (const char* prefix : {"q", "dq", "cmd_dq"}) {
    for (char i = '1'; i <= '6'; ++i) names.push_back(std::string(prefix) + i);
  }
  for (const std::string& name : names) {
    EXPECT_NE(std::find(log.names.begin(), log.names.end(), name), log.names.end()) << name;
  }
}

TEST_F(RunTest, StopFlagEndsTheRunAsInterrupted) {
  const std::atomic<bool> stop{true};
  RunOptions options;
  options.stop = &stop;
  EXPECT_EQ(run_mission(scenario, make_blind, options).reason, to_string(EndReason::Interrupted));
}

TEST_F(RunTest, NothingIsLeftWhenTheSetUpFails) {
  RunOptions options;
  options.folder = folder;
  const PlantFactory failing = [](const PlantRequest&) -> SimulatedPlant { throw PlantError("no plant"); };
  EXPECT_THROW((void)run_mission(scenario, failing, options), PlantError);
  EXPECT_THROW((void)run_mission(scenario, [](const PlantRequest&) { return SimulatedPlant{}; }, options), PlantError);
  EXPECT_FALSE(fs::exists(folder));
}

TEST_F(RunTest, ProgressIsToldAtItsPeriod) {
  int told = 0;
  RunOptions options;
  options.progress = [&](const RunProgress& progress) {
    ++told;
    EXPECT_NE(progress.record, nullptr);
  };
  const RunResult result = run_mission(scenario, make_blind, options);
  EXPECT_NEAR(told, std::ceil(result.duration / options.progress_period), 1.0);
}

TEST(StartPose, StandsInFrontOfTheHandleAndFacesIt) {
  Scenario scenario;
  scenario.start = {2.0, 0.5, 0.0};
  Mechanism mechanism;
  mechanism.handle.position = Vector3d(1.0, 3.0, 1.0);
  mechanism.handle.normal = -Vector3d::UnitY();
  const BasePose base = start_pose(scenario, mechanism);
  EXPECT_NEAR(base.x, 1.5, 1e-12);  // one who faces +y has +x on his right
  EXPECT_NEAR(base.y, 1.0, 1e-12);
  EXPECT_NEAR(base.yaw, std::atan2(2.0, -0.5), 1e-12);
  scenario.start.heading_error = -0.2;
  EXPECT_NEAR(start_pose(scenario, mechanism).yaw, base.yaw - 0.2, 1e-12);
}

TEST(DirectionGuess, IsOffByExactlyTheStatedAngleAboutARandomAxis) {
  const Vector3d truth = Vector3d(1.0, -2.0, 0.5).normalized();
  Vector3d sum = Vector3d::Zero();
  for (std::uint64_t seed = 0; seed < 400; ++seed) {
    const auto guess = draw_direction_guess({0.7}, truth, seed);
    ASSERT_TRUE(guess.has_value());
    EXPECT_NEAR(std::acos(guess->dot(truth)), 0.7, 1e-9);
    sum += *guess - guess->dot(truth) * truth;
  }
  EXPECT_LT((sum / 400.0).norm(), 0.1);  // no preferred side: 0.64 / sqrt(400) = 0.03 expected
  EXPECT_FALSE(draw_direction_guess({std::nullopt}, truth, 1).has_value());
  EXPECT_NEAR((*draw_direction_guess({0.0}, truth, 1) - truth).norm(), 0.0, 1e-12);
}

}  // namespace
}  // namespace ajar
