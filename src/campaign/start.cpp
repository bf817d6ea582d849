// Where a run starts and what the robot is told: the two things that are drawn outside of robot and plant.
#include <cmath>

#include "ajar/campaign/run.hpp"
#include "ajar/core/random.hpp"
#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

/// Keeps the draw of the guess apart from the draws of plant and mission, which use the seed itself.
constexpr std::uint64_t kGuessStream = 0x6775657373ULL;

}  // namespace

std::optional<Mechanism> scenario_mechanism(const Scenario& scenario) {
  switch (scenario.mechanism.form) {
    case MechanismSource::Form::Described: return make_mechanism(scenario.mechanism.described);
    case MechanismSource::Form::Table: return load_door(scenario.mechanism.table, scenario.mechanism.id);
    case MechanismSource::Form::Mjcf: break;
  }
  return std::nullopt;
}

std::filesystem::path scenario_path(const Scenario& scenario, const std::filesystem::path& path) {
  if (path.is_absolute()) return path;
  return (std::filesystem::absolute(scenario.file).parent_path() / path).lexically_normal();
}

BasePose start_pose(const Scenario& scenario, const Mechanism& mechanism) {
  if (scenario.mechanism.form == MechanismSource::Form::Table)
    return door_approach(scenario.mechanism.table, scenario.mechanism.id);
  const StartConfig& start = scenario.start;
  const Handle& handle = mechanism.handle;
  Vector3d normal(handle.normal.x(), handle.normal.y(), 0.0);
  // A handle on a level surface has no horizontal normal; then the robot comes from -y as for a closed room.
  normal = normal.norm() > 1e-6 ? Vector3d(normal.normalized()) : Vector3d(-Vector3d::UnitY());
  const Vector3d right = (-normal).cross(Vector3d::UnitZ());
  const Vector3d place = handle.position + start.distance * normal + start.sideways * right;
  const Vector3d ahead = handle.position - place;
  return {place.x(), place.y(), wrap_angle(std::atan2(ahead.y(), ahead.x()) + start.heading_error)};
}

std::optional<Vector3d> draw_direction_guess(const BeliefConfig& belief, const Vector3d& true_direction,
                                             std::uint64_t seed) {
  if (!belief.direction_error) return std::nullopt;
  Random random(seed ^ kGuessStream);
  const Vector3d x = true_direction.normalized();
  const Vector3d b1 = any_perpendicular(x).normalized();
  const double around = random.uniform(-M_PI, M_PI);
  const Vector3d axis = std::cos(around) * b1 + std::sin(around) * x.cross(b1);
  return Vector3d(exp_so3(*belief.direction_error * axis) * x);
}

}  // namespace ajar
