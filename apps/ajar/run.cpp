#include "ajar/campaign/run.hpp"

#include <fmt/format.h>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "ajar/core/error.hpp"
#include "commands.hpp"
#include "exit_codes.hpp"
#include "interrupt.hpp"
#include "live.hpp"
#include "plants.hpp"
#include "progress.hpp"

namespace {

namespace fs = std::filesystem;

struct RunArguments {
  std::string scenario;
  std::vector<std::string> overrides;
  std::optional<std::uint64_t> seed;
  std::string out;
  bool quiet = false;
  bool live = false;
  double speed = 1.0;
};

/// Shows a run while it goes on, at the pace of a clock.
class LiveShow {
 public:
  LiveShow(fs::path folder, double speed, ajar::JointKind kind, int joints)
      : folder_(std::move(folder)), speed_(speed), kind_(kind), joints_(joints) {}

  void observe(const ajar::TickView& tick) {
    if (!live_) {  // the run folder with its scene is there from the first tick on
      live_.emplace(folder_, kind_, joints_);
      fmt::print(stderr, "live: {}\n", live_->address());
      start_ = std::chrono::steady_clock::now();
    }
    live_->offer(tick);
    if (speed_ <= 0.0 || !std::isfinite(tick.state.time)) return;
    const std::chrono::duration<double> due(tick.state.time / speed_);
    std::this_thread::sleep_until(start_ + std::chrono::duration_cast<std::chrono::steady_clock::duration>(due));
  }
  void finish() {
    if (live_) live_->finish();
  }

 private:
  fs::path folder_;
  double speed_;
  ajar::JointKind kind_;
  int joints_;
  std::optional<LiveRun> live_;
  std::chrono::steady_clock::time_point start_;
};

/// runs/NAME-1, or the first number that is free.
fs::path free_folder(const fs::path& scenario) {
  for (int i = 1;; ++i) {
    const fs::path folder = fs::path("runs") / fmt::format("{}-{}", scenario.stem().string(), i);
    if (!fs::exists(folder)) return folder;
  }
}

void print_figure(const std::string& name, const std::optional<double>& value, double scale, const std::string& unit) {
  if (value) fmt::print("{:<24}{:.4g} {}\n", name, *value * scale, unit);
}

void print_result(const ajar::RunResult& r, const fs::path& folder) {
  const double degree = 180.0 / std::numbers::pi;
  const bool hinge = r.mechanism_type_true == "hinge";
  fmt::print("{:<24}{} ({} in phase {})\n", "outcome", r.outcome, r.reason, r.phase);
  if (!r.explanation.empty()) fmt::print("{:<24}{}\n", "", r.explanation);
  fmt::print("{:<24}{}, the robot says {}\n", "mechanism", r.mechanism_type_true, r.mechanism_type_estimated);
  print_figure("opening", r.opening, hinge ? degree : 1.0, hinge ? "°" : "m");
  print_figure("of what was wanted", r.opening_fraction, 100.0, "%");
  print_figure("duration", r.duration, 1.0, "s");
  print_figure("opening took", r.open_duration, 1.0, "s");
  print_figure("peak normal force", r.peak_normal_force, 1.0, "N");
  print_figure("mean normal force", r.mean_normal_force, 1.0, "N");
  print_figure("peak pull force", r.peak_pull_force, 1.0, "N");
  print_figure("direction error at end", r.direction_error_final, degree, "°");
  print_figure("curvature error", r.curvature_error_final, 1.0, "1/m");
  fmt::print("{:<24}{}\n", "unwanted contacts", r.unwanted_contacts.size());
  print_figure("speed", r.real_time_factor, 1.0, "x real time");
  for (const std::string& note : r.notes) fmt::print("{:<24}{}\n", "note", note);
  fmt::print("{:<24}{}\n", "report", (folder / "report.html").string());
}

int run(const RunArguments& arguments) {
  ajar::Scenario scenario = ajar::load_scenario(arguments.scenario, arguments.overrides);
  if (arguments.seed) scenario.seed = *arguments.seed;
  check_beginning(scenario, ajar::load_robot(scenario.robot));

  ajar::RunOptions options;
  options.folder = arguments.out.empty() ? free_folder(scenario.file) : fs::path(arguments.out);
  options.stop = &interrupted();
  std::unique_ptr<RunTicker> ticker;
  std::unique_ptr<LiveShow> show;
  const ajar::PlantFactory factory = [&](const ajar::PlantRequest& request) {
    ajar::SimulatedPlant made = make_plant(request);
    if (!arguments.quiet) ticker = std::make_unique<RunTicker>(made.truth.kind);
    if (arguments.live) {
      show = std::make_unique<LiveShow>(options.folder, arguments.speed, made.truth.kind, request.model.joints());
    }
    return made;
  };
  if (arguments.live) options.observe = [&](const ajar::TickView& tick) { show->observe(tick); };
  options.progress = [&](const ajar::RunProgress& progress) {
    if (ticker) ticker->tell(progress);
  };
  const ajar::RunResult result = ajar::run_mission(scenario, factory, options);
  if (ticker) ticker->finish();
  print_result(result, options.folder);
  if (show) show->finish();
  return result.exit_code();
}

}  // namespace

void add_run(CLI::App& program, int& exit_code) {
  CLI::App* const command = program.add_subcommand("run", "One mission; writes a run folder");
  const auto arguments = std::make_shared<RunArguments>();
  command->add_option("SCENARIO", arguments->scenario, "Scenario file (TOML)")->required();
  command->add_option("--set", arguments->overrides, "KEY=VALUE: any key of the scenario; may stand several times")
      ->allow_extra_args(false);
  command->add_option("--seed", arguments->seed, "Seed instead of the scenario's");
  command->add_option("--out", arguments->out, "Run folder; default runs/SCENARIO-NUMBER");
  CLI::Option* const live = command->add_flag("--live", arguments->live, "Shows the run in a browser while it goes on");
  command->add_option("--speed", arguments->speed, "With --live: times real time; 0 = as fast as it goes; default 1")
      ->check(CLI::Range(0.0, 1000.0))
      ->needs(live);
  command->add_flag("--quiet", arguments->quiet, "No progress on standard error");
  command->callback([arguments, &exit_code] { exit_code = run(*arguments); });
}
