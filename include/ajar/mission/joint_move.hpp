#pragma once

#include <vector>

#include "ajar/core/types.hpp"

namespace ajar {

/// Follows a polyline of postures, at rest at each corner, with a trapezoidal speed profile in the largest joint.
class JointMove {
 public:
  /// @param rate          Largest joint rate [rad/s]  @param acceleration  [rad/s²]
  JointMove(double rate, double acceleration) : rate_(rate), acceleration_(acceleration) {}

  /// Set-up: takes the path; at least two postures.
  void start(std::vector<JointVector> path);

  /// Joint rates for the next tick, shape (n); zero when done. No allocation, no exception.
  [[nodiscard]] JointVector step(const JointVector& q, double dt) noexcept;

  /// True once the last posture is reached within 2 mrad.
  [[nodiscard]] bool done() const noexcept { return done_; }

 private:
  double rate_;
  double acceleration_;
  std::vector<JointVector> path_;
  std::size_t segment_ = 0;
  double travelled_ = 0.0;
  double speed_ = 0.0;
  bool done_ = true;
};

}  // namespace ajar
