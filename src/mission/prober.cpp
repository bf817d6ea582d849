#include "ajar/mission/prober.hpp"

#include <algorithm>

namespace ajar {
namespace {

constexpr double kForceBand = 8.0;      // the push slows down over this much force below its level [N]
constexpr double kSideGive = 2e-3;      // lets the hand follow the mechanism sideways, α_f of the force law [m/(N s)]
constexpr double kTorqueGive = 0.1;     // α_τ of the force law [rad/(N m s)]
constexpr double kReturnGain = 3.0;     // [1/s]
constexpr double kReturnGive = 1e-3;    // [m/(N s)]
constexpr double kReturned = 2e-3;      // [m]
constexpr double kStill = 2e-3;         // [m/s]
constexpr double kLongestPush = 3.0;    // over the usual time [-]
constexpr double kSpeedFilter = 0.03;   // encoder steps between two ticks are no motion [s]
constexpr double kSpringsBack = 3.0;    // a handle that pulls at the hand by more than noise moves it by itself [N]
constexpr double kSettleTime = 0.3;     // three times as long as the sideways force of a push needs to go [s]
constexpr double kTrustMotion = 0.015;  // below this the measured direction is partly elastic: mix in the axis [m]

enum class Axis { Outward, Guess, Left, Right, Up, Down, Inward };

struct Push {
  Axis axis;
  int level;
};

// Most handles give along the normal or where they are said to: these two lead, one force level ahead of the sides.
constexpr std::array kPushes = {
    Push{Axis::Outward, 0}, Push{Axis::Guess, 0},   Push{Axis::Outward, 1}, Push{Axis::Guess, 1},  //
    Push{Axis::Left, 0},    Push{Axis::Right, 0},   Push{Axis::Up, 0},      Push{Axis::Down, 0},
    Push{Axis::Inward, 0},  Push{Axis::Outward, 2}, Push{Axis::Guess, 2},  //
    Push{Axis::Left, 1},    Push{Axis::Right, 1},   Push{Axis::Up, 1},      Push{Axis::Down, 1},
    Push{Axis::Inward, 1},  Push{Axis::Outward, 3}, Push{Axis::Guess, 3},  //
    Push{Axis::Left, 2},    Push{Axis::Right, 2},   Push{Axis::Up, 2},      Push{Axis::Down, 2},
    Push{Axis::Inward, 2},  Push{Axis::Inward, 3}};

const Push& push_at(int push) noexcept {
  return kPushes[static_cast<std::size_t>(std::clamp(push, 0, static_cast<int>(kPushes.size()) - 1))];
}

}  // namespace

double Prober::force() const noexcept { return config_.forces[static_cast<std::size_t>(push_at(push_).level)]; }

Vector3d Prober::axis() const noexcept {
  switch (push_at(push_).axis) {
    case Axis::Outward: return -R_start_.col(2);
    case Axis::Guess: return guess_;
    case Axis::Left: return R_start_.col(1);
    case Axis::Right: return -R_start_.col(1);
    case Axis::Up: return R_start_.col(0);
    case Axis::Down: return -R_start_.col(0);
    case Axis::Inward: break;
  }
  return R_start_.col(2);
}

void Prober::start(const Pose& hand, const Vector3d& guess) noexcept {
  R_start_ = hand.linear();
  p_start_ = p_last_ = hand.translation();
  guess_ = guess;
  push_ = -1;
  status_ = Status::Running;
  next_push();
}

void Prober::next_push() noexcept {
  do {
    ++push_;
  } while (push_ < static_cast<int>(kPushes.size()) && axis().squaredNorm() < 0.5);  // no guess: its pushes are left out
  returning_ = settling_ = false;
  time_ = blocked_ = 0.0;
  p_pulled_ = p_last_;
  farthest_.setZero();
  motion_.setZero();
  if (push_ >= static_cast<int>(kPushes.size())) status_ = Status::Nothing;
}

void Prober::settle() noexcept {
  const double trust = std::clamp(motion_.norm() / kTrustMotion, 0.0, 1.0);
  direction_ = ((1.0 - trust) * axis() + trust * motion_.normalized()).normalized();
  settling_ = true;
  time_ = 0.0;
}

void Prober::end_push() noexcept {
  if (farthest_.dot(axis()) > config_.enough) {
    settle();  // clear motion: go on from here instead of pushing back
  } else {
    returning_ = true;
    time_ = 0.0;
  }
}

// What elasticity cannot explain of the way since the handle last moved the hand instead of the hand the handle.
void Prober::watch(const Vector3d& hand, const Vector3d& force) noexcept {
  if (axis().dot(force) < -kSpringsBack) {
    p_pulled_ = hand;
    return;
  }
  const Vector3d net = hand - p_pulled_ - force / config_.stiffness;
  if (net.dot(axis()) > farthest_.dot(axis())) {
    farthest_ = net;
    motion_ = hand - p_pulled_ - force / config_.likely_stiffness;
  }
}

Vector6d Prober::step(const Pose& hand, const HandWrench& wrench, double dt) noexcept {
  Vector6d twist = Vector6d::Zero();
  if (status_ != Status::Running || dt <= 0.0) return twist;
  const Vector3d along = settling_ ? direction_ : axis();
  const Vector3d& f = wrench.force;
  const Vector3d moved = hand.translation() - p_start_;
  const double speed = (hand.translation() - p_last_).dot(along) / dt;
  p_last_ = hand.translation();
  time_ += dt;
  twist.tail<3>() = -kTorqueGive * wrench.torque;
  if (returning_) {
    twist.head<3>() = -kReturnGain * moved - kReturnGive * f;
    if (moved.norm() < kReturned || time_ > config_.return_time) next_push();
    return twist;
  }
  const double pull = along.dot(f);
  twist.head<3>() =
      config_.speed * std::clamp((force() - pull) / kForceBand, -0.5, 1.0) * along - kSideGive * (f - pull * along);
  if (settling_) {
    if (time_ > kSettleTime) status_ = Status::Found;
    return twist;
  }
  watch(hand.translation(), f);
  filtered_speed_ += std::min(1.0, dt / kSpeedFilter) * (speed - filtered_speed_);
  blocked_ = pull > force() - 0.6 * kForceBand && filtered_speed_ < kStill ? blocked_ + dt : 0.0;
  // A handle that moves may finish its way, however slowly it gives.
  const bool too_long =
      time_ > config_.push_time && (filtered_speed_ < 2.0 * kStill || time_ > kLongestPush * config_.push_time);
  if (moved.norm() > config_.reach || too_long || blocked_ > config_.blocked_time) end_push();
  return twist;
}

}  // namespace ajar
