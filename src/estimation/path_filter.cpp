#include "ajar/estimation/path_filter.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <span>
#include <string>

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"

namespace ajar {
namespace {

// Tails of 1e-4 of χ² with 2 and 5 degrees of freedom, for one bin and for the sum over eight bins.
constexpr double kBinLimit[2] = {18.4, 25.7};
constexpr double kWindowLimit[2] = {52.0, 96.0};
// Tail of 1e-4 of χ² with 4 degrees of freedom: a fresh fit disagrees in direction or curvature.
constexpr double kVerifyLimit = 23.5;
// Tighter than any door (r 0.15 m): a handle turned, and what comes after it is another mechanism [1/m].
constexpr double kHandleCurvature = 6.7;
constexpr double kRestartTurn = 0.6;  // a fresh fit this far off replaces the estimate at once (35°) [rad]
constexpr int kStartBins = 4;         // least bins of the first fit
constexpr int kVerifyBins = 5;        // least bins of a fresh fit after an alarm
constexpr int kOutliersInRow = 3;     // the third outlying bin in a row is an alarm
constexpr int kRejectedInRow = 3;     // at most so many samples are left out in a row
constexpr double kRestSigma = 5.0;    // bins are at least so many standard deviations of what closes them
// Bins are at least so many standard deviations of the base's drift within them: steps along the path are taken for exact.
constexpr double kDriftSigma = 4.0;
constexpr double kRejectSigma = 6.0;  // a sample further off the curve is left out
constexpr double kNoisePrior = 20.0;  // ν0: rows of prior data that say "the stated noise is right"
constexpr double kNoiseFloor = 0.1;   // least noise scale
constexpr double kNoiseCap = 9.0;     // NIS per row beyond which a bin says nothing about the noise
constexpr int kScaleSettled = 6;      // bins before one prediction error can alarm while the scale is learnt
constexpr int kWindowSettled = 16;    // bins before the slow sum can alarm while the scale is learnt
// What an alarm re-opens: a slip of 3 cm and 0.3 rad; a slip by δ turns x by 1.5 δ k and bends k by 1.5 δ k² (δ = 1 cm).
constexpr double kSlipOffset = 0.03;
constexpr double kSlipTurn = 0.3;
constexpr double kSlipDirection = 0.05;
constexpr double kSlipBend = 0.05;
constexpr double kSlipLever = 0.015;
constexpr double kSlipSlope = 1.0;  // and it may go on at 45 degrees until a fresh fit agrees

std::size_t row_class(int rows) { return rows == 2 ? 0 : 1; }

void require(bool good, const char* field, const char* range) {
  if (!good) throw ConfigError(std::string("path filter: ") + field + " must be " + range);
}

bool positive(double value) { return std::isfinite(value) && value > 0.0; }
bool not_negative(double value) { return std::isfinite(value) && value >= 0.0; }

}  // namespace

void PathFilterConfig::validate() const {
  require(positive(noise.position_white), "noise.position_white", "> 0 m");
  require(not_negative(noise.position_correlated), "noise.position_correlated", ">= 0 m");
  require(!use_rotation || positive(noise.rotation_white), "noise.rotation_white", "> 0 rad");
  require(not_negative(noise.rotation_correlated), "noise.rotation_correlated", ">= 0 rad");
  require(positive(noise.correlation_length), "noise.correlation_length", "> 0 m");
  require(not_negative(noise.position_walk), "noise.position_walk", ">= 0 m^2/m");
  require(not_negative(noise.rotation_walk), "noise.rotation_walk", ">= 0 rad^2/m");
  require(positive(bin_length), "bin_length", "> 0 m");
  require(positive(start_length), "start_length", "> 0 m");
  require(positive(curvature_prior), "curvature_prior", "> 0 1/m");
  require(not_negative(curvature_walk), "curvature_walk", ">= 0 1/m^3");
}

PathFilter::PathFilter(const PathFilterConfig& config) : config_(config) {
  config.validate();
  // As few samples as keep a rest from opening bins: their mean's noise is then kRestSigma times smaller than a bin.
  const double ratio = kRestSigma * config.noise.position_white / bin_length();
  recent_needed_ = std::clamp(static_cast<int>(std::ceil(ratio * ratio)), 1, kRecent);
  reset();
}

void PathFilter::reset() noexcept {
  state_ = PathState();
  current_ = OpenBin();
  started_ = verifying_ = alarm_again_ = false;
  recent_count_ = rejected_ = bin_count_ = previous_count_ = steps_ = window_count_ = pending_ = alarms_ = disagreements_ =
      0;
  noise_scale_ = 1.0;
  noise_sum_ = noise_rows_ = kNoisePrior;
  last_ = PathCorrection();
}

PathEvent PathFilter::add(const PathSample& sample) noexcept {
  if (!sample.position.allFinite() || !sample.rotation.allFinite() || !std::isfinite(sample.base_travel) ||
      !std::isfinite(sample.extra_sigma)) {
    return PathEvent::Invalid;
  }
  if (!current_.open) {
    open_bin(sample);
    return PathEvent::None;
  }
  if (started_ && config_.alarms && far_off(sample)) {
    if (++rejected_ <= kRejectedInRow) {
      current_.bin.base_travel += std::abs(sample.base_travel);
      return PathEvent::Rejected;
    }
  } else {
    rejected_ = 0;
  }
  if (!left_bin(sample.position)) {
    join_bin(sample);
    return PathEvent::None;
  }
  const PathBin bin = closed_bin();
  open_bin(sample);
  const PathEvent event = take_bin(bin);
  if (previous_count_ == 2) previous_[0] = previous_[1];
  previous_count_ = std::min(previous_count_ + 1, 2);
  previous_[static_cast<std::size_t>(previous_count_ - 1)] = bin;
  return event;
}

void PathFilter::open_bin(const PathSample& sample) noexcept {
  current_.bin = {1.0, sample.position, sample.rotation, std::abs(sample.base_travel), std::abs(sample.extra_sigma)};
  current_.turn.setZero();
  current_.reference = sample.rotation;
  current_.open = true;
}

void PathFilter::join_bin(const PathSample& sample) noexcept {
  PathBin& bin = current_.bin;
  bin.count += 1.0;
  bin.position += (sample.position - bin.position) / bin.count;
  if (config_.use_rotation) {
    current_.turn += (log_so3(sample.rotation * current_.reference.transpose()) - current_.turn) / bin.count;
  }
  bin.base_travel += std::abs(sample.base_travel);
  bin.extra_sigma += (std::abs(sample.extra_sigma) - bin.extra_sigma) / bin.count;
}

PathBin PathFilter::closed_bin() const noexcept {
  PathBin bin = current_.bin;
  if (config_.use_rotation) bin.rotation = exp_so3(current_.turn) * current_.reference;
  return bin;
}

bool PathFilter::left_bin(const Vector3d& position) noexcept {
  // The mean of the last samples must have left the bin's mean: noise at rest opens no bins.
  const auto needed = static_cast<std::size_t>(recent_needed_);
  if (recent_count_ == recent_needed_) std::rotate(recent_.begin(), recent_.begin() + 1, recent_.begin() + recent_needed_);
  recent_count_ = std::min(recent_count_ + 1, recent_needed_);
  recent_[static_cast<std::size_t>(recent_count_ - 1)] = position;
  if (recent_count_ < recent_needed_) return false;
  Vector3d mean = Vector3d::Zero();
  for (std::size_t i = 0; i < needed; ++i) mean += recent_[i] / static_cast<double>(recent_needed_);
  const double drift = kDriftSigma * std::sqrt(config_.noise.position_walk * current_.bin.base_travel);
  return (mean - current_.bin.position).norm() > std::max(bin_length(), drift);
}

bool PathFilter::far_off(const PathSample& sample) const noexcept {
  const PoseNoise& n = config_.noise;
  const Vector3d v = state_.F.transpose() * (sample.position - state_.p);
  const Vector3d e = v - curve_at(state_.kap, v.x()).q;
  const double variance = n.position_white * n.position_white + n.position_correlated * n.position_correlated +
                          sample.extra_sigma * sample.extra_sigma + n.position_walk * current_.bin.base_travel +
                          state_.P(0, 0) + state_.P(1, 1);
  const double limit2 = kRejectSigma * kRejectSigma * noise_scale_ * variance;
  return (e.tail<2>() - state_.error.head<2>()).squaredNorm() > limit2;
}

double PathFilter::bin_length() const noexcept { return std::max(config_.bin_length, 3.0 * config_.noise.position_white); }

double PathFilter::start_length() const noexcept {
  return std::max(config_.start_length, 6.0 * std::hypot(config_.noise.position_white, config_.noise.position_correlated));
}

void PathFilter::push_bin(const PathBin& bin) noexcept {
  if (bin_count_ == kMaxFitBins) {
    std::rotate(bins_.begin(), bins_.begin() + 1, bins_.end());
    --bin_count_;
  }
  bins_[static_cast<std::size_t>(bin_count_++)] = bin;
}

PathEvent PathFilter::take_bin(const PathBin& bin) noexcept {
  if (!started_) return try_start(bin);
  const PathEvent event = step(bin);
  if (!verifying_) return event;
  const PathEvent verified = verify(bin);
  return verified == PathEvent::Restarted ? verified : event;
}

PathEvent PathFilter::try_start(const PathBin& bin) noexcept {
  push_bin(bin);
  if (bin_count_ < kStartBins || (bin.position - bins_.front().position).norm() < start_length())
    return PathEvent::BinClosed;
  PathState fitted;
  const std::span<const PathBin> bins(bins_.data(), static_cast<std::size_t>(bin_count_));
  if (!fit_path(bins, {config_.noise, config_.use_rotation, config_.curvature_prior}, fitted)) return PathEvent::BinClosed;
  start_from(fitted);
  return PathEvent::Started;
}

void PathFilter::start_from(const PathState& state) noexcept {
  state_ = state;
  started_ = true;
  verifying_ = alarm_again_ = false;
  bin_count_ = window_count_ = pending_ = disagreements_ = 0;
}

void PathFilter::predict(PathState& state, double ds, const PathBin& bin) const noexcept {
  predict_path(state, ds, bin, config_.noise);
  state.P.diagonal().segment<2>(4).array() += config_.curvature_walk * std::abs(ds);
  if (!verifying_) return;
  // The slip may still be going on: what the hand does across the path says nothing of its direction.
  state.P.diagonal().head<2>().array() += kSlipSlope * kSlipSlope * ds * ds;
}

PathEvent PathFilter::step(const PathBin& bin) noexcept {
  const double ds = arc_to(state_, bin.position);
  predict(state_, ds, bin);
  PathState corrected = state_;
  last_ = correct_path(corrected, bin, config_.noise, config_.use_rotation);
  if (!corrected.P.allFinite() || !corrected.p.allFinite()) return PathEvent::BinClosed;
  ++steps_;
  const double nis = last_.nis / noise_scale_;
  learn_noise(last_);
  if (config_.alarms && slow_slip(last_)) {
    raise_alarm(false);
    return PathEvent::Alarm;
  }
  const bool settled = !config_.learn_noise || steps_ > kScaleSettled;
  if (config_.alarms && settled && nis > kBinLimit[row_class(last_.rows)]) {
    if (++pending_ < kOutliersInRow) return PathEvent::BinClosed;
    raise_alarm(true);
    return PathEvent::Alarm;
  }
  pending_ = 0;
  state_ = corrected;
  return PathEvent::BinClosed;
}

void PathFilter::learn_noise(const PathCorrection& correction) noexcept {
  if (!config_.learn_noise) return;
  noise_sum_ += std::min(correction.nis, kNoiseCap * correction.rows * noise_scale_);
  noise_rows_ += correction.rows;
  noise_scale_ = std::max(kNoiseFloor, noise_sum_ / noise_rows_);
}

bool PathFilter::slow_slip(const PathCorrection& correction) noexcept {
  const std::size_t c = row_class(correction.rows);
  window_[static_cast<std::size_t>(window_count_ % kWindow)] = std::min(correction.nis / noise_scale_, 0.5 * kBinLimit[c]);
  ++window_count_;
  if (window_count_ < kWindow || (config_.learn_noise && steps_ <= kWindowSettled)) return false;
  double sum = 0.0;
  for (const double value : window_) sum += value;
  return sum > kWindowLimit[c];
}

void PathFilter::raise_alarm(bool keep_recent_bins) noexcept {
  ++alarms_;
  window_count_ = pending_ = 0;
  alarm_again_ = verifying_;
  if (!verifying_) {
    bin_count_ = 0;
    if (keep_recent_bins) {
      for (int i = 0; i < previous_count_; ++i) push_bin(previous_[static_cast<std::size_t>(i)]);
    }
    verifying_ = true;
  }
  const PoseNoise& n = config_.noise;
  const double k2 = state_.kap.squaredNorm();
  Matrix14d& P = state_.P;
  const auto clear = [&P](Eigen::Index first, Eigen::Index count, double variance) {
    P.middleRows(first, count).setZero();
    P.middleCols(first, count).setZero();
    P.diagonal().segment(first, count).setConstant(variance);
  };
  clear(0, 2, kSlipOffset * kSlipOffset);
  clear(6, 3, kSlipTurn * kSlipTurn);
  clear(9, 2, n.position_correlated * n.position_correlated);
  clear(11, 3, n.rotation_correlated * n.rotation_correlated);
  P.diagonal().segment<2>(2).array() += kSlipDirection * kSlipDirection + kSlipLever * kSlipLever * k2;
  const double bend = kSlipLever * k2 + kSlipBend;
  P.diagonal().segment<2>(4).array() += bend * bend;
}

PathEvent PathFilter::verify(const PathBin& bin) noexcept {
  push_bin(bin);
  if (bin_count_ < kVerifyBins || (bin.position - bins_.front().position).norm() < start_length()) return PathEvent::None;
  PathState fresh;
  const std::span<const PathBin> bins(bins_.data(), static_cast<std::size_t>(bin_count_));
  if (!fit_path(bins, {config_.noise, config_.use_rotation, config_.curvature_prior}, fresh)) {
    bin_count_ = 0;
    return PathEvent::None;
  }
  Vector3d x = fresh.F.col(0);
  Vector3d k = fresh.curvature();
  if (x.dot(state_.F.col(0)) < 0.0) {  // the hand moved back since the alarm: the same path with both signs turned
    x = -x;
    k = -k;
  }
  const Vector4d d = path_difference(state_.F, state_.kap, x, k);
  const Eigen::Matrix4d C = noise_scale_ * (fresh.P.block<4, 4>(2, 2) + state_.P.block<4, 4>(2, 2));
  const bool handle = state_.kap.norm() > kHandleCurvature;
  if (handle || d.dot(C.llt().solve(d)) > kVerifyLimit) {
    const bool at_once = handle || d.head<2>().norm() > kRestartTurn || alarm_again_ || disagreements_ > 0;
    if (!at_once) {  // a slow slip may still have been going on: once more on fresh bins
      ++disagreements_;
      bin_count_ = 0;
      return PathEvent::None;
    }
    start_from(fresh);
    return PathEvent::Restarted;
  }
  disagreements_ = bin_count_ = 0;
  verifying_ = alarm_again_ = false;
  return PathEvent::None;
}

PathOutput PathFilter::output_of(const PathState& state) const noexcept {
  PathOutput output;
  output.F = state.F;
  output.kap = state.kap;
  output.point = state.p;
  output.rotation = state.R;
  output.covariance = noise_scale_ * state.P.topLeftCorner<9, 9>();
  return output;
}

PathOutput PathFilter::output() const noexcept { return output_of(state_); }

PathOutput PathFilter::peek(const Vector3d& position) const noexcept {
  PathState state = state_;
  if (started_ && current_.open) {
    const PathBin bin = closed_bin();
    predict(state, arc_to(state, bin.position), bin);
    PathState corrected = state;
    const PathCorrection correction = correct_path(corrected, bin, config_.noise, config_.use_rotation);
    const bool outlier = config_.alarms && correction.nis > noise_scale_ * kBinLimit[row_class(correction.rows)];
    if (!outlier && corrected.P.allFinite()) state = corrected;
  }
  if (started_ && position.allFinite()) move_along(state, arc_to(state, position));
  return output_of(state);
}

}  // namespace ajar
