#include "ajar/plant/grasp_coupling.hpp"

#include <algorithm>
#include <cmath>

#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

// Longest step of the mechanism [s]: the implicit step damps an oscillation of frequency w by w dt / 2, which is 2 % for
// the stiffest usual pair (3e4 N/m on 1.2 kg).
constexpr double kLongestStep = 2.5e-4;
// Creep of a grip that is overloaded by the whole way from slip to break force [m/s]; of the order of the speed at which
// handles are pulled, so that a hand that goes on regardless reaches the break force.
constexpr double kCreepSpeed = 0.05;
// Fingers of a parallel gripper are 2-3 cm wide; beyond that creep they are off a short handle [m].
constexpr double kFingerWidth = 0.025;

}  // namespace

// The hand at one instant; the rotation vector is that of the grip's spring, which is small.
struct GraspCoupling::Hand {
  Vector3d position;
  Vector3d velocity;
  Vector3d angular_velocity;
  Matrix3d rotation;
};

// What acts on the mechanism over one step as a function of its rate after it: force - resistance dq.
struct GraspCoupling::Drive {
  double force = 0.0;
  double resistance = 0.0;
};

GraspCoupling::GraspCoupling(const Mechanism& mechanism, const GraspConfig& config)
    : mechanism_(mechanism),
      config_(config),
      mass_(mechanism.inertia + mechanism.armature),
      // The same decay time as the translation's.
      rotational_damping_(config.damping * config.rotational_stiffness / config.stiffness) {}

void GraspCoupling::take(const Pose& X_WE, double q) noexcept {
  const Pose back = leaf_motion(mechanism_, q).inverse();
  anchor_ = back * X_WE.translation();
  rotation_ = back.linear() * X_WE.linear();
  held_ = true;
  slipped_ = 0.0;
  wrench_ = GraspWrench();
}

void GraspCoupling::let_go() noexcept {
  held_ = false;
  wrench_ = GraspWrench();
}

GraspWrench GraspCoupling::wrench_at(const Hand& hand, const MechanismState& state) const noexcept {
  const Pose motion = leaf_motion(mechanism_, state.q);
  const Vector3d p_A = motion * anchor_;
  const bool hinge = mechanism_.kind == JointKind::Hinge;
  const Vector3d turning = hinge ? Vector3d(mechanism_.axis * state.dq) : Vector3d(Vector3d::Zero());
  const Vector3d v_A = hinge ? Vector3d(turning.cross(p_A - mechanism_.point)) : Vector3d(mechanism_.axis * state.dq);
  const Vector3d theta = log_so3(hand.rotation * (motion.linear() * rotation_).transpose());
  GraspWrench out;
  out.force = config_.stiffness * (hand.position - p_A) + config_.damping * (hand.velocity - v_A);
  out.torque = config_.rotational_stiffness * theta + rotational_damping_ * (hand.angular_velocity - turning);
  if (config_.pivots && mechanism_.handle.kind == HandleKind::Bar) {
    const Vector3d bar = motion.linear() * mechanism_.handle.bar;
    out.torque -= bar * bar.dot(out.torque);
  }
  return out;
}

// The wrench at the end of the step, linear in the mechanism's rate then: f(dq) = f(0) - slope dq.
GraspCoupling::Drive GraspCoupling::drive_of(const Hand& hand, const MechanismState& state, double dt) const noexcept {
  Drive drive;
  drive.force = -resisting_force(mechanism_, state.q, 0.0);
  drive.resistance = mechanism_.viscous + dt * (mechanism_.stiffness + mechanism_.closer.stiffness);
  if (!held_) return drive;
  const GraspWrench still = wrench_at(hand, {state.q, 0.0});
  const double slope = config_.stiffness * dt + config_.damping;
  if (mechanism_.kind == JointKind::Slide) {
    drive.force += mechanism_.axis.dot(still.force);
    drive.resistance += slope;
    return drive;
  }
  const Pose motion = leaf_motion(mechanism_, state.q);
  const Vector3d t = mechanism_.axis.cross(motion * anchor_ - mechanism_.point);
  const bool free_bar = config_.pivots && mechanism_.handle.kind == HandleKind::Bar;
  const double along = free_bar ? mechanism_.axis.dot(motion.linear() * mechanism_.handle.bar) : 0.0;
  drive.force += t.dot(still.force) + mechanism_.axis.dot(still.torque);
  drive.resistance +=
      slope * t.squaredNorm() + (1.0 - along * along) * (config_.rotational_stiffness * dt + rotational_damping_);
  return drive;
}

// M (dq' - dq) / dt = force - resistance dq' - friction - stop. (docs/equations.md#grasp)
void GraspCoupling::move(const Drive& drive, double dt, MechanismState& state) const noexcept {
  double impulse = mass_ * state.dq + dt * drive.force;
  double share = mass_ + dt * drive.resistance;
  if (impulse < 0.0) share += dt * mechanism_.closer.closing_damping;
  // Stops as a critically damped contact of the stated time constant, scaled by the mass; they only push.
  const double reached = state.q + dt * impulse / share;
  if (reached < 0.0 || reached > mechanism_.travel) {
    const double beyond = state.q - (reached < 0.0 ? 0.0 : mechanism_.travel);
    const double rate = 1.0 / mechanism_.stop_time_constant;
    const double stop_impulse = -mass_ * dt * rate * rate * beyond;
    const double stop_share = mass_ * dt * (2.0 * rate + dt * rate * rate);
    const double push = stop_impulse - stop_share * (impulse + stop_impulse) / (share + stop_share);
    if ((push > 0.0) == (reached < 0.0)) {
      impulse += stop_impulse;
      share += stop_share;
    }
  }
  const bool resting = state.dq == 0.0;
  const double holding = dt * mechanism_.coulomb * (resting ? mechanism_.breakaway : 1.0);
  if (std::abs(impulse) <= holding) {
    state.dq = 0.0;
    return;
  }
  const double sliding = dt * mechanism_.coulomb;
  const double dq = (impulse - std::copysign(sliding, impulse)) / share;
  if (!std::isfinite(dq)) return;
  state.dq = dq;
  state.q += dt * dq;
}

// Above the slip force the fingers creep along the force, above the break force they are off.
void GraspCoupling::creep(const MechanismState& state, double dt) noexcept {
  const double force = wrench_.force.norm();
  if (force > config_.break_force) return let_go();
  if (force <= config_.slip_force) return;
  const double range = std::max(config_.break_force - config_.slip_force, 1.0);
  // Not further in one step than to where the spring has the slip force again.
  const double way =
      std::min(dt * kCreepSpeed * (force - config_.slip_force) / range, (force - config_.slip_force) / config_.stiffness);
  anchor_ += leaf_motion(mechanism_, state.q).linear().transpose() * (wrench_.force * (way / force));
  slipped_ += way;
  if (slipped_ > std::max(kFingerWidth, 0.5 * mechanism_.handle.length)) let_go();
}

void GraspCoupling::step(const HandStep& hand, bool locked, MechanismState& state) noexcept {
  if (!(hand.duration > 0.0) || !hand.from.matrix().allFinite() || !hand.to.matrix().allFinite()) return;
  const int count = std::max(1, static_cast<int>(std::ceil(hand.duration / kLongestStep - 1e-9)));
  const double dt = hand.duration / count;
  Hand now;
  now.velocity = (hand.to.translation() - hand.from.translation()) / hand.duration;
  const Vector3d turn = log_so3(hand.to.linear() * hand.from.linear().transpose());
  now.angular_velocity = turn / hand.duration;
  for (int i = 1; i <= count; ++i) {
    const double part = static_cast<double>(i) / count;
    now.position = hand.from.translation() + part * (hand.to.translation() - hand.from.translation());
    now.rotation = exp_so3(part * turn) * hand.from.linear();
    if (locked) {
      state.dq = 0.0;
    } else {
      move(drive_of(now, state, dt), dt, state);
    }
    if (!held_) continue;
    wrench_ = wrench_at(now, state);
    creep(state, dt);
  }
}

}  // namespace ajar
