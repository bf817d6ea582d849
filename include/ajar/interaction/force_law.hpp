#pragma once

#include "ajar/interaction/wrench.hpp"

namespace ajar {

struct ForceLawConfig {
  double stability_number = 0.45;       ///< α K (T_c + dead time), ≤ 0.5 keeps away from the limit π/2 [-]
  double total_stiffness = 7e3;         ///< K of arm, servo and grasp in series [N/m]
  double gain_max = 1e-2;               ///< Upper bound of α_f: stable up to K = 1e5 N/m at 500 Hz [m/(N s)]
  double integral_ratio = 0.33;         ///< β_f / α_f [1/s]
  double correction_max = 0.06;         ///< Largest |v_f| [m/s]
  double deadband = 0.5;                ///< Subtracted from the normal force [N]
  double torque_gain = 0.1;             ///< Upper bound of α_τ [rad/(N m s)]
  double rotational_stiffness = 100.0;  ///< K_r of the grasp: bounds α_τ by the same stability number [N m/rad]
  double turn_max = 0.4;                ///< Largest |ω_τ| [rad/s]
  double force_limit = 70.0;            ///< Force that the pull may reach [N]
  double start_force = 16.0;            ///< Force that the pull may reach while the direction is unsure [N]
  double speed_start = 0.02;            ///< Until the estimate is sure [m/s]
  double speed = 0.30;                  ///< Cruise along the mechanism [m/s]
  double acceleration = 0.30;           ///< Of the tangential speed [m/s²]
  double deceleration = 0.40;           ///< [m/s²]
  double give_gain = 4e-3;              ///< Upper bound of a_t, the gain of the tangential give [m/(N s)]
  double give_margin = 12.0;            ///< Above the running force the hand gives way [N]
  double give_reserve = 10.0;           ///< Below the force limit the hand gives way [N]
  double give_speed = 0.03;             ///< Largest backward speed of the give [m/s]
  bool operator==(const ForceLawConfig&) const = default;
  /// @throws ConfigError
  void validate() const;
};

/// What the force law asks of the hand in one tick.
struct ForceCorrection {
  Vector3d velocity = Vector3d::Zero();  ///< P v_f: to be subtracted from the tangential velocity [m/s]
  Vector3d turn = Vector3d::Zero();      ///< ω_τ: to be subtracted from the feed-forward turning [rad/s]
  double normal_force = 0.0;             ///< |P f| [N]
  double pull_force = 0.0;               ///< x·f [N]
};

/// α = min(largest, number / (K (T_c + dead time))): speed-independent loop gain. (docs/equations.md#force-law)
/// @param largest    Upper bound of the gain [m/(N s) or rad/(N m s)]
/// @param number     Stability number [-]
/// @param stiffness  K [N/m or N m/rad]
/// @param delay      T_c + dead time [s]
[[nodiscard]] double loop_gain(double largest, double number, double stiffness, double delay) noexcept;

/// Normal force and torque to zero (5.0)-(5.3 corrected). (docs/equations.md#force-law)
class ForceLaw {
 public:
  /// @param period      Control period [s]
  /// @param dead_time   Transport delay of the loop [s]
  /// @throws ConfigError
  ForceLaw(const ForceLawConfig& config, double period, double dead_time);
  void reset() noexcept;
  /// @param direction  x̂, unit  @param free_axis  Axis about which the grip turns freely, zero if none
  [[nodiscard]] ForceCorrection step(const HandWrench& wrench, const Vector3d& direction,
                                     const Vector3d& free_axis) noexcept;
  /// α_f that results from stiffness and rate [m/(N s)].
  [[nodiscard]] double gain() const noexcept { return gain_; }

 private:
  ForceLawConfig config_;
  double period_;
  double gain_;
  double torque_gain_;
  Vector3d integral_ = Vector3d::Zero();
};

/// What the speed law is told in one tick.
struct SpeedInput {
  double confidence = 0.0;      ///< 0 … 1 from the estimate: start speed … cruise [-]
  double base_lag = 0.0;        ///< What the base has to make up, see BaseLawOutput::lag [m]
  double pull_force = 0.0;      ///< x·f [N]
  double normal_force = 0.0;    ///< |P f| [N]
  double measured_speed = 0.0;  ///< x·V [m/s]
  double speed_cap = 1.0;       ///< From outside, e.g. an end is possible [m/s]
  double force_cap = 1e3;  ///< Pull force allowed now, e.g. while the direction is unsure; the force limit holds besides [N]
};

/// Share of the cruise speed at which the hand goes on while the base has this much to make up.
/// (docs/equations.md#speed-law)
/// @param lag  [m]
[[nodiscard]] double waiting_share(double lag) noexcept;

/// Steady tangential speed before ramps and give: start speed to cruise by confidence, waiting for a lagging base,
/// lowered as the forces near the limit. (docs/equations.md#speed-law) [m/s]
/// @param least_range  Of pull force over which the speed falls at least: bounds the gain of a late loop [N]
[[nodiscard]] double wanted_speed(const SpeedInput& input, const ForceLawConfig& config, double least_range = 0.0) noexcept;

/// Tangential speed: slow start, confidence, waiting for the base, lowered when force rises, tangential give.
/// (docs/equations.md#speed-law)
class SpeedLaw {
 public:
  /// @param period     Control period [s]
  /// @param dead_time  Transport delay of the loop: bounds the gain of the give as it bounds α [s]
  /// @throws ConfigError
  SpeedLaw(const ForceLawConfig& config, double period, double dead_time);
  void reset() noexcept;
  /// @return wanted speed along x̂, may be slightly negative while giving way [m/s]
  [[nodiscard]] double step(const SpeedInput& input) noexcept;
  /// Force that the motion needed so far (1 s low-pass while moving); NaN-free, 0 until the hand has moved [N].
  [[nodiscard]] double running_force() const noexcept { return running_force_; }

 private:
  ForceLawConfig config_;
  double period_;
  double speed_ = 0.0;
  double running_force_ = 0.0;
  double filtered_speed_ = 0.0;
  double travel_ = 0.0;
  double last_force_ = 0.0;
  double force_rate_ = 0.0;   // low-passed [N/s]
  double least_range_ = 0.0;  // [N]
  bool moved_ = false;
};

}  // namespace ajar
