#include "tick.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <limits>
#include <optional>
#include <thread>

#include <fmt/format.h>

#include "ajar/core/error.hpp"
#include "ajar/mechanism/builders.hpp"
#include "ajar/mission/mission.hpp"
#include "ajar/plant/kinematic_plant.hpp"
#include "heap_count.hpp"
#include "run_log.hpp"

namespace ajar::bench {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kPeriod = 0.002;
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
// The same door again and again: the median of a tick over them is free of interruptions by other programs.
constexpr int kDoors = 15;

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return kNone;
  const auto place = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + place, values.end());
  return values[static_cast<std::size_t>(place)];
}

/// What the ticks of phase `open` of one door took.
struct DoorTimes {
  std::vector<double> us;
  long allocations = 0;
};

class Door {
 public:
  Door() : folder_(fs::temp_directory_path() / fmt::format("ajar_bench_{}", ::getpid())) {
    config_.kind = "kinematic";
    door_.radius = 0.8;
    fs::create_directories(folder_);
  }
  ~Door() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  Door(const Door&) = delete;
  Door& operator=(const Door&) = delete;

  /// @param paced  Ticks of phase `open` begin every 2 ms of the clock
  DoorTimes open(bool paced) {
    KinematicPlant plant(robot_, make_mechanism(door_), config_, BasePose{0.2, -1.6, 1.4}, robot_.home());
    plant.reset(1);
    Mission mission(robot_, MissionConfig{}, Vector3d(0.5, -0.87, 0.0).normalized(), 1);
    RunLog log(folder_, robot_.joints());
    DoorTimes times;
    times.us.reserve(20000);
    auto next = Clock::now();
    while (!mission.finished()) {
      const RobotState state = plant.measure();
      const Truth truth = plant.truth();
      const bool opening = mission.phase() == Phase::Open;
      if (paced && opening) {
        next = times.us.empty() ? Clock::now() : next + std::chrono::microseconds(2000);
        std::this_thread::sleep_until(next);
      }
      const long before = ajar_heap_count();
      const auto start = Clock::now();
      const Command command = mission.step(state);
      log.record({state, truth, mission.record(), command, 0.0});
      const double us = std::chrono::duration<double, std::micro>(Clock::now() - start).count();
      if (opening) {
        times.us.push_back(us);
        times.allocations += ajar_heap_count() - before;
      }
      plant.apply(command);
      plant.advance(kPeriod);
    }
    if (!mission.reached_goal()) throw Error("mission: " + mission.explain());
    log.close();
    return times;
  }

 private:
  RobotModel robot_ = load_robot("heron");
  PlantConfig config_;
  MechanismConfig door_;
  fs::path folder_;
};

BenchRow row(const char* problem, const std::vector<double>& us, double allocations) {
  return {"tick",
          {.contestant = "ajar",
           .problem = problem,
           .median_us = quantile(us, 0.5),
           .p99_us = quantile(us, 0.99),
           .p999_us = quantile(us, 0.999),
           .work_p999_us = kNone,
           .cold_us = kNone,
           .path_error_m = kNone,
           .rotation_error_rad = kNone,
           .limit_excess = kNone,
           .limited_share = kNone,
           .allocations = allocations}};
}

}  // namespace

std::vector<BenchRow> run_ticks() {
  Door door;
  std::vector<double> all;
  std::vector<std::vector<double>> by_tick;
  long allocations = 0;
  for (int i = 0; i < kDoors; ++i) {
    const DoorTimes times = door.open(false);
    by_tick.resize(times.us.size());
    for (std::size_t k = 0; k < times.us.size(); ++k) by_tick[k].push_back(times.us[k]);
    all.insert(all.end(), times.us.begin(), times.us.end());
    allocations += times.allocations;
  }
  std::vector<double> work;
  work.reserve(by_tick.size());
  for (const auto& times : by_tick) work.push_back(quantile(times, 0.5));
  const DoorTimes paced = door.open(true);
  std::vector<BenchRow> rows{row("whole tick with its log row, phase open", all,
                                 static_cast<double>(allocations) / static_cast<double>(all.size())),
                             row("the same, each tick's median over 15 doors", work, kNone),
                             row("the same, paced by the clock at 500 Hz", paced.us,
                                 static_cast<double>(paced.allocations) / static_cast<double>(paced.us.size()))};
  return rows;
}

}  // namespace ajar::bench
