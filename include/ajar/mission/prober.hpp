#pragma once

#include <array>

#include "ajar/interaction/wrench.hpp"

namespace ajar {

struct ProbeConfig {
  std::array<double, 4> forces{20.0, 32.0, 46.0, 60.0};  ///< Levels tried one after the other [N]
  double speed = 0.03;                                   ///< Of a push [m/s]
  double reach = 0.025;                                  ///< A push ends after this much motion [m]
  double enough = 0.006;                                 ///< Motion that elasticity cannot explain and that settles it [m]
  double stiffness = 4e3;                                ///< Softest grasp: what f/K may explain [N/m]
  double likely_stiffness = 1e4;                         ///< K_c, for the direction of the motion [N/m]
  double push_time = 1.2;                                ///< Longest push [s]
  double return_time = 0.5;                              ///< Longest way back [s]
  double blocked_time = 0.25;                            ///< At full force without motion this long: the push ends [s]
  bool operator==(const ProbeConfig&) const = default;
};

/// Short pushes that find which way the mechanism gives: along the outward normal and the guess first, then to the sides,
/// each with rising force. (docs/equations.md#probing)
class Prober {
 public:
  enum class Status { Running, Found, Nothing };

  explicit Prober(const ProbeConfig& config) : config_(config) {}

  /// Starts the pushes at the present hand pose.
  /// @param guess  Direction tried besides the axes of the hand, unit; zero if there is none
  void start(const Pose& hand, const Vector3d& guess) noexcept;

  /// One tick: the wanted hand twist. No allocation, no exception.
  [[nodiscard]] Vector6d step(const Pose& hand, const HandWrench& wrench, double dt) noexcept;

  [[nodiscard]] Status status() const noexcept { return status_; }
  /// Direction that gives, unit, world axes; valid once Found.
  [[nodiscard]] const Vector3d& direction() const noexcept { return direction_; }
  /// Force of the present push [N].
  [[nodiscard]] double force() const noexcept;
  /// Force of the strongest push [N].
  [[nodiscard]] double strongest() const noexcept { return config_.forces.back(); }

 private:
  void end_push() noexcept;
  void next_push() noexcept;
  void settle() noexcept;
  void watch(const Vector3d& hand, const Vector3d& force) noexcept;
  [[nodiscard]] Vector3d axis() const noexcept;

  ProbeConfig config_;
  Status status_ = Status::Nothing;
  Matrix3d R_start_ = Matrix3d::Identity();
  Vector3d p_start_ = Vector3d::Zero();
  Vector3d p_last_ = Vector3d::Zero();
  Vector3d p_pulled_ = Vector3d::Zero();  // hand where its own pull began
  Vector3d farthest_ = Vector3d::Zero();
  Vector3d direction_ = Vector3d::Zero();
  Vector3d motion_ = Vector3d::Zero();
  double filtered_speed_ = 0.0;
  double time_ = 0.0;
  double blocked_ = 0.0;
  Vector3d guess_ = Vector3d::Zero();
  int push_ = 0;
  bool returning_ = false;
  bool settling_ = false;  // found; the sideways force of the push is let go before anything else
};

}  // namespace ajar
