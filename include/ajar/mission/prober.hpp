#pragma once

#include <algorithm>
#include <array>

#include "ajar/interaction/wrench.hpp"

namespace ajar {

struct ProbeConfig {
  std::array<double, 5> forces{12.0, 24.0, 36.0, 48.0, 60.0};  ///< One round through all directions each [N]
  double force_rate = 250.0;                                   ///< At which the wanted force turns and grows [N/s]
  double stability_number = 0.6;                               ///< Gain times stiffness times delay [-]
  double loop_delay = 0.022;                                   ///< From the hand's command to the force that answers [s]
  double speed = 0.04;                                         ///< Of the hand, at most [m/s]
  double band = 8.0;              ///< The wanted force waits for the measured one that lacks more than this [N]
  double reach = 0.015;           ///< A handle that gives is followed for this much [m]
  double enough = 0.006;          ///< Motion that elasticity cannot explain and that settles it [m]
  double stiffness = 4e3;         ///< Softest grasp: what f/K may explain [N/m]
  double likely_stiffness = 1e4;  ///< K_c, for the direction of the motion [N/m]
  double longest = 1.2;           ///< Wait for a handle that gives too slowly [s]
  double dwell = 0.05;            ///< Full force without motion this long: the direction is blocked [s]
  double settle_time = 0.2;       ///< Three times as long as sideways force needs to go, once it is found [s]
  bool operator==(const ProbeConfig&) const = default;
};

/// Finds which way the mechanism gives: the wanted force turns through all directions, outwards and the guess first, in
/// rounds of rising strength, until the hand moves by more than elasticity explains. (docs/equations.md#probing)
class Prober {
 public:
  enum class Status { Running, Found, Nothing };

  explicit Prober(const ProbeConfig& config) : config_(config) {}

  /// Starts at the present hand pose.
  /// @param guess  Direction tried besides the axes of the hand, unit; zero if there is none
  void start(const Pose& hand, const Vector3d& guess) noexcept;

  /// One tick: the wanted hand twist. No allocation, no exception.
  [[nodiscard]] Vector6d step(const Pose& hand, const HandWrench& wrench, double dt) noexcept;

  [[nodiscard]] Status status() const noexcept { return status_; }
  /// Direction that gives, unit, world axes; valid once Found.
  [[nodiscard]] const Vector3d& direction() const noexcept { return direction_; }
  /// Force at which it gave [N]; valid once Found.
  [[nodiscard]] double force() const noexcept { return force_; }
  /// Force of the last round [N].
  [[nodiscard]] double strongest() const noexcept { return config_.forces.back(); }

 private:
  void count_from(const Vector3d& hand, const Vector3d& force_now) noexcept;
  void next_axis(const Vector3d& moved, const Vector3d& force_now) noexcept;
  [[nodiscard]] Vector3d speed(const Vector3d& moved, const Vector3d& force_now, double dt) noexcept;
  /// What elasticity does not explain of the way since the handle last held [m].
  [[nodiscard]] Vector3d given(const Vector3d& moved, const Vector3d& force_now) const noexcept {
    return moved - rest_ - (force_now - f_start_) / softest();
  }
  [[nodiscard]] double softest() const noexcept { return std::max(holds_with_, config_.stiffness); }
  void turn_force(double dt) noexcept;
  void follow(const Vector3d& moved, const Vector3d& force, double dt) noexcept;
  void settle(const Vector3d& motion) noexcept;
  [[nodiscard]] double level() const noexcept;
  [[nodiscard]] Vector3d axis() const noexcept;

  ProbeConfig config_;
  Status status_ = Status::Nothing;
  Matrix3d R_start_ = Matrix3d::Identity();
  Vector3d p_start_ = Vector3d::Zero();
  Vector3d f_start_ = Vector3d::Zero();
  Vector3d guess_ = Vector3d::Zero();
  Vector3d along_ = Vector3d::UnitX();  // of the wanted force
  double strength_ = 0.0;               // of the wanted force [N]
  Vector3d rest_ = Vector3d::Zero();    // of the hand without force, as far as elasticity goes, from the start
  Vector3d drawn_ = Vector3d::Zero();   // speed gained along what gives [m/s]
  double felt_ = 0.0;                   // largest stiffness so far, for the gain [N/m]
  double holds_with_ = 0.0;             // largest stiffness from one hold to the next [N/m]
  Vector3d held_at_ = Vector3d::Zero();
  Vector3d held_force_ = Vector3d::Zero();
  double waited_ = 0.0;
  double force_ = 0.0;
  double held_ = 0.0;
  double way_at_arrival_ = 0.0;
  double settled_ = 0.0;
  bool settling_ = false;  // found; the sideways force is let go before anything else
  bool arrived_ = false;
  bool gives_ = false;
  std::size_t round_ = 0;
  std::size_t turn_ = 0;
  Vector3d direction_ = Vector3d::Zero();
};

}  // namespace ajar
