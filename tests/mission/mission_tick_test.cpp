// Strategy: a whole mission on the kinematic plant, robot and estimator as in any run; every tick of phase `open` is counted
// for requests to the heap and timed. Left out: the phases before, where planning may allocate (docs/decisions/0004).
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <vector>

#include "ajar/mechanism/builders.hpp"
#include "ajar/mission/mission.hpp"
#include "ajar/plant/kinematic_plant.hpp"
#include "allocation_guard.hpp"

namespace ajar {
namespace {

TEST(MissionTick, WhileOpeningNeverAsksTheHeap) {
  const RobotModel robot = load_robot("heron");
  PlantConfig config;
  config.kind = "kinematic";
  MechanismConfig door;
  door.radius = 0.8;
  KinematicPlant plant(robot, make_mechanism(door), config, BasePose{0.2, -1.6, 1.4}, robot.home());
  plant.reset(1);
  Mission mission(robot, MissionConfig{}, Vector3d(0.5, -0.87, 0.0).normalized(), 1);
  std::vector<double> times;
  times.reserve(60000);
  long requests = 0;
  for (int tick = 0; tick < 60000 && !mission.finished(); ++tick) {
    const RobotState state = plant.measure();
    const bool opening = mission.phase() == Phase::Open;
    const long before = test::allocations;
    const auto start = std::chrono::steady_clock::now();
    const Command command = mission.step(state);
    if (opening) {
      requests += test::allocations - before;
      times.push_back(std::chrono::duration<double, std::micro>(std::chrono::steady_clock::now() - start).count());
    }
    plant.apply(command);
    plant.advance(0.002);
  }
  ASSERT_TRUE(mission.reached_goal()) << mission.explain();
  ASSERT_GT(times.size(), 1000U);
  EXPECT_EQ(requests, 0);
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  const double median = times[times.size() / 2];
  std::printf("%zu ticks of phase open, median %.2f us\n", times.size(), median);
  EXPECT_LT(median, 100.0);  // a twentieth of a 2 ms tick even on a slow, busy machine
}

}  // namespace
}  // namespace ajar
