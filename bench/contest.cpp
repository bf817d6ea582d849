#include "contest.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <memory>

#include <sched.h>
#include <unistd.h>
#include <nlohmann/json.hpp>

#include "heap_count.hpp"
#include "peer_process.hpp"

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"

namespace ajar::bench {
namespace {

using Clock = std::chrono::steady_clock;

// Doors in C++ (each is the same work, so that a step's median over them is free of interruptions) and steps of a turn.
constexpr int kDoors = 21;
constexpr int kTurn = 1000;
// Python gets as many turns, shorter by the ratio of their times.
constexpr int kPeerTurn = 100;
// The first steps of a turn find cold caches: the very first is reported by itself, the others are left out.
constexpr int kColdSteps = 5;
// Within this of a limit a step counts as limited [rad/s or m/s].
constexpr double kAtLimit = 1e-6;

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return std::numeric_limits<double>::quiet_NaN();
  const auto index = std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())));
  std::nth_element(values.begin(), values.begin() + static_cast<std::ptrdiff_t>(index), values.end());
  return values[index];
}

// One contestant's closed loop and its records.
class Run {
 public:
  Run(std::string name, const PathProblem& problem, std::unique_ptr<Contestant> contestant)
      : name_(std::move(name)), problem_(problem), contestant_(std::move(contestant)), by_step_(problem.steps()) {
    for (auto& times : by_step_) times.reserve(kDoors + 1);
    hot_.reserve(static_cast<std::size_t>(kDoors + 1) * by_step_.size());
    begin();
  }

  void turn(int steps) {
    for (int i = 0; i < steps; ++i) {
      if (tick_.step >= problem_.steps()) begin();
      const double us = step();
      if (i == 0) {
        cold_.push_back(us);
      } else if (i >= kColdSteps) {
        hot_.push_back(us);
        by_step_[static_cast<std::size_t>(tick_.step)].push_back(us);
      }
      ++tick_.step;
    }
  }

  [[nodiscard]] ContestRow row() const {
    std::vector<double> work;
    for (const auto& times : by_step_) work.push_back(quantile(times, 0.5));
    const auto count = static_cast<double>(steps_);
    return {.contestant = name_,
            .problem = problem_.config().name,
            .median_us = quantile(hot_, 0.5),
            .p99_us = quantile(hot_, 0.99),
            .p999_us = quantile(hot_, 0.999),
            .work_p999_us = quantile(work, 0.999),
            .cold_us = quantile(cold_, 0.5),
            .path_error_m = path_error_,
            .rotation_error_rad = rotation_error_,
            .limit_excess = excess_,
            .limited_share = limited_ / count,
            .allocations = static_cast<double>(allocations_) / count};
  }

 private:
  void begin() {
    tick_.step = 0;
    tick_.base = problem_.start_base();
    tick_.q = problem_.start_q();
    look();
    contestant_->restart(tick_);
  }

  void look() {
    tick_.target = problem_.target(tick_.step + 1);
    tick_.wishes = problem_.wishes(tick_.step, tick_.base, tick_.q);
  }

  double step() {
    look();
    const long before = ajar_heap_count();
    const auto start = Clock::now();
    contestant_->step(tick_, u_);
    const double us = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
    allocations_ += ajar_heap_count() - before;
    follow();
    return us;
  }

  void follow() {
    tick_.q += PathProblem::kPeriod * u_.head<6>();
    tick_.base = integrate_base(tick_.base, u_[7], u_[6], PathProblem::kPeriod);
    witness_.compute(tick_.base, tick_.q, hand_);
    path_error_ = std::max(path_error_, (tick_.target.translation() - hand_.X_WE.translation()).norm());
    rotation_error_ = std::max(rotation_error_, log_so3(tick_.target.linear() * hand_.X_WE.linear().transpose()).norm());
    const double over = (u_.cwiseAbs() - problem_.limits()).maxCoeff();
    excess_ = std::max(excess_, over);
    limited_ += over > -kAtLimit ? 1.0 : 0.0;
    ++steps_;
  }

  std::string name_;
  const PathProblem& problem_;
  std::unique_ptr<Contestant> contestant_;
  RobotModel witness_{problem_.robot()};
  Kinematics hand_;
  PathTick tick_;
  InputVector u_ = InputVector::Zero(8);
  std::vector<std::vector<double>> by_step_;
  std::vector<double> hot_;
  std::vector<double> cold_;
  double path_error_ = 0.0;
  double rotation_error_ = 0.0;
  double excess_ = 0.0;
  double limited_ = 0.0;
  long allocations_ = 0;
  long steps_ = 0;
};

// Children inherit it.
void pin_to_one_core() {
  cpu_set_t allowed;
  if (sched_getaffinity(0, sizeof allowed, &allowed) != 0) return;
  for (int cpu = CPU_SETSIZE - 1; cpu >= 0; --cpu) {
    if (!CPU_ISSET(cpu, &allowed)) continue;
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(cpu, &one);
    static_cast<void>(sched_setaffinity(0, sizeof one, &one));
    return;
  }
}

double number(const nlohmann::json& json, const char* key) {
  return json.contains(key) && json[key].is_number() ? json[key].get<double>() : std::numeric_limits<double>::quiet_NaN();
}

ContestRow peer_row(const nlohmann::json& json) {
  return {.contestant = json.at("contestant"),
          .problem = json.at("problem"),
          .median_us = number(json, "median_us"),
          .p99_us = number(json, "p99_us"),
          .p999_us = number(json, "p999_us"),
          .work_p999_us = number(json, "work_p999_us"),
          .cold_us = number(json, "cold_us"),
          .path_error_m = number(json, "path_error_m"),
          .rotation_error_rad = number(json, "rotation_error_rad"),
          .limit_excess = number(json, "limit_excess"),
          .limited_share = number(json, "limited_share"),
          .allocations = number(json, "allocations")};
}

void contest(const PathProblem& problem, const std::string& python, std::vector<ContestRow>& rows) {
  std::vector<Run> runs;
  runs.reserve(2);
  runs.emplace_back("ajar", problem, make_ajar(problem));
  runs.emplace_back("kdl_wdls", problem, make_kdl(problem));
  std::unique_ptr<PeerProcess> peers;
  std::vector<std::string> names;
  if (!python.empty()) {
    peers = std::make_unique<PeerProcess>(python, problem.to_json());
    names = nlohmann::json::parse(peers->ask("list")).get<std::vector<std::string>>();
  }
  const int turns = kDoors * problem.steps() / kTurn;
  for (int turn = 0; turn <= turns; ++turn) {
    for (std::size_t i = 0; i < std::max(runs.size(), names.size()); ++i) {
      if (i < names.size()) static_cast<void>(peers->ask("run " + names[i] + " " + std::to_string(kPeerTurn)));
      if (i < runs.size()) runs[i].turn(kTurn);
    }
  }
  for (const Run& run : runs) rows.push_back(run.row());
  if (!peers) return;
  for (const auto& json : nlohmann::json::parse(peers->ask("report"))) rows.push_back(peer_row(json));
}

}  // namespace

std::vector<ContestRow> run_contest(const std::string& python) {
  pin_to_one_core();
  std::vector<ContestRow> rows;
  for (const PathProblem::Config& config : path_problems()) {
    const PathProblem problem(config);
    contest(problem, python, rows);
  }
  return rows;
}

}  // namespace ajar::bench
