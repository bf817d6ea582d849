#include "ajar/mission/joint_move.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace ajar {
namespace {

// Feedback that removes what the servo lag leaves; 4 1/s is a quarter of the slowest servo's bandwidth.
constexpr double kFeedback = 4.0;
// Encoders resolve 1e-5 rad; the servo settles well below this.
constexpr double kArrived = 2e-3;

}  // namespace

void JointMove::start(std::vector<JointVector> path) {
  path_ = std::move(path);
  segment_ = 0;
  travelled_ = 0.0;
  speed_ = 0.0;
  done_ = path_.size() < 2;
}

JointVector JointMove::step(const JointVector& q, double dt) noexcept {
  JointVector rates = JointVector::Zero(q.size());
  if (done_) return rates;
  const JointVector& from = path_[segment_];
  const JointVector& to = path_[segment_ + 1];
  const double length = (to - from).cwiseAbs().maxCoeff();
  const double left = std::max(0.0, length - travelled_);
  // Fastest speed that still brakes within the rest when this tick has been driven: v T + v²/(2 a) = left.
  const double braking = acceleration_ * (std::sqrt(dt * dt + 2.0 * left / acceleration_) - dt);
  speed_ = std::min({speed_ + acceleration_ * dt, rate_, braking, left / dt});
  travelled_ = std::min(length, travelled_ + speed_ * dt);
  const double share = length > 1e-9 ? travelled_ / length : 1.0;
  const JointVector wanted = from + (to - from) * share;
  if (length > 1e-9) rates = (to - from) * (speed_ / length);
  const JointVector error = wanted - q;
  rates += kFeedback * error;
  const double largest = rates.cwiseAbs().maxCoeff();
  if (largest > 1.2 * rate_) rates *= 1.2 * rate_ / largest;
  if (share >= 1.0 && (to - q).cwiseAbs().maxCoeff() < kArrived) {
    speed_ = 0.0;
    travelled_ = 0.0;
    if (++segment_ + 1 >= path_.size()) {
      done_ = true;
      rates.setZero();
    }
  }
  return rates;
}

}  // namespace ajar
