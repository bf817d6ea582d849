// Strategy: exact integration of the command along straight lines in every direction, arcs of every radius and height, for
// three robots of different kinds through the same code. The hand must be on the path of the mechanism wherever the run gets
// to: where limits or reach end it, speed is given up and not the path. Left out: dynamics (tests/mujoco, campaigns).
#include <gtest/gtest.h>

#include <filesystem>

#include "ajar/wbc/input_limits.hpp"
#include "path_runs.hpp"

namespace ajar {
namespace {

namespace fs = std::filesystem;
using test::find_posture;
using test::follow;
using test::HandPath;
using test::PathRun;

constexpr double kMillimetre = 1e-3;
constexpr double kFifthDegree = 0.2 * std::numbers::pi / 180.0;

struct Tally {
  int runs = 0;
  int arrived = 0;
  double late = 0.0;  // sum
  PathRun worst;

  void add(const PathRun& run, const HandPath& path) {
    ++runs;
    arrived += run.arc >= path.length ? 1 : 0;
    late += run.late;
    worst.late = std::max(worst.late, run.late);
    worst.path_error = std::max(worst.path_error, run.path_error);
    worst.turn_error = std::max(worst.turn_error, run.turn_error);
    worst.limit_excess = std::max(worst.limit_excess, run.limit_excess);
    worst.invalid = worst.invalid || run.invalid;
  }
  void expect_exact() const { expect_within(kMillimetre, kFifthDegree); }
  void expect_within(double path_error, double turn_error) const {
    EXPECT_LT(worst.path_error, path_error);
    EXPECT_LT(worst.turn_error, turn_error);
    EXPECT_LE(worst.limit_excess, 1e-9);
    EXPECT_FALSE(worst.invalid);
    std::printf("%d runs, %d arrived, path error %.4f mm, rotation %.4f mrad, time over ideal: mean %.4f, worst %.3f\n",
                runs, arrived, 1e3 * worst.path_error, 1e3 * worst.turn_error, late / runs, worst.late);
  }
};

TEST(WholeBodyPaths, StraightLinesInEveryDirectionStayExact) {
  const RobotModel model = load_robot("heron");
  Tally tally;
  for (const double height : {0.3, 0.5, 0.7, 0.9, 1.1, 1.3, 1.5}) {
    JointVector q;
    ASSERT_TRUE(find_posture(model, height, q)) << height;
    for (int degrees = 0; degrees <= 180; degrees += 15) {
      const double a = degrees * std::numbers::pi / 180.0;
      const HandPath path{Vector3d(std::cos(a), std::sin(a), 0.0), Vector3d::Zero(), 0.5};
      tally.add(follow(model, {}, q, path, 0.1), path);
    }
  }
  tally.expect_exact();
  EXPECT_EQ(tally.arrived, tally.runs);  // all of these have a solution: none may be called infeasible
}

TEST(WholeBodyPaths, ArcsOfEveryRadiusStayExact) {
  const RobotModel model = load_robot("heron");
  Tally tally;
  for (const double height : {0.3, 0.5, 0.7, 0.9, 1.1, 1.3, 1.5}) {
    JointVector q;
    ASSERT_TRUE(find_posture(model, height, q)) << height;
    for (const double radius : {0.2, 0.3, 0.5, 0.8, 1.1, 1.5}) {
      for (const double sense : {-1.0, 1.0}) {
        const HandPath path{-Vector3d::UnitX(), sense / radius * Vector3d::UnitZ(), 0.5 * std::numbers::pi * radius};
        tally.add(follow(model, {}, q, path, 0.1), path);
      }
    }
  }
  tally.expect_exact();
  EXPECT_EQ(tally.arrived, tally.runs);
}

// A robot of the wheel example-robot-data; empty where the wheel is not installed.
fs::path example_urdf(const std::string& inside) {
  const fs::path library = fs::path(AJAR_SOURCE_DIR) / ".deps/venv/lib";
  if (!fs::exists(library)) return {};
  for (const auto& entry : fs::directory_iterator(library)) {
    const fs::path urdf = entry.path() / "site-packages/cmeel.prefix/share/example-robot-data/robots" / inside;
    if (fs::exists(urdf)) return urdf;
  }
  return {};
}

enum class Start { Home, Ahead };

// What is asked of the runs of one robot.
struct Demand {
  double path_error = kMillimetre;
  double turn_error = kFifthDegree;
  double arrived = 0.75;
};

void run_other_robot(const std::string& inside, const std::string& toml, Start start, double length,
                     const WbcConfig& config = test::exact_config(), const Demand& demand = {}) {
  const fs::path urdf = example_urdf(inside);
  if (urdf.empty()) {
    GTEST_SKIP() << "the wheel example-robot-data is not installed in .deps/venv";
  }
  const RobotModel model = RobotModel::load(urdf, fs::path(AJAR_SOURCE_DIR) / "tests/support" / toml);
  JointVector q = model.home();
  if (start == Start::Ahead) {
    ASSERT_TRUE(find_posture(model, 0.9, q));
  }
  Tally tally;
  for (int degrees = 0; degrees < 360; degrees += 30) {
    const double a = degrees * std::numbers::pi / 180.0;
    const Vector3d x(std::cos(a), std::sin(a), 0.0);
    for (const double k : {0.0, -2.0, 2.0}) {
      const HandPath path{x, k * Vector3d::UnitZ(), length};
      tally.add(follow(model, {}, q, path, 0.05, {}, config), path);
    }
  }
  tally.expect_within(demand.path_error, demand.turn_error);
  EXPECT_GE(tally.arrived, demand.arrived * tally.runs);
}

TEST(WholeBodyPaths, PandaOnTheFloorFollowsBySevenJointsAlone) {
  run_other_robot("panda_description/urdf/panda.urdf", "panda.toml", Start::Home, 0.15);
}

TEST(WholeBodyPaths, TiagoFollowsByBaseTorsoAndSevenJoints) {
  run_other_robot("tiago_description/robots/tiago.urdf", "tiago.toml", Start::Ahead, 0.3);
}

// Without a reserve of the arm the base comes too fast to where a joint ends: 21 mm and 85 mrad.
TEST(WholeBodyPaths, SluggishBaseBrakesBeforeTheArmIsAtItsLimits) {
  WbcConfig config = test::exact_config();
  config.base_acceleration = 0.2;
  config.base_yaw_acceleration = 0.5;
  run_other_robot("tiago_description/robots/tiago.urdf", "tiago.toml", Start::Ahead, 0.3, config,
                  {.path_error = 3.0 * kMillimetre, .turn_error = 0.01, .arrived = 1.0});
}

}  // namespace
}  // namespace ajar
