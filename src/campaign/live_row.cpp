#include "ajar/campaign/live_row.hpp"

#include <cmath>
#include <limits>
#include <numbers>

namespace ajar {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegrees = 180.0 / std::numbers::pi;

/// Writes values one after the other; never beyond the end.
class Writer {
 public:
  explicit Writer(std::vector<double>& values) : values_(values) {}
  void put(double value) noexcept {
    if (at_ < values_.size()) values_[at_++] = value;
  }
  void put(const Vector3d& v) noexcept {
    put(v.x());
    put(v.y());
    put(v.z());
  }

 private:
  std::vector<double>& values_;
  std::size_t at_ = 0;
};

bool has_estimate(Phase phase) { return phase == Phase::Probe || phase == Phase::Open; }

void put_truth(const Truth& truth, bool slide, Writer& out) noexcept {
  out.put(truth.base.x);
  out.put(truth.base.y);
  out.put(truth.base.yaw);
  out.put(Vector3d(truth.hand.translation()));
  out.put(truth.force);
  out.put(truth.opening);
  out.put(truth.opening * (slide ? 1.0 : kDegrees));
  const double pull = truth.direction.dot(truth.force);
  out.put((truth.force - pull * truth.direction).norm());
  out.put(pull);
  const double k = truth.curvature.norm();
  out.put(k);
  out.put(truth.opening_rate * (slide ? 1.0 : 1.0 / k));
}

void put_belief(const TickView& tick, bool slide, Writer& out) noexcept {
  const MechanismEstimate& e = tick.record.estimate;
  const bool known = has_estimate(tick.record.phase);
  const double shown = known ? 1.0 : kNothing;
  const Matrix3d R = belief_alignment(tick.record, tick.truth);
  const Vector3d direction = R * e.direction, curvature = R * e.curvature, truth = tick.truth.direction;
  out.put(shown * direction);
  out.put(shown * curvature);
  out.put(shown * kDegrees * std::atan2(direction.cross(truth).norm(), direction.dot(truth)));
  out.put(shown * 2.0 * kDegrees * e.direction_sigma);
  out.put(shown * e.curvature.norm());
  out.put(shown * 2.0 * e.curvature_sigma);
  out.put(shown * (slide ? e.arc : kDegrees * e.angle));
  out.put(slide ? kNothing : shown * 2.0 * kDegrees * e.angle_sigma);
}

void put_control(const TickView& tick, Writer& out) noexcept {
  const MissionRecord& record = tick.record;
  out.put(record.kinematics.distance);
  out.put(kDegrees * record.base.heading_error);
  out.put(record.solution.sigma_min > 0.0 ? record.solution.sigma_min : kNothing);
  out.put(tick.state.base_v);
  out.put(tick.state.base_w);
  out.put(tick.command.base_v);
  out.put(tick.command.base_w);
  out.put(record.wanted_speed);
  out.put(record.solution.speed_factor);
  out.put(record.clearance_min);
  out.put(tick.tick_us);
}

}  // namespace

LiveRow::LiveRow(JointKind kind, int joints) : slide_(kind == JointKind::Slide), joints_(joints) {
  names_ = {"time", "phase",
            // put_truth
            "base_x", "base_y", "base_yaw", "hand_x", "hand_y", "hand_z", "force_x", "force_y", "force_z", "opening_q",
            "opening", "normal_true", "pull_true", "curvature_true", "true_speed",
            // put_belief
            "est_dir_x", "est_dir_y", "est_dir_z", "est_curv_x", "est_curv_y", "est_curv_z", "direction_error",
            "direction_2sigma", "curvature_estimated", "curvature_2sigma", "opening_estimated", "opening_2sigma",
            // put_control
            "distance", "heading_error", "sigma_min", "base_v", "base_w", "cmd_v", "cmd_w", "wanted_speed", "speed_factor",
            "clearance_min", "tick_us"};
  for (const char* prefix : {"q", "dq"}) {
    for (int i = 1; i <= joints; ++i) names_.push_back(prefix + std::to_string(i));
  }
}

void LiveRow::fill(const TickView& tick, std::vector<double>& values) const noexcept {
  Writer out(values);
  out.put(tick.state.time);
  out.put(static_cast<double>(tick.record.phase));
  put_truth(tick.truth, slide_, out);
  put_belief(tick, slide_, out);
  put_control(tick, out);
  for (int i = 0; i < joints_; ++i) out.put(i < tick.state.q.size() ? tick.state.q[i] : kNothing);
  for (int i = 0; i < joints_; ++i) out.put(i < tick.command.dq.size() ? tick.command.dq[i] : kNothing);
}

std::vector<std::string> phase_names() {
  std::vector<std::string> names;
  for (int i = 0; i <= static_cast<int>(Phase::Stopped); ++i) names.emplace_back(to_string(static_cast<Phase>(i)));
  return names;
}

}  // namespace ajar
