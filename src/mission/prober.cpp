#include "ajar/mission/prober.hpp"

#include <algorithm>

namespace ajar {
namespace {

constexpr int kPushes = 6;
constexpr double kForceBand = 8.0;       // the push slows down over this much force below its level [N]
constexpr double kSideGive = 2e-3;       // lets the hand follow the mechanism sideways, α_f of the force law [m/(N s)]
constexpr double kTorqueGive = 0.1;      // α_τ of the force law [rad/(N m s)]
constexpr double kReturnGain = 3.0;      // [1/s]
constexpr double kReturnGive = 1e-3;     // [m/(N s)]
constexpr double kReturned = 2e-3;       // [m]
constexpr double kStill = 2e-3;          // [m/s]
constexpr double kTrustMotion = 0.03;    // below this the measured direction is partly elastic: mix in the axis [m]

// Pull first (most handles give towards the robot), then the four sides, then push.
Vector3d push_axis(const Matrix3d& R, int push) {
  switch (push) {
    case 0: return -R.col(2);
    case 1: return R.col(1);
    case 2: return -R.col(1);
    case 3: return R.col(0);
    case 4: return -R.col(0);
    default: return R.col(2);
  }
}

}  // namespace

double Prober::force() const noexcept { return config_.forces[static_cast<std::size_t>(level_)]; }

void Prober::start(const Pose& hand, int level) noexcept {
  level_ = std::clamp(level, 0, static_cast<int>(config_.forces.size()) - 1);
  R_start_ = hand.linear();
  p_start_ = p_last_ = hand.translation();
  best_ = 0.0;
  push_ = -1;
  status_ = Status::Running;
  next_push();
}

void Prober::next_push() noexcept {
  ++push_;
  returning_ = false;
  time_ = blocked_ = 0.0;
  farthest_.setZero();
  if (push_ < kPushes) return;
  if (best_ < config_.least) {
    status_ = Status::Nothing;
    return;
  }
  const double trust = std::clamp(best_ / kTrustMotion, 0.0, 1.0);
  direction_ = ((1.0 - trust) * best_axis_ + trust * best_motion_.normalized()).normalized();
  status_ = Status::Found;
}

void Prober::end_push() noexcept {
  const Vector3d axis = push_axis(R_start_, push_);
  const double gain = farthest_.dot(axis);
  if (gain > best_) {
    best_ = gain;
    best_axis_ = axis;
    best_motion_ = farthest_;
  }
  returning_ = true;
  time_ = 0.0;
  // Clear motion settles it: go on from here instead of pushing back.
  if (gain > config_.enough) {
    push_ = kPushes - 1;
    next_push();
  }
}

Vector6d Prober::step(const Pose& hand, const HandWrench& wrench, double dt) noexcept {
  Vector6d twist = Vector6d::Zero();
  if (status_ != Status::Running || dt <= 0.0) return twist;
  const Vector3d axis = push_axis(R_start_, push_);
  const Vector3d& f = wrench.force;
  const Vector3d moved = hand.translation() - p_start_;
  const double speed = (hand.translation() - p_last_).dot(axis) / dt;
  p_last_ = hand.translation();
  time_ += dt;
  twist.tail<3>() = -kTorqueGive * wrench.torque;
  if (returning_) {
    twist.head<3>() = -kReturnGain * moved - kReturnGive * f;
    if (moved.norm() < kReturned || time_ > config_.return_time) next_push();
    return twist;
  }
  const double along = axis.dot(f);
  twist.head<3>() = config_.speed * std::clamp((force() - along) / kForceBand, -0.5, 1.0) * axis -
                    kSideGive * (f - along * axis);
  const Vector3d net = moved - f / config_.stiffness;  // what elasticity cannot explain
  if (net.dot(axis) > farthest_.dot(axis)) farthest_ = net;
  blocked_ = along > force() - 0.6 * kForceBand && speed < kStill ? blocked_ + dt : 0.0;
  if (moved.norm() > config_.reach || time_ > config_.push_time || blocked_ > config_.blocked_time) end_push();
  return twist;
}

}  // namespace ajar
