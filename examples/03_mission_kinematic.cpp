// A whole mission on the kinematic plant: drive up, take the handle, learn the door, open it, let go, back off.
#include <cstdio>

#include "ajar/mechanism/builders.hpp"
#include "ajar/mission/mission.hpp"
#include "ajar/plant/kinematic_plant.hpp"

using namespace ajar;

int main() {
  const RobotModel robot = load_robot("heron");

  // The world: a door with its hinges on the left. Only the plant knows it.
  MechanismConfig door;
  door.radius = 0.7;
  door.side = Side::Left;
  PlantConfig config;
  config.kind = "kinematic";
  const BasePose start{0.2, -1.6, 1.4};
  KinematicPlant plant(robot, make_mechanism(door), config, start, robot.home());
  plant.reset(1);

  // The robot: it sees the handle and guesses that things open towards it, here 30° wrong.
  MissionConfig mission_config;
  const Vector3d guess(0.5, -0.87, 0.0);
  Mission mission(robot, mission_config, guess.normalized(), 1);

  RobotState state = plant.measure();
  Phase phase = Phase::Done;
  while (!mission.finished()) {
    const Command command = mission.step(state);
    if (mission.phase() != phase) {
      phase = mission.phase();
      std::printf("%6.2f s  %s\n", state.time, to_string(phase));
    }
    plant.apply(command);
    plant.advance(mission_config.period);
    state = plant.measure();
  }
  std::printf("%s; true opening %.1f°\n", mission.explain().c_str(), 57.3 * plant.truth().opening);
  return mission.reached_goal() && plant.truth().opening > 1.45 ? 0 : 1;
}
