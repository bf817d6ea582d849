#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "ajar/plant/plant.hpp"

namespace ajar {

/// How long the control ticks took [µs].
struct TickTimes {
  double p50 = 0.0;
  double p99 = 0.0;
  double p999 = 0.0;
  double max = 0.0;
};

/// What a run came to, as `result.json` has it. Every value is judged from the truth; not applicable = empty.
/// Forces are means over 20 ms of the true wrench in phase Open unless said otherwise; "normal" is perpendicular to the
/// true direction of motion, "the stop" the last 4 mm of handle travel before the end stop.
struct RunResult {
  std::string outcome = "stopped";               ///< opened | stopped
  std::string phase;                             ///< Phase in which the mission ended
  std::string reason;                            ///< to_string(EndReason), or claimed_but_not_open
  std::string explanation;                       ///< The reason in words
  std::string mechanism_type_true;               ///< hinge | slide
  std::string mechanism_type_estimated;          ///< unknown | hinge | slide
  std::optional<double> opening;                 ///< At the end of phase Open, else at the end of the run [rad or m]
  std::optional<double> opening_fraction;        ///< Of the goal, or of the end stop if that comes first [-]
  double duration = 0.0;                         ///< [s]
  std::optional<double> open_duration;           ///< [s]
  std::optional<double> probe_duration;          ///< [s]
  std::optional<double> handle_travel;           ///< Path of the true handle until the end of phase Open [m]
  std::optional<double> peak_normal_force;       ///< [N]
  std::optional<double> peak_normal_force_free;  ///< The same outside of the stop [N]
  std::optional<double> mean_normal_force;       ///< [N]
  std::optional<double> late_normal_force;       ///< Mean after 15 cm of arc, outside of the stop [N]
  std::optional<double> late_normal_force_peak;  ///< Peak after 15 cm of arc, outside of the stop [N]
  std::optional<double> peak_pull_force;         ///< Along the motion [N]
  std::optional<double> stop_force;              ///< Peak of the whole force at the stop [N]
  std::optional<double> peak_torque;             ///< [N m]
  std::optional<double> peak_probe_force;        ///< Whole force, phase Probe [N]
  std::optional<double> probe_force_over_need;   ///< The same less what the mechanism needed where it was probed [N]
  std::optional<double> probe_direction_error;   ///< Of the direction with which probing ended, the worst if several [rad]
  std::vector<Contact> unwanted_contacts;
  std::optional<double> min_clearance;       ///< Smallest believed distance [m]
  std::optional<double> path_error_max;      ///< Change of the offset hand - handle in the leaf [m]
  std::optional<double> distance_min;        ///< Hand - base [m]
  std::optional<double> distance_max;        ///< [m]
  std::optional<double> heading_error_rms;   ///< Since the base moves [rad]
  std::optional<double> heading_error_max;   ///< [rad]
  std::optional<double> min_singular_value;  ///< Of the arm [-]
  std::optional<double>
      direction_error_start;  ///< At the beginning of phase Open: that of the guess, or of the probing [rad]
  std::optional<double> direction_error_10cm;      ///< At 10 cm of arc [rad]
  std::optional<double> direction_error_20cm;      ///< [rad]
  std::optional<double> direction_error_final;     ///< At the end of phase Open [rad]
  std::optional<double> direction_sigma_final;     ///< [rad]
  std::optional<double> curvature_error_20cm;      ///< [1/m]
  std::optional<double> curvature_error_40cm;      ///< [1/m]
  std::optional<double> curvature_error_final;     ///< [1/m]
  std::optional<double> curvature_sigma_final;     ///< [1/m]
  std::optional<double> angle_error_final;         ///< Of the believed opening of a hinge, at the end of the run [rad]
  std::optional<double> odometry_error_final;      ///< Odometry against the true base [m]
  std::optional<double> odometry_yaw_error_final;  ///< [rad]
  std::int64_t limit_violations = 0;               ///< Ticks at which command or true state left a limit [-]
  std::string limit_violation_first;               ///< What it was
  std::int64_t nonfinite_commands = 0;             ///< [-]
  std::uint64_t seed = 0;
  std::string version;
  std::vector<std::string> notes;  ///< E.g. of a latch that is treated as free
  std::int64_t missed_ticks = 0;   ///< Ticks that took longer than the period [-]
  TickTimes tick_us;
  std::optional<double> real_time_factor;  ///< Simulated over wall time [-]

  /// 0: the goal was reached; 1: the mission ended safely without reaching it.
  [[nodiscard]] int exit_code() const noexcept { return outcome == "opened" ? 0 : 1; }
};

/// One scalar of a result; empty = not applicable.
struct ResultField {
  std::string name;
  std::variant<std::monostate, double, std::int64_t, std::string> value;
};

/// All scalars in the order of the file, those that depend on the computer's speed last.
[[nodiscard]] std::vector<ResultField> result_fields(const RunResult& result);

/// A scalar as a CSV cell; empty if not applicable.
[[nodiscard]] std::string csv_cell(const ResultField& field);

/// `result.json`; numbers that are not finite become null.
[[nodiscard]] std::string to_json(const RunResult& result);

}  // namespace ajar
