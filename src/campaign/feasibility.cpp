#include "ajar/campaign/feasibility.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ajar/planning/passage.hpp"
#include "ajar/planning/roll_out.hpp"

namespace ajar {
namespace {

// Points before the handle, along its normal, that a hand on its way to it passes [m].
constexpr double kBefore[] = {0.0, 0.05, 0.10};
// From this part of the wanted travel on it counts as opened wholly.
constexpr double kWhole = 0.97;
// Radii that are tried when the given one does not pass [m].
constexpr double kRadiusStep = 0.05;
constexpr double kSmallestRadius = 0.15;
constexpr double kLargestRadius = 1.2;
// Room that roll-outs are stopped at: the stop distances of the rows and a little [m].
constexpr double kTouching = 0.005;
constexpr double kStretched = 0.02;  // of sigma: the arm has no direction left
constexpr std::uint64_t kSeed = 1;

HandleBelief known_handle(const Mechanism& mechanism) {
  const Handle& handle = mechanism.handle;
  HandleBelief belief;
  belief.position = handle.position;
  belief.normal = handle.normal;
  belief.bar = handle.kind == HandleKind::Bar ? handle.bar : Vector3d(Vector3d::Zero());
  belief.standoff = handle.standoff;
  belief.thickness = handle.thickness;
  belief.doorway = mechanism.doorway;
  return belief;
}

bool opens_away(const Mechanism& mechanism) {
  return handle_motion(mechanism, 0.0).direction.dot(mechanism.handle.normal) < -0.5;
}

bool inside(const Box& box, const Vector3d& point) {
  return ((box.pose.inverse() * point).cwiseAbs().array() < box.half_extents.array()).all();
}

// "base_link 0.12 m inside wall 1", or nothing.
std::string collision(const RobotModel& model, const std::vector<Box>& boxes, const char* name, const BasePose& start) {
  Kinematics kin;
  model.compute(start, model.home(), kin);
  ClearanceChecker checker(model, ClearanceConfig{});
  ClearanceResult found;
  for (std::size_t i = 0; i < boxes.size(); ++i) {
    checker.set_obstacle(0, boxes[i], MayTouch::Nothing);
    checker.compute(model, start, found);
    for (int r = 0; r < found.count; ++r) {
      const ClearanceRow& row = found.rows[static_cast<std::size_t>(r)];
      if (row.obstacle != 0 || row.distance >= 0.0) continue;
      return fmt::format("{} {:.2f} m inside {} {}", model.shapes()[static_cast<std::size_t>(row.shape)].link, -row.distance,
                         name, i + 1);
    }
  }
  return {};
}

struct Forecast {
  RollOutResult best;
  std::string why;  // why there is none
};

Forecast forecast(const RobotModel& model, HandleBelief belief, const FeltMechanism& felt, const MissionConfig& config) {
  belief.felt = felt;
  const GraspPlanner planner(model, config.planner, config.wbc, config.base_law, config.clearance);
  RollOut roll_out(model, config.planner, config.wbc, config.base_law, config.clearance);
  Forecast out;
  const MechanismHypothesis known = felt_hypothesis(belief, felt, config.planner);
  for (const GraspCandidate& candidate : planner.choose(belief, kSeed, &out.why)) {
    const RollOutResult result = roll_out.run(belief, known, candidate.base, candidate.grasp, -1e9);
    if (result.fraction > out.best.fraction) out.best = result;
  }
  return out;
}

std::string what_stops(const RollOutResult& result, const ClearanceConfig& limits) {
  if (result.own < limits.self.stop + kTouching)
    return fmt::format("the arm comes within {:.2f} m of the robot's own body", result.own);
  if (result.base < limits.base_world.stop + kTouching)
    return fmt::format("the base comes within {:.2f} m of wall or leaf", result.base);
  if (result.arm < limits.arm_world.stop + kTouching)
    return fmt::format("the arm comes within {:.2f} m of wall or leaf", result.arm);
  if (result.sigma < kStretched) return fmt::format("the arm has no direction left, sigma {:.3f}", result.sigma);
  return "the hand leaves its path";
}

// The way of a hinge whose radius is another one, the handle and the direction of the axis as they are.
FeltMechanism with_radius(const FeltMechanism& felt, double radius) {
  FeltMechanism out = felt;
  out.curvature = felt.curvature.normalized() / radius;
  return out;
}

}  // namespace

std::string obstruction(const RobotModel& model, const Mechanism& mechanism, const BasePose& start) {
  if (model.shapes().empty())
    return fmt::format("robot {} has no collision shapes: nothing would keep it clear", model.name());
  std::string hit = collision(model, mechanism.world, "wall", start);
  if (hit.empty()) hit = collision(model, mechanism.leaf, "leaf", start);
  if (!hit.empty()) return fmt::format("the robot starts in collision: {}", hit);
  for (std::size_t i = 0; i < mechanism.world.size(); ++i) {
    for (const double before : kBefore) {
      const Vector3d p = mechanism.handle.position + before * mechanism.handle.normal;
      if (!inside(mechanism.world[i], p)) continue;
      return fmt::format("the handle at ({:.2f}, {:.2f}, {:.2f}) m is behind wall {}: {:.2f} m before it is solid",
                         mechanism.handle.position.x(), mechanism.handle.position.y(), mechanism.handle.position.z(), i + 1,
                         before);
    }
  }
  if (!opens_away(mechanism) || !mechanism.doorway) return {};
  const HandleBelief belief = known_handle(mechanism);
  const std::optional<Passage> passage = make_passage(belief, likely_side(belief));
  if (!passage || passage_width(*passage) >= base_width(model)) return {};
  return fmt::format("the doorway is too narrow: {}", passage_room(*passage, model));
}

std::string shortfall(const RobotModel& model, const Mechanism& mechanism, const MissionConfig& config, bool bar_turns) {
  if (opens_away(mechanism) || model.base_type() == BaseType::Fixed) return {};
  const HandleMotion motion = handle_motion(mechanism, 0.0);
  const HandleBelief belief = known_handle(mechanism);
  const FeltMechanism felt{motion.direction, motion.curvature, bar_turns};
  MissionConfig wanted = config;
  const bool hinge = mechanism.kind == JointKind::Hinge;
  const GoalConfig& goal = config.goal;
  const double asked = goal.to_the_stop ? mechanism.travel : (hinge ? goal.opening_angle : goal.opening_length);
  const double way = std::min(asked, mechanism.travel);
  (hinge ? wanted.planner.hinge_angle : wanted.planner.drawer_travel) = way;
  if (!hinge) wanted.planner.sliding_travel = way;
  const Forecast given = forecast(model, belief, felt, wanted);
  if (given.best.fraction >= kWhole) return {};
  if (!given.why.empty()) return given.why;
  const std::string stop =
      fmt::format("at {:.0f} % of the way {}", 100.0 * given.best.fraction, what_stops(given.best, config.clearance));
  if (!hinge) return fmt::format("no posture opens it wholly: {}", stop);
  const double r = 1.0 / felt.curvature.norm();
  for (double step = kRadiusStep; step < kLargestRadius; step += kRadiusStep) {
    for (const double other : {r - step, r + step}) {
      if (other < kSmallestRadius || other > kLargestRadius) continue;
      if (forecast(model, belief, with_radius(felt, other), wanted).best.fraction < kWhole) continue;
      return fmt::format("no posture passes r {} {:.2f} m at {:.2f} m height, and it is {:.2f} m: {}", other < r ? ">" : "<",
                         other, belief.position.z(), r, stop);
    }
  }
  return fmt::format("no posture opens a hinge of any radius at {:.2f} m height: {}", belief.position.z(), stop);
}

}  // namespace ajar
