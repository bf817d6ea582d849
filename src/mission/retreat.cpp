// The base leaves what was opened.
#include <algorithm>
#include <cmath>

#include "mission_impl.hpp"

namespace ajar {
namespace {

constexpr double kRetreatWay = 0.3;     // [m]
constexpr double kRetreatSpeed = 0.15;  // [m/s]
constexpr double kRetreatGap = 0.06;    // nearer than this to wall or leaf the base stays [m]
constexpr double kRetreatTime = 5.0;    // [s]

// Straighter away from the wall than this the base takes the hand along [cos].
constexpr double kAlongHeading = 0.5;
constexpr double kSlipping = 5e-3;  // of a hand that should stand [m/s]

}  // namespace

// A flap may come down as soon as nothing holds it: the base gathers speed before the fingers open, while the arm keeps the
// hand where it is. (docs/equations.md#way-out)
void Mission::Impl::start_run_up() noexcept {
  const double yaw = ahead.robot.base.yaw;
  const double away = Vector3d(std::cos(yaw), std::sin(yaw), 0.0).dot(opener.scene().normal());
  run_up = std::abs(away) > kAlongHeading ? std::copysign(config.wbc.base_reverse, away) : 0.0;
}

// Over once the base is as fast as it should be, or the arm cannot keep the hand where it is any longer.
bool Mission::Impl::runs_up() const noexcept {
  if (run_up == 0.0) return false;
  return time_in_phase < std::abs(run_up) / config.wbc.base_acceleration && record.solution.residual < kSlipping;
}

// Straight off, until the base can turn beside the flap that it let go. True once it can.
bool Mission::Impl::off_flap(const KeepOut& beside, const RobotState& state) noexcept {
  const double way = way_off_flap(state.base, beside);
  if (way == 0.0) return true;
  command_base({std::copysign(std::min(kRetreatSpeed, config.wbc.base_acceleration * time_in_phase), way), 0.0});
  return false;
}

void Mission::Impl::retreat(const RobotState& state) noexcept {
  look_at_result(state);
  const Vector3d to_base(state.base.x - handle.position.x(), state.base.y - handle.position.y(), 0.0);
  const Vector3d heading(std::cos(state.base.yaw), std::sin(state.base.yaw), 0.0);
  clearance.compute(model, state.base, clearances);
  // The arm rides along as it left the handle, and may be nearer to the wall than the base.
  const double gap = std::min(clearances.smallest[static_cast<std::size_t>(ClearanceKind::BaseWorld)],
                              clearances.smallest[static_cast<std::size_t>(ClearanceKind::ArmWorld)]);
  record.clearance_min = *std::min_element(clearances.smallest.begin(), clearances.smallest.end());
  if (retreat_sense == 0.0) {
    retreat_start = state.base;
    retreat_sense = heading.dot(to_base) >= 0.0 ? 1.0 : -1.0;
    last_gap = gap;
  }
  const double driven = std::hypot(state.base.x - retreat_start.x, state.base.y - retreat_start.y);
  const bool closing_in = gap < kRetreatGap && gap < last_gap;
  last_gap = gap;
  if (driven > kRetreatWay || closing_in || time_in_phase > kRetreatTime) {
    process(Event::Away);
    return;
  }
  command_base({retreat_sense * std::min(kRetreatSpeed, config.wbc.base_acceleration * time_in_phase), 0.0});
}

}  // namespace ajar
