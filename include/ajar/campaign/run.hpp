#pragma once

#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ajar/campaign/result.hpp"
#include "ajar/mechanism/mechanism.hpp"
#include "ajar/mission/mission.hpp"
#include "ajar/model/robot_model.hpp"
#include "ajar/plant/plant.hpp"
#include "ajar/scenario/scenario.hpp"

namespace ajar {

/// A plant with what it knows beyond the measurements.
struct SimulatedPlant {
  std::unique_ptr<Plant> plant;
  const Witness* witness = nullptr;  ///< Lives in `plant`
  Mechanism truth;                   ///< The mechanism as it truly is
  std::vector<std::string> notes;    ///< For the result, e.g. of a latch that is treated as free
};

/// What a plant is built from.
struct PlantRequest {
  const Scenario& scenario;  ///< Config, and the files of a mechanism given as MJCF
  const RobotModel& model;
  const Mechanism* mechanism = nullptr;                  ///< Null if the scenario gives an MJCF: the factory reads it
  std::function<BasePose(const Mechanism&)> start = {};  ///< Where the robot starts, world
  const JointVector& home;                               ///< Posture at the start, shape (n)
};

/// Builds a plant. Thread-safe; every plant stands alone. @throws ConfigError, ModelError, PlantError, IoError
using PlantFactory = std::function<SimulatedPlant(const PlantRequest&)>;

/// A glance at a run that is going on.
struct RunProgress {
  double time = 0.0;        ///< [s]
  double time_limit = 0.0;  ///< [s]
  Phase phase = Phase::Choose;
  double opening = 0.0;  ///< True [rad or m]
  double force = 0.0;    ///< Measured force at the hand [N]
  const MissionRecord* record = nullptr;
};

struct TickView;

struct RunOptions {
  std::filesystem::path folder;  ///< Run folder; empty = no files
  bool wall_clock = true;        ///< False: the result's timings stay empty, so that the same seed gives the same bytes
  bool report = true;            ///< Makes report.html
  const std::atomic<bool>* stop = nullptr;           ///< Becomes true: the robot stops safely, the run ends
  std::function<void(const TickView&)> observe;      ///< Called in every tick between decision and action; must be quick
  std::function<void(const RunProgress&)> progress;  ///< Called every `progress_period`
  double progress_period = 0.1;                      ///< [s], simulated
};

/// One mission (or one follow run, if the scenario's task says so) from start to end: builds robot and plant, injects the
/// error of the direction guess, runs the loop, judges. Nothing is written before the set-up has succeeded; the log is
/// complete to the last tick even if something throws.
/// @throws ConfigError, ModelError, PlantError, IoError
[[nodiscard]] RunResult run_mission(const Scenario& scenario, const PlantFactory& factory, const RunOptions& options = {});

/// The mechanism of a scenario that is described or stands in a table; none for an MJCF. @throws ConfigError, IoError
[[nodiscard]] std::optional<Mechanism> scenario_mechanism(const Scenario& scenario);

/// Where the robot starts: in front of the handle as the start keys say, or where the door table says. World.
[[nodiscard]] BasePose start_pose(const Scenario& scenario, const Mechanism& mechanism);

/// The true direction of motion turned by the error angle about a random axis perpendicular to it; none if the robot is told
/// nothing. This is where the error enters: the mission gets the turned direction only.
[[nodiscard]] std::optional<Vector3d> draw_direction_guess(const BeliefConfig& belief, const Vector3d& true_direction,
                                                           std::uint64_t seed);

/// A path of a scenario: relative ones start at the folder of its file.
[[nodiscard]] std::filesystem::path scenario_path(const Scenario& scenario, const std::filesystem::path& path);

/// Version of this library.
[[nodiscard]] std::string version();

}  // namespace ajar
