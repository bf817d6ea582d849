#pragma once

#include <array>

#include "ajar/estimation/path_fit.hpp"
#include "ajar/estimation/path_state.hpp"

namespace ajar {

/// One measured pose of the handle.
struct PathSample {
  Vector3d position = Vector3d::Zero();      ///< World or odometry axes [m]
  Matrix3d rotation = Matrix3d::Identity();  ///< Hand to world; ignored without orientation [-]
  double base_travel = 0.0;                  ///< Path of the base since the sample before [m]
  double extra_sigma = 0.0;                  ///< Position error beyond the noise model, e.g. of the grasp [m]
};

struct PathFilterConfig {
  PoseNoise noise;               ///< Noise model of the pose source
  bool use_rotation = true;      ///< False: positions only
  bool alarms = true;            ///< Watch the prediction errors and re-learn after a slip
  bool learn_noise = true;       ///< Scale the covariance by the measured prediction errors
  double bin_length = 0.002;     ///< Least arc of a bin; three times the white noise if that is more [m]
  double start_length = 0.02;    ///< Least distance of the ends for the first fit; 6 σ_p if that is more [m]
  double curvature_prior = 3.0;  ///< Standard deviation of each curvature component before any data [1/m]
  double curvature_walk = 0.0;   ///< Growth of the curvature variance per metre of arc [1/m³]
  bool operator==(const PathFilterConfig&) const = default;
  /// @throws ConfigError
  void validate() const;
};

/// What one sample did.
enum class PathEvent {
  None,       ///< Joined the open bin
  Rejected,   ///< A single sample far off the predicted curve: left out
  BinClosed,  ///< A bin was closed and taken in
  Started,    ///< The first fit succeeded; from now on there is an estimate
  Alarm,      ///< The prediction errors say that the model was wrong; pose offset re-opened
  Restarted,  ///< A fresh fit of the bins since an alarm replaced the estimate
  Invalid     ///< Not finite: ignored
};

/// The filter's belief at one point of the path.
struct PathOutput {
  Matrix3d F = Matrix3d::Identity();           ///< Columns x (along the order of travel), b1, b2 [-]
  Vector2d kap = Vector2d::Zero();             ///< Curvature along b1, b2 [1/m]
  Vector3d point = Vector3d::Zero();           ///< On the path [m]
  Matrix3d rotation = Matrix3d::Identity();    ///< Of the grasp [-]
  Matrix9d covariance = Matrix9d::Identity();  ///< Of (a, w, dkap, φ), noise scale included, shape (9, 9)

  /// Curvature vector, world axes [1/m].
  [[nodiscard]] Vector3d curvature() const { return F.rightCols<2>() * kap; }
};

/// Recursive fit of a circle or line to poses, over arc length: bins, a Gauss-Newton start, then an error-state Kalman
/// filter with states for the correlated pose error. Constant memory; reaches the Cramér-Rao bound.
/// (docs/equations.md#estimator)
class PathFilter {
 public:
  /// @throws ConfigError
  explicit PathFilter(const PathFilterConfig& config);

  /// Forgets everything.
  void reset() noexcept;

  /// Takes one sample. No allocation, no exception, bounded time.
  [[nodiscard]] PathEvent add(const PathSample& sample) noexcept;

  /// True once there is an estimate.
  [[nodiscard]] bool started() const noexcept { return started_; }
  /// Estimate at the newest closed bin.
  [[nodiscard]] PathOutput output() const noexcept;
  /// Estimate with the open bin taken in as well, moved along the curve to a position; the filter is not changed.
  [[nodiscard]] PathOutput peek(const Vector3d& position) const noexcept;
  /// Measured noise variance over the stated one [-].
  [[nodiscard]] double noise_scale() const noexcept { return noise_scale_; }
  /// Alarms since the last reset.
  [[nodiscard]] int alarms() const noexcept { return alarms_; }
  /// Last bin's prediction error squared over its covariance, and its rows.
  [[nodiscard]] const PathCorrection& last_correction() const noexcept { return last_; }

 private:
  static constexpr int kWindow = 8;  // bins of the slow-slip sum
  static constexpr int kRecent = 5;  // most samples whose mean closes a bin

  struct OpenBin {
    PathBin bin;
    Vector3d turn = Vector3d::Zero();
    Matrix3d reference = Matrix3d::Identity();
    bool open = false;
  };

  void open_bin(const PathSample& sample) noexcept;
  void join_bin(const PathSample& sample) noexcept;
  [[nodiscard]] PathBin closed_bin() const noexcept;
  [[nodiscard]] bool left_bin(const Vector3d& position) noexcept;
  [[nodiscard]] bool far_off(const PathSample& sample) const noexcept;
  [[nodiscard]] PathEvent take_bin(const PathBin& bin) noexcept;
  [[nodiscard]] PathEvent try_start(const PathBin& bin) noexcept;
  void predict(PathState& state, double ds, const PathBin& bin) const noexcept;
  [[nodiscard]] PathEvent step(const PathBin& bin) noexcept;
  [[nodiscard]] PathEvent verify(const PathBin& bin) noexcept;
  void learn_noise(const PathCorrection& correction) noexcept;
  [[nodiscard]] bool slow_slip(const PathCorrection& correction) noexcept;
  void raise_alarm(bool keep_recent_bins) noexcept;
  void start_from(const PathState& state) noexcept;
  void push_bin(const PathBin& bin) noexcept;
  [[nodiscard]] PathOutput output_of(const PathState& state) const noexcept;
  [[nodiscard]] double start_length() const noexcept;
  [[nodiscard]] double bin_length() const noexcept;

  PathFilterConfig config_;
  PathState state_;
  bool started_ = false;
  OpenBin current_;
  std::array<Vector3d, kRecent> recent_{};  // positions of the newest samples
  int recent_count_ = 0;
  int recent_needed_ = kRecent;  // samples whose mean closes a bin
  int rejected_ = 0;

  std::array<PathBin, kMaxFitBins> bins_{};  // before the start, and after an alarm until it is verified
  int bin_count_ = 0;
  std::array<PathBin, 2> previous_{};  // the two bins before the present one
  int previous_count_ = 0;

  double noise_scale_ = 1.0;
  double noise_sum_ = 0.0;
  double noise_rows_ = 0.0;
  int steps_ = 0;

  std::array<double, kWindow> window_{};
  int window_count_ = 0;
  int pending_ = 0;  // outlying bins in a row
  int alarms_ = 0;
  bool verifying_ = false;  // bins are collected since an alarm
  bool alarm_again_ = false;
  int disagreements_ = 0;
  PathCorrection last_;
};

}  // namespace ajar
