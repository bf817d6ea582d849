#include "plants.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "ajar/campaign/feasibility.hpp"
#include "ajar/core/error.hpp"
#include "ajar/core/random.hpp"
#include "ajar/mujoco/mujoco_plant.hpp"
#include "ajar/planning/grasp_planner.hpp"
#include "ajar/plant/kinematic_plant.hpp"

namespace {

using ajar::Mechanism;
using ajar::PlantRequest;
using ajar::SimulatedPlant;

template <class SomePlant>
SimulatedPlant hold(std::unique_ptr<SomePlant> plant, Mechanism truth) {
  const ajar::Witness* const witness = plant.get();
  return {std::move(plant), witness, std::move(truth), {}};
}

SimulatedPlant make_described(const PlantRequest& request) {
  const Mechanism& mechanism = *request.mechanism;
  const ajar::PlantConfig& config = request.scenario.plant;
  const ajar::BasePose start = request.start(mechanism);
  if (config.kind == "kinematic") {
    return hold(std::make_unique<ajar::KinematicPlant>(request.model, mechanism, config, start, request.home), mechanism);
  }
  return hold(std::make_unique<ajar::MujocoPlant>(request.model, mechanism, config, start, request.home), mechanism);
}

ajar::MjcfWorld world_of(const ajar::MechanismSource& source) {
  ajar::MjcfWorld world;
  world.path = source.mjcf;
  world.joint = source.joint;
  world.handle_site = source.handle_site;
  return world;
}

/// The mechanism as it truly is, wherever the scenario has it from.
Mechanism true_mechanism(const ajar::Scenario& scenario) {
  if (const auto mechanism = ajar::scenario_mechanism(scenario)) return *mechanism;
  return ajar::load_mjcf_mechanism(world_of(scenario.mechanism));
}

SimulatedPlant make_from_model(const PlantRequest& request) {
  const ajar::MjcfWorld world = world_of(request.scenario.mechanism);
  const Mechanism mechanism = ajar::load_mjcf_mechanism(world);
  const ajar::PlantConfig& config = request.scenario.plant;
  const ajar::BasePose start = request.start(mechanism);
  if (config.kind == "kinematic") {
    return hold(std::make_unique<ajar::KinematicPlant>(request.model, mechanism, config, start, request.home), mechanism);
  }
  return hold(std::make_unique<ajar::MujocoPlant>(request.model, world, config, start, request.home), mechanism);
}

/// Some base pose nearby and some posture bring the hand to the handle at that height.
bool reaches(const ajar::RobotModel& model, ajar::HandleBelief handle, double height, ajar::Random& random) {
  // Coarser than the planner on purpose: what fails here fails there.
  constexpr int kTries = 600;
  handle.position.z() = height;
  const ajar::JointVector& lower = model.limits().position_lower;
  const ajar::JointVector& upper = model.limits().position_upper;
  const double forward = std::atan2(-handle.normal.y(), -handle.normal.x());
  for (int i = 0; i < kTries; ++i) {
    const double distance = random.uniform(0.4, 1.1);
    const double azimuth = forward + random.uniform(-0.6, 0.6);
    ajar::BasePose base;
    base.x = handle.position.x() - distance * std::cos(azimuth);
    base.y = handle.position.y() - distance * std::sin(azimuth);
    base.yaw = random.uniform(-M_PI, M_PI);
    ajar::JointVector q = model.home();
    for (Eigen::Index j = 0; j < q.size(); ++j) {
      if (i > 0) q[j] = random.uniform(std::max(lower[j], -M_PI), std::min(upper[j], M_PI));
    }
    ajar::Pose hand = ajar::Pose::Identity();
    hand.linear() = ajar::grasp_orientation(handle, i % 2 == 1);
    hand.translation() = handle.position;
    if (model.solve_ik(base, hand, q)) return true;
  }
  return false;
}

}  // namespace

SimulatedPlant make_plant(const PlantRequest& request) {
  return request.mechanism != nullptr ? make_described(request) : make_from_model(request);
}

namespace {

void check_reach(const ajar::Scenario& scenario, const ajar::RobotModel& model) {
  if (scenario.mechanism.form != ajar::MechanismSource::Form::Described) return;
  const ajar::Handle handle = ajar::make_mechanism(scenario.mechanism.described).handle;
  const ajar::HandleBelief belief{
      handle.position, handle.normal, handle.bar, handle.standoff, handle.thickness, {}, {}, {}, {}};
  ajar::Random random(1);
  if (reaches(model, belief, handle.position.z(), random)) return;
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -lowest;
  for (double height = 0.0; height < 2.55; height += 0.1) {
    if (!reaches(model, belief, height, random)) continue;
    lowest = std::min(lowest, height);
    highest = std::max(highest, height);
  }
  throw ajar::ConfigError(
      fmt::format("{}: mechanism.handle_height_m = {}: allowed: what robot {} reaches, about {:.1f} … {:.1f} m",
                  scenario.file.string(), handle.position.z(), model.name(), lowest, highest));
}

}  // namespace

void check_beginning(const ajar::Scenario& scenario, const ajar::RobotModel& model) {
  check_reach(scenario, model);
  if (scenario.mission.task != "open") return;  // a free hand follows a told path, the mechanism is out of the way
  const Mechanism mechanism = true_mechanism(scenario);
  const std::string why = ajar::obstruction(model, mechanism, ajar::start_pose(scenario, mechanism));
  if (!why.empty()) throw ajar::ConfigError(fmt::format("{}: {}", scenario.file.string(), why));
}

std::string check_scenario(const ajar::Scenario& scenario) {
  const ajar::RobotModel model = ajar::load_robot(scenario.robot);
  check_beginning(scenario, model);
  const auto mechanism = ajar::scenario_mechanism(scenario);
  const PlantRequest request{scenario, model, mechanism ? &*mechanism : nullptr,
                             [&](const Mechanism& m) { return ajar::start_pose(scenario, m); }, model.home()};
  SimulatedPlant made = make_plant(request);
  made.plant->reset(scenario.seed);
  if (scenario.mission.task != "open") return {};
  return ajar::shortfall(model, true_mechanism(scenario), scenario.mission, scenario.plant.grasp.pivots);
}
