#include "ajar/campaign/run.hpp"

#include <chrono>
#include <cmath>
#include <fstream>
#include <utility>

#include "ajar/campaign/judge.hpp"
#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"
#include "ajar/report/report.hpp"
#include "follow_setup.hpp"
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
  config.force_needed = [mechanism](double opening) { return handle_force_needed(mechanism, opening); };
  config.limits = model.limits();
  config.wheel_radius = model.wheel_radius();
  config.wheel_track = model.wheel_track();
  return config;
}

SimulatedPlant build_plant(const PlantRequest& request, const PlantFactory& factory) {
  SimulatedPlant made = factory(request);
  if (!made.plant || made.witness == nullptr)
    throw PlantError("plant." + request.scenario.plant.kind + ": the factory made no plant");
  made.plant->reset(request.scenario.seed);
  if (made.truth.latched) {
    made.notes.push_back("latch '" + (made.truth.latch.empty() ? std::string("unnamed") : made.truth.latch) +
                         "' is treated as free");
  }
  return made;
}

/// Task "open": a mission that is told a guess at most.
struct OpenTask {
  const Scenario& scenario;
  const RobotModel& model;

  SimulatedPlant plant(const PlantFactory& factory) const {
    const std::optional<Mechanism> mechanism = scenario_mechanism(scenario);
    return build_plant({scenario, model, mechanism ? &*mechanism : nullptr,
                        [this](const Mechanism& m) { return start_pose(scenario, m); }, model.home()},
                       factory);
  }
  /// The guess with its injected error, in the odometry frame of the first measurement.
  std::unique_ptr<Mission> pilot(const Truth& truth, const RobotState& state) const {
    std::optional<Vector3d> guess = draw_direction_guess(scenario.belief, truth.direction, scenario.seed);
    if (guess) guess = Eigen::AngleAxisd(state.base.yaw - truth.base.yaw, Vector3d::UnitZ()) * *guess;
    return std::make_unique<Mission>(model, scenario.mission, guess, scenario.seed);
  }
  static const Truth& see(const Truth& truth, Phase) noexcept { return truth; }
  static RunResult judged(RunResult result) { return result; }
};

/// Task "follow": a free hand that is told its path; the mechanism goes along with it.
struct FollowTask {
  const Scenario& scenario;
  const RobotModel& model;
  Mechanism mechanism;
  FollowSetup setup;
  FollowedPath followed;

  FollowTask(const Scenario& s, const RobotModel& m)
      : scenario(s),
        model(m),
        mechanism(described(s)),
        setup(make_follow_setup(s, m, mechanism)),
        followed(setup.path, mechanism) {}

  static Mechanism described(const Scenario& scenario) {
    if (auto mechanism = scenario_mechanism(scenario)) return *mechanism;
    throw ConfigError(
        scenario.file.string().append(": task = \"follow\": allowed: a mechanism that is described or in a table"));
  }
  SimulatedPlant plant(const PlantFactory& factory) const {
    const FollowConfig& follow = scenario.mission.follow;
    const BasePose start{follow.start.x(), follow.start.y(), follow.start_yaw};
    const Mechanism away = out_of_the_way(mechanism);
    SimulatedPlant made =
        build_plant({scenario, model, &away, [start](const Mechanism&) { return start; }, setup.posture}, factory);
    made.truth = mechanism;
    return made;
  }
  std::unique_ptr<Follower> pilot(const Truth&, const RobotState&) const {
    return std::make_unique<Follower>(model, scenario.mission, setup.path);
  }
  const Truth& see(const Truth& truth, Phase phase) noexcept { return followed.see(truth, phase); }
  /// What touches nothing has no force and no estimate.
  static RunResult judged(RunResult r) {
    for (auto* value : {&r.peak_normal_force, &r.peak_normal_force_free, &r.mean_normal_force, &r.late_normal_force,
                        &r.late_normal_force_peak, &r.peak_pull_force, &r.stop_force, &r.peak_torque,
                        &r.direction_error_start, &r.direction_error_10cm, &r.direction_error_20cm, &r.direction_error_final,
                        &r.direction_sigma_final, &r.curvature_error_20cm, &r.curvature_error_40cm, &r.curvature_error_final,
                        &r.curvature_sigma_final, &r.angle_error_final}) {
      value->reset();
    }
    return r;
  }
};

/// Everything that lives as long as a run; built completely before the first file is written.
template <class Task>
struct Run {
  const Scenario& scenario;
  const RunOptions& options;
  RobotModel model;
  Task task;
  SimulatedPlant simulated;
  Judge judge;
  RobotState state;
  decltype(std::declval<Task>().pilot(std::declval<Truth>(), std::declval<RobotState>())) pilot;
  std::unique_ptr<RunLog> log;

  Run(const Scenario& s, const PlantFactory& factory, const RunOptions& o)
      : scenario(s),
        options(o),
        model(load_robot(s.robot)),
        task{s, model},
        simulated(task.plant(factory)),
        judge(judge_config(s, model, simulated.truth)),
        state(simulated.plant->measure()),
        pilot(task.pilot(simulated.witness->truth(), state)) {}

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
    const MissionRecord& record = pilot->record();
    options.progress({state.time, scenario.mission.limits.time, pilot->phase(), simulated.witness->truth().opening,
                      record.wrench.force.norm(), &record});
  }

  /// The loop: measure, decide, look, act. @return true if the mission ended by itself
  bool loop() {
    const double overdue = scenario.mission.limits.time + kOverdue;
    double next_progress = 0.0;
    for (double time = 0.0; time < overdue; time += scenario.mission.period) {
      if (options.stop != nullptr && options.stop->load(std::memory_order_relaxed)) pilot->interrupt();
      const auto before = Clock::now();
      const Command command = pilot->step(state);
      const Truth& truth = task.see(simulated.witness->truth(), pilot->record().phase);
      const TickView tick{state, truth, pilot->record(), command, options.wall_clock ? 1e6 * seconds_since(before) : 0.0};
      judge.observe(tick);
      if (log) log->record(tick);
      if (options.observe) options.observe(tick);
      tell_progress(next_progress);
      simulated.plant->apply(command);
      simulated.plant->advance(scenario.mission.period);
      if (pilot->finished()) return true;
      state = simulated.plant->measure();
    }
    return false;
  }

  RunResult finish(bool ended, double wall_seconds) {
    RunEnd end;
    end.claimed = ended && pilot->reached_goal();
    end.phase = pilot->end_phase();
    end.reason = pilot->reason();
    end.explanation = ended ? pilot->explain() : "the mission did not end at its time limit";
    end.contacts = simulated.witness->contacts();
    end.duration = std::isfinite(state.time) ? state.time + scenario.mission.period : 0.0;
    end.wall_seconds = options.wall_clock ? wall_seconds : 0.0;
    RunResult result = Task::judged(judge.finish(end));
    result.seed = scenario.seed;
    result.version = version();
    result.notes = simulated.notes;
    if (result.reason == "claimed_but_not_open") result.notes.push_back("the robot said: " + end.explanation);
    return result;
  }
};

}  // namespace

std::string version() { return AJAR_VERSION; }

namespace {

template <class Task>
RunResult run_task(const Scenario& scenario, const PlantFactory& factory, const RunOptions& options) {
  Run<Task> run(scenario, factory, options);
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

}  // namespace

RunResult run_mission(const Scenario& scenario, const PlantFactory& factory, const RunOptions& options) {
  return scenario.mission.task == "follow" ? run_task<FollowTask>(scenario, factory, options)
                                           : run_task<OpenTask>(scenario, factory, options);
}

}  // namespace ajar
