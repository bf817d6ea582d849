#include "ajar/thesis/experiment.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>

#include "ajar/core/error.hpp"

namespace ajar {
namespace {

/// What turns the thesis's settings of a scenario file into those of another contestant.
std::vector<std::string> contestant_overrides(Contestant contestant) {
  switch (contestant) {
    case Contestant::Thesis: return {};
    case Contestant::Corrected:
      return {"follow.feedback=3", "control.thesis.limits=common", "control.thesis.feed_forward=true",
              "control.thesis.heading=signed", "control.thesis.constant_damping=0", "control.thesis.unit_weights=false",
              "control.thesis.w_base=10",
              // Gains inside the rule that keeps the path's curvature bounded.
              "control.navigation.law=polar", "control.navigation.k_rho=0.5", "control.navigation.k_delta=4"};
    case Contestant::Ours:
      return {"follow.feedback=3",
              "control.controller=qp",
              "control.navigation.law=graceful",
              "control.navigation.k_rho=0.5",
              "control.navigation.k_delta=4",
              "control.navigation.acceleration=0.5",
              "control.navigation.yaw_acceleration=1.0"};
  }
  return {};
}

double joint_room(const JointVector& q, const RobotLimits& limits) {
  double room = std::numeric_limits<double>::infinity();
  for (Eigen::Index i = 0; i < std::min(q.size(), limits.position_lower.size()); ++i) {
    room = std::min({room, q[i] - limits.position_lower[i], limits.position_upper[i] - q[i]});
  }
  return room;
}

ExperimentSample sample_of(const TickView& tick, const RobotLimits& limits) {
  const Truth& truth = tick.truth;
  ExperimentSample out;
  out.time = tick.state.time;
  out.base = truth.base;
  out.v = tick.command.base_v;
  out.w = tick.command.base_w;
  out.hand = truth.hand.translation();
  out.pose = truth.hand;
  out.distance = std::hypot(out.hand.x() - truth.base.x, out.hand.y() - truth.base.y);
  out.heading_error = tick.record.base.heading_error;
  out.path_error = (out.hand - truth.handle).norm();
  out.joint_rate = tick.command.dq.size() > 0 ? tick.command.dq.cwiseAbs().maxCoeff() : 0.0;
  out.joint_room = joint_room(truth.q, limits);
  out.direction = truth.direction;
  out.curvature = truth.curvature;
  return out;
}

ExperimentRun run_one(const ExperimentPlan& plan, const PlantFactory& factory, const std::filesystem::path& folder) {
  const Scenario scenario = plan_scenario(plan);
  const RobotLimits limits = load_robot(scenario.robot).limits();
  ExperimentRun out;
  out.plan = plan;
  out.period = scenario.mission.period;
  RunOptions options;
  options.wall_clock = false;
  if (plan.keep && !folder.empty()) options.folder = folder / plan.name;
  options.observe = [&](const TickView& tick) {
    if (tick.record.phase == Phase::Approach) out.approach.push_back(sample_of(tick, limits));
    if (tick.record.phase == Phase::Open) out.following.push_back(sample_of(tick, limits));
  };
  out.result = run_mission(scenario, factory, options);
  return out;
}

}  // namespace

std::filesystem::path thesis_scenarios() {
  for (const char* root : {AJAR_SCENARIOS_DIR, AJAR_SCENARIOS_INSTALL_DIR}) {
    const std::filesystem::path folder = std::filesystem::path(root) / "thesis";
    std::error_code error;
    if (std::filesystem::is_directory(folder, error)) return folder;
  }
  throw IoError(fmt::format("the thesis's scenarios are missing: looked for '{0}/thesis' and '{1}/thesis'",
                            AJAR_SCENARIOS_DIR, AJAR_SCENARIOS_INSTALL_DIR));
}

Scenario plan_scenario(const ExperimentPlan& plan) {
  std::vector<std::string> overrides = contestant_overrides(plan.contestant);
  overrides.insert(overrides.end(), plan.overrides.begin(), plan.overrides.end());
  return load_scenario(thesis_scenarios() / plan.file, overrides);
}

std::vector<ExperimentRun> run_experiments(const std::vector<ExperimentPlan>& plans, const PlantFactory& factory,
                                           const std::filesystem::path& folder, int threads) {
  std::vector<ExperimentRun> runs(plans.size());
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  const auto work = [&] {
    for (std::size_t i = next++; i < plans.size(); i = next++) {
      try {
        runs[i] = run_one(plans[i], factory, folder);
      } catch (...) {
        const std::lock_guard<std::mutex> lock(mutex);
        if (!failure) failure = std::current_exception();
        next = plans.size();
      }
    }
  };
  std::vector<std::thread> pool;
  for (int i = 1; i < threads; ++i) pool.emplace_back(work);
  work();
  for (std::thread& thread : pool) thread.join();
  if (failure) std::rethrow_exception(failure);
  return runs;
}

}  // namespace ajar
