#pragma once

#include <array>

#include "ajar/interaction/wrench.hpp"

namespace ajar {

struct ProbeConfig {
  std::array<double, 3> forces{20.0, 32.0, 44.0};  ///< Levels tried one after the other [N]
  double speed = 0.03;            ///< Of a push [m/s]
  double reach = 0.02;            ///< A push ends after this much motion [m]
  double enough = 0.010;          ///< Motion that elasticity cannot explain and that settles it [m]
  double least = 0.003;           ///< Less than this is no motion at all [m]
  double stiffness = 4e3;         ///< Softest grasp: what f/K may explain [N/m]
  double push_time = 1.2;         ///< Longest push [s]
  double return_time = 0.5;       ///< Longest way back [s]
  double blocked_time = 0.25;     ///< At full force without motion this long: the push ends [s]
  bool operator==(const ProbeConfig&) const = default;
};

/// Short pushes along the axes of the hand that find which way the mechanism gives. (docs/equations.md#probing)
class Prober {
 public:
  enum class Status { Running, Found, Nothing };

  explicit Prober(const ProbeConfig& config) : config_(config) {}

  /// Starts a round of pushes at the present hand pose. @param level  Index of the force level
  void start(const Pose& hand, int level) noexcept;

  /// One tick: the wanted hand twist. No allocation, no exception.
  [[nodiscard]] Vector6d step(const Pose& hand, const HandWrench& wrench, double dt) noexcept;

  [[nodiscard]] Status status() const noexcept { return status_; }
  /// Direction that gives, unit, world axes; valid once Found.
  [[nodiscard]] const Vector3d& direction() const noexcept { return direction_; }
  /// Force of the present level [N].
  [[nodiscard]] double force() const noexcept;

 private:
  void end_push() noexcept;
  void next_push() noexcept;

  ProbeConfig config_;
  Status status_ = Status::Nothing;
  Matrix3d R_start_ = Matrix3d::Identity();
  Vector3d p_start_ = Vector3d::Zero();
  Vector3d p_last_ = Vector3d::Zero();
  Vector3d farthest_ = Vector3d::Zero();
  Vector3d direction_ = Vector3d::Zero();
  Vector3d best_motion_ = Vector3d::Zero();
  Vector3d best_axis_ = Vector3d::Zero();
  double best_ = 0.0;
  double time_ = 0.0;
  double blocked_ = 0.0;
  int level_ = 0;
  int push_ = 0;
  bool returning_ = false;
};

}  // namespace ajar
