#include "ajar/campaign/run.hpp"

#include <chrono>
#include <cmath>
#include <fstream>

#include "ajar/campaign/judge.hpp"
#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"
#include "ajar/report/report.hpp"
#include "run_log.hpp"
#include "scene.hpp"

namespace ajar {
namespace {

using Clock = std::chrono::steady_clock;

/// A mission ends itself at its time limit; this much later [s] the loop no longer believes it.
constexpr double kOverdue = 60.0;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw IoError("cannot write '" + file.string() + "'");
}

JudgeConfig judge_config(const Scenario& scenario, const RobotModel& model, const Mechanism& mechanism) {
  JudgeConfig config;
  config.period = scenario.mission.period;
  config.time_limit = scenario.mission.limits.time + kOverdue;
  config.goal = scenario.mission.goal;
  config.kind = mechanism.kind;
  config.travel = mechanism.travel;
  config.limits = model.limits();
  config.wheel_radius = model.wheel_radius();
  config.wheel_track = model.wheel_track();
  return config;
}

/// Everything that lives as long as a run; built completely before the first file is written.
struct Run {
  const Scenario& scenario;
  const RunOptions& options;
  RobotModel model;
  SimulatedPlant simulated;
  Judge judge;
  RobotState state;
  Mission mission;
  std::unique_ptr<RunLog> log;

  Run(const Scenario& s, const PlantFactory& factory, const RunOptions& o)
      : scenario(s),
        options(o),
        model(load_robot(s.robot)),
        simulated(build(factory)),
        judge(judge_config(s, model, simulated.truth)),
        state(simulated.plant->measure()),
        mission(model, s.mission, guess(), s.seed) {}

  SimulatedPlant build(const PlantFactory& factory) const {
    const std::optional<Mechanism> mechanism = scenario_mechanism(scenario);
    const PlantRequest request{scenario, model, mechanism ? &*mechanism : nullptr,
                               [this](const Mechanism& m) { return start_pose(scenario, m); }, model.home()};
    SimulatedPlant made = factory(request);
    if (!made.plant || made.witness == nullptr)
      throw PlantError("plant." + scenario.plant.kind + ": the factory made no plant");
    made.plant->reset(scenario.seed);
    if (made.truth.latched) {
      made.notes.push_back("latch '" + (made.truth.latch.empty() ? std::string("unnamed") : made.truth.latch) +
                           "' is treated as free");
    }
    return made;
  }

  /// The guess with its injected error, in the odometry frame of the first measurement.
  std::optional<Vector3d> guess() const {
    const Truth& truth = simulated.witness->truth();
    const auto world = draw_direction_guess(scenario.belief, truth.direction, scenario.seed);
    if (!world) return std::nullopt;
    return Vector3d(Eigen::AngleAxisd(state.base.yaw - truth.base.yaw, Vector3d::UnitZ()) * *world);
  }

  void open_folder() {
    if (options.folder.empty()) return;
    std::error_code error;
    std::filesystem::create_directories(options.folder, error);
    if (error || !std::filesystem::is_directory(options.folder)) {
      throw IoError("cannot make the run folder '" + options.folder.string() + "'");
    }
    std::filesystem::remove(options.folder / "result.json", error);  // a run that breaks off must not keep an old verdict
    write_text(options.folder / "scenario.toml", to_toml(scenario));
    write_text(options.folder / "version.txt", version() + "\n");
    write_text(options.folder / "scene.json", scene_json(model, simulated.truth, scenario.mission));
    log = std::make_unique<RunLog>(options.folder, model.joints());
  }

  void tell_progress(double& next) const {
    if (!options.progress || state.time < next) return;
    next = state.time + options.progress_period;
    const MissionRecord& record = mission.record();
    options.progress({state.time, scenario.mission.limits.time, mission.phase(), simulated.witness->truth().opening,
                      record.wrench.force.norm(), &record});
  }

  /// The loop: measure, decide, look, act. @return true if the mission ended by itself
  bool loop() {
    const double overdue = scenario.mission.limits.time + kOverdue;
    double next_progress = 0.0;
    for (double time = 0.0; time < overdue; time += scenario.mission.period) {
      if (options.stop != nullptr && options.stop->load(std::memory_order_relaxed)) mission.interrupt();
      const auto before = Clock::now();
      const Command command = mission.step(state);
      const TickView tick{state, simulated.witness->truth(), mission.record(), command, 1e6 * seconds_since(before)};
      judge.observe(tick);
      if (log) log->record(tick);
      if (options.observe) options.observe(tick);
      tell_progress(next_progress);
      simulated.plant->apply(command);
      simulated.plant->advance(scenario.mission.period);
      if (mission.finished()) return true;
      state = simulated.plant->measure();
    }
    return false;
  }

  RunResult finish(bool ended, double wall_seconds) {
    RunEnd end;
    end.claimed = ended && mission.reached_goal();
    end.phase = mission.end_phase();
    end.reason = mission.reason();
    end.explanation = ended ? mission.explain() : "the mission did not end at its time limit";
    end.contacts = simulated.witness->contacts();
    end.duration = std::isfinite(state.time) ? state.time + scenario.mission.period : 0.0;
    end.wall_seconds = wall_seconds;
    RunResult result = judge.finish(end);
    result.seed = scenario.seed;
    result.version = version();
    result.notes = simulated.notes;
    if (result.reason == "claimed_but_not_open") result.notes.push_back("the robot said: " + end.explanation);
    return result;
  }
};

}  // namespace

std::string version() { return AJAR_VERSION; }

RunResult run_mission(const Scenario& scenario, const PlantFactory& factory, const RunOptions& options) {
  Run run(scenario, factory, options);
  run.open_folder();
  const auto start = Clock::now();
  const bool ended = run.loop();
  const double wall_seconds = seconds_since(start);
  const RunResult result = run.finish(ended, wall_seconds);
  if (options.folder.empty()) return result;
  run.log->close();
  write_text(options.folder / "result.json", to_json(result));
  if (options.report) write_report(options.folder);
  return result;
}

}  // namespace ajar
