#include "ajar/mission/prober.hpp"

#include <algorithm>

#include "ajar/estimation/direction_law.hpp"

namespace ajar {
namespace {

constexpr double kTorqueGive = 0.1;     // α_τ of the force law [rad/(N m s)]
constexpr double kSpringsBack = 3.0;    // a handle that pulls at the hand by more than noise moves it by itself [N]
constexpr double kArrived = 1.0;        // the measured force has arrived: noise and drift of the sensor [N]
constexpr double kHolds = 2.5;          // and the handle still holds it [N]
constexpr double kBeyond = 6.0;         // the hand aims this far beyond, or it would never quite arrive [N]
constexpr double kStiffest = 3e4;       // of arm and grasp [N/m]
constexpr double kGiven = 1e-3;         // motion beyond elasticity from which a handle gives [m]
constexpr double kDoubt = 0.25;         // or this much of elasticity, as its stiffness is not known better [-]
constexpr double kInsistence = 12.0;    // what has given is pushed harder by up to this before the next direction [N]
constexpr double kGrowth = 60.0;        // [N/s]
constexpr double kDraw = 8.0;           // at which the hand gains speed then [1/s]
constexpr double kLeastWay = 1e-4;      // a shorter way tells no stiffness [m]
constexpr double kFelt = 5.0;           // nor does a weaker force [N]
constexpr double kStill = 5e-3;         // slower than this over the dwell a handle holds [m/s]
constexpr double kTrustMotion = 0.015;  // below this the measured direction is partly elastic: mix in the force's [m]

enum class Axis { Outward, Guess, Left, Up, Right, Inward, Down };

// Each is a quarter turn from the one before, and the first from the last: the force turns without dying down.
constexpr std::array kRound = {Axis::Outward, Axis::Guess, Axis::Left, Axis::Up, Axis::Right, Axis::Inward, Axis::Down};

}  // namespace

double Prober::level() const noexcept { return config_.forces[std::min(round_, config_.forces.size() - 1)]; }

Vector3d Prober::axis() const noexcept {
  switch (kRound[turn_]) {
    case Axis::Outward: return -R_start_.col(2);
    case Axis::Guess: return guess_;
    case Axis::Left: return R_start_.col(1);
    case Axis::Up: return R_start_.col(0);
    case Axis::Right: return -R_start_.col(1);
    case Axis::Inward: return R_start_.col(2);
    case Axis::Down: break;
  }
  return -R_start_.col(0);
}

void Prober::start(const Pose& hand, const Vector3d& guess) noexcept {
  R_start_ = hand.linear();
  guess_ = guess;
  round_ = turn_ = 0;
  along_ = axis();
  strength_ = waited_ = held_ = force_ = settled_ = 0.0;
  felt_ = holds_with_ = 0.0;
  arrived_ = settling_ = false;
  count_from(hand.translation(), Vector3d::Zero());
  status_ = Status::Running;
}

void Prober::count_from(const Vector3d& hand, const Vector3d& force_now) noexcept {
  p_start_ = hand;
  f_start_ = held_force_ = force_now;
  rest_.setZero();
  drawn_.setZero();
  held_at_.setZero();
  gives_ = false;
}

void Prober::next_axis(const Vector3d& moved, const Vector3d& force_now) noexcept {
  // From hold to hold the way is long and all at rest: it tells the stiffness better than the secants on the way.
  const double way = (moved - held_at_).norm();
  if (way > kLeastWay) holds_with_ = std::max(holds_with_, std::min((force_now - held_force_).norm() / way, kStiffest));
  held_at_ = moved;
  held_force_ = force_now;
  rest_ = moved - (force_now - f_start_) / softest();
  strength_ = std::min(strength_, level());
  drawn_.setZero();
  waited_ = held_ = 0.0;
  arrived_ = false;
  do {
    if (++turn_ == kRound.size()) {
      turn_ = 0;
      ++round_;
    }
  } while (axis().squaredNorm() < 0.5);  // no guess: its turn is left out
  if (round_ == config_.forces.size()) status_ = Status::Nothing;
}

void Prober::turn_force(double dt) noexcept {
  const double step = config_.force_rate * dt;
  const Vector3d target = axis();
  along_ = turn_towards(along_, target, step / std::max(strength_, config_.forces.front()));
  // First turn, then grow: what is left of the direction before would add to it.
  if (along_ == target && strength_ < level()) strength_ = std::min(level(), strength_ + step);
}

void Prober::settle(const Vector3d& motion) noexcept {
  const double trust = std::clamp(motion.norm() / kTrustMotion, 0.0, 1.0);
  direction_ = ((1.0 - trust) * along_ + trust * motion.normalized()).normalized();
  along_ = direction_;
  settling_ = true;
}

// A force that arrives is held by the handle: on to the next direction. One that does not is followed to where it gives.
void Prober::follow(const Vector3d& moved, const Vector3d& force_now, double dt) noexcept {
  const double lack = strength_ - along_.dot(force_now);
  const double way = along_.dot(given(moved, force_now));
  const bool there = strength_ >= level() && along_ == axis();
  const bool was_there = arrived_;
  arrived_ = there && lack < (arrived_ ? kHolds : kArrived);
  if (arrived_ && !was_there) way_at_arrival_ = way;
  held_ = arrived_ ? held_ + dt : 0.0;
  waited_ = arrived_ ? 0.0 : waited_ + dt;
  const bool held = held_ > config_.dwell;
  const bool still = way - way_at_arrival_ < kStill * held_;
  gives_ = gives_ || along_.dot(moved - (force_now - f_start_) / config_.stiffness) > config_.enough;
  if (gives_) {
    if (moved.norm() > config_.reach || (held && still) || waited_ > config_.longest) {
      force_ = std::max(level(), along_.dot(force_now));
      settle(moved - (force_now - f_start_) / config_.likely_stiffness);
    }
    return;
  }
  const bool yields = !still || way > std::max(kGiven, kDoubt * force_now.norm() / softest());
  if (held && yields && strength_ < level() + kInsistence) {
    strength_ += kGrowth * dt;
  } else if (held || (there && waited_ > config_.longest)) {
    next_axis(moved, force_now);
  }
  if (lack < config_.band || waited_ > config_.longest) turn_force(dt);
}

// The hand follows its force as fast as the stiffness felt so far allows; what gives draws it along faster and faster.
Vector3d Prober::speed(const Vector3d& moved, const Vector3d& force_now, double dt) noexcept {
  const double way = (moved - rest_).norm();
  const double strength = (force_now - f_start_).norm();
  if (!gives_ && strength > kFelt && way > kLeastWay) felt_ = std::max(felt_, std::min(strength / way, kStiffest));
  const double gain = config_.stability_number / ((felt_ > 0.0 ? felt_ : kStiffest) * config_.loop_delay);
  if (settling_) {
    const double pull = along_.dot(force_now);
    const double onward = std::clamp((strength_ + kBeyond - pull) / config_.band, -0.5, 1.0);
    return 0.5 * config_.speed * onward * along_ - gain * (force_now - pull * along_);
  }
  const bool beyond = !arrived_ && along_ == axis();
  const Vector3d error = (strength_ + (beyond ? kBeyond : 0.0)) * along_ - force_now;
  const Vector3d way_given = given(moved, force_now);
  const double length = way_given.norm();
  if (arrived_ || length < kGiven) {
    drawn_.setZero();
  } else {
    drawn_ += kDraw * dt * gain * way_given * (way_given.dot(error) / (length * length));
  }
  const Vector3d v = gain * error + drawn_;
  return v * std::min(1.0, config_.speed / std::max(v.norm(), 1e-9));
}

Vector6d Prober::step(const Pose& hand, const HandWrench& wrench, double dt) noexcept {
  Vector6d twist = Vector6d::Zero();
  if (status_ != Status::Running || dt <= 0.0) return twist;
  // A leaf that is held open against its spring moves the hand: nothing is learnt before the hand moves the leaf.
  if (!settling_ && along_.dot(wrench.force) < -kSpringsBack) count_from(hand.translation(), wrench.force);
  const Vector3d moved = hand.translation() - p_start_;
  if (settling_) {
    settled_ += dt;
    settle(moved - (wrench.force - f_start_) / config_.likely_stiffness);
    if (settled_ > config_.settle_time) status_ = Status::Found;
  } else {
    follow(moved, wrench.force, dt);
  }
  if (status_ != Status::Running) return twist;
  twist.head<3>() = speed(moved, wrench.force, dt);
  twist.tail<3>() = -kTorqueGive * wrench.torque;
  return twist;
}

}  // namespace ajar
