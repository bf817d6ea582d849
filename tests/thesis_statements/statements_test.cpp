// Strategy: the whole reproduction is run once, as `ajar reproduce thesis` does, and every row of its table is held against
// a bound whose reason stands beside it: what the thesis states, what an independent kinematic model of its law gave (within
// about a tenth; it had a shorter tool), or what the product promises of its own controller. Errata 8, 17 and 36 are proven
// by rows of this table. One test, because all rows come from the same runs.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <memory>

#include "ajar/mujoco/mujoco_plant.hpp"
#include "ajar/plant/kinematic_plant.hpp"
#include "ajar/thesis/reproduction.hpp"

namespace ajar {
namespace {

SimulatedPlant make_plant(const PlantRequest& request) {
  const BasePose start = request.start(*request.mechanism);
  const PlantConfig& config = request.scenario.plant;
  SimulatedPlant out;
  out.truth = *request.mechanism;
  if (config.kind == "kinematic") {
    auto plant = std::make_unique<KinematicPlant>(request.model, *request.mechanism, config, start, request.home);
    out.witness = plant.get();
    out.plant = std::move(plant);
  } else {
    auto plant = std::make_unique<MujocoPlant>(request.model, *request.mechanism, config, start, request.home);
    out.witness = plant.get();
    out.plant = std::move(plant);
  }
  return out;
}

/// What a row must say: the thesis's law within a range, ours within another.
struct Bound {
  const char* figure;
  const char* statement;  // how it begins
  bool holds;
  double law_least, law_most;
  double ours_least, ours_most;
};
constexpr double kAny = 1e9;
constexpr Bound kBounds[] = {
    // 13 s stated; another model of the law needed 13.3 s. Promised of ours: 8.5 s.
    {"6.2", "The drive", true, 12.0, 14.5, 7.9, 8.5},
    {"6.2", "At first", true, 1.1, 2.0, -kAny, kAny},  // 2 s stated, 1.3 s in the other model
    {"6.3", "The heading error peaks", true, 170.0, 180.0, 0.0, 90.0},
    {"6.3", "The peak", true, 5.8, 6.8, -kAny, kAny},  // 6.5 s stated, 6.2 s in the other model
    {"6.2", "From 11 s", true, 10.0, 13.5, -kAny, kAny},
    {"6.3", "It ends", true, 0.0, 10.0, 0.0, 10.0},  // the tolerance of arrival
    {"6.4", "All", true, 6.0, 6.0, 6.0, 6.0},
    {"6.4", "The heading does not", true, 0.0, 3.0, 0.0, 3.0},
    // 20-25 mm in the other model; promised of ours: 1 mm.
    {"6.6", "The full", true, 15.0, 27.0, 0.0, 1.0},
    {"6.6", "With the integral", true, -1.5, 1.5, -2.0, 2.0},               // 0.7° in the other model; promised: 2°
    {"6.6", "Without the integral a", true, 7.5, 9.5, 0.0, 2.0},            // 8° stated, 8.8° in the other model
    {"6.6", "Without the integral the", false, 0.0, 50.0, 0.0, 20.0},       // promised: 2 cm
    {"6.6", "Without the heading task the", true, 0.10, 0.18, 0.73, 0.95},  // 0.12-0.16 m in the other model
    {"6.6", "Without the heading task j", false, 0.05, 2.0, 0.1, 4.0},
    {"6.8", "Base and hand", true, 3.0, 9.0, 0.0, 15.0},  // ours keeps off its own body in the last 0.1 s
    {"6.8", "The distance", true, 5.0, 20.0, 0.0, 5.0},
    // 0.48 and 0.59 m in the other model. Promised of ours: 2 cm from 0.75 m here, never below 0.45 m.
    {"6.9", "The distance does not converge to 0.75 m, r = 0.5", true, 0.43, 0.53, 0.73, 0.77},
    {"6.9", "The distance does not converge to 0.75 m, r = 0.4", true, 0.56, 0.65, 0.73, 0.77},
    {"6.9", "The heading has", true, 1.5, 2.6, -kAny, kAny},
    {"6.9", "The hand", true, 1.0, 20.0, 0.0, 1.0},
    {"6.10", "Hand and base", true, 0.43, 0.5, 0.45, 0.8},
    // 1.2-2.8 mm up to 45° and 40-237 mm above in the other model. Promised of ours: 1 mm for any angle.
    {"6.12", "The path", true, 0.0, 3.0, 0.0, 1.0},
    {"6.12", "Above", true, 30.0, 260.0, 0.0, 1.0},
    {"6.12", "The distance", false, 0.0, 20.0, 0.0, 20.0},
    {"6.12", "The base", true, 0.0, 2.0, 0.0, 2.0},
    {"6.11", "Type III: the error", true, 100.0, 1000.0, 0.0, 1.0},
    {"6.11", "Type III: the distance", true, 20.0, 200.0, 0.0, 20.0},
    // Promised of ours: 5 mm at 50 Hz with up to 100 ms of delay.
    {"6.14", "The task", true, 20.0, 80.0, 0.0, 5.0},
    {"6.15", "The task", false, 20.0, 100.0, 0.0, 5.0},
    {"6.16", "The task", true, 0.5, 10.0, 0.0, 5.0},
    {"6.14", "The low", false, 0.0, 3.0, 0.0, 15.0},
    {"6.15", "Type II", true, 0.02, 0.4, 0.0, 0.02},
    {"6.16", "Type III", true, 0.3, 5.0, 0.0, 30.0},
    {"6.15", "Significant", true, 20.0, 50.0, 0.0, 5.0},
    {"6.16", "Significant", false, 1.0, 20.0, 0.0, 5.0},
    {"6.17", "The direction is", true, 0.15, 0.4, 0.1, 1.2},
    {"6.17", "The direction c", true, 0.0, 2.0, 0.0, 2.0},
    {"6.17", "The curvature", true, 0.0, 0.1, 0.0, 0.05},
};

class ThesisStatements : public ::testing::Test {
 protected:
  ThesisStatements()
      : folder(std::filesystem::temp_directory_path() / ("ajar_thesis_" + std::to_string(::getpid()))),
        made(reproduce_thesis(make_plant, folder, {})) {}
  ~ThesisStatements() override { std::filesystem::remove_all(folder); }
  std::filesystem::path folder;
  Reproduction made;
};

TEST_F(ThesisStatements, AreWhatTheRunsSay) {
  EXPECT_EQ(made.statements.size(), std::size(kBounds));
  for (const Bound& bound : kBounds) {
    const ThesisStatement* row = nullptr;
    for (const ThesisStatement& s : made.statements) {
      if (s.figure == bound.figure && s.statement.rfind(bound.statement, 0) == 0) row = &s;
    }
    ASSERT_NE(row, nullptr) << bound.figure << " " << bound.statement;
    SCOPED_TRACE(row->figure + " " + row->statement);
    EXPECT_EQ(row->holds, bound.holds);
    ASSERT_TRUE(row->corrected.has_value());
    EXPECT_GE(*row->corrected, bound.law_least);
    EXPECT_LE(*row->corrected, bound.law_most);
    EXPECT_EQ(row->ours.has_value(), bound.ours_most < kAny);
    EXPECT_GE(row->ours.value_or(0.0), bound.ours_least);
    EXPECT_LE(row->ours.value_or(0.0), bound.ours_most);
    EXPECT_FALSE(row->reason.empty());
  }
  EXPECT_EQ(made.figures.size(), 15U);
  for (const Figure& figure : made.figures) {
    EXPECT_TRUE(std::filesystem::exists(folder / "figures" / (figure.name + ".svg"))) << figure.name;
  }
  for (const char* file : {"thesis.html", "thesis.json", "runs/type_1_ours/result.json", "runs/type_1_thesis/log.csv"}) {
    EXPECT_TRUE(std::filesystem::exists(folder / file)) << file;
  }
}

}  // namespace
}  // namespace ajar
