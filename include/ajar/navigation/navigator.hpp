#pragma once

#include <string>

#include "ajar/model/robot_model.hpp"
#include "ajar/navigation/base_motion.hpp"

namespace ajar {

struct NavigationConfig {
  std::string law = "graceful";       ///< graceful | polar
  double k_rho = 0.5;                 ///< Polar k1 [1/s]
  double k_gamma = 2.0;               ///< Polar k2, > 2 k1 [1/s]
  double k_delta = 4.0;               ///< Polar k3, > k2/k1 - 1 [-]
  double k_phi = 2.0;                 ///< Graceful k_p [-]
  double k_turn = 1.0;                ///< Graceful k_d [-]
  double beta = 0.4;                  ///< Graceful: slowing in curves [-]
  double lambda = 2.0;                ///< Graceful: exponent [-]
  double slow_radius = 0.5;           ///< Graceful [m]
  double v_max = 0.5;                 ///< [m/s]
  double w_max = 0.8;                 ///< [rad/s]
  double acceleration = 0.5;          ///< [m/s²]
  double yaw_acceleration = 1.0;      ///< [rad/s²]
  double k_final = 1.5;               ///< Heading gain of the terminal turn [1/s]
  double position_tolerance = 0.004;  ///< [m]
  double heading_tolerance = 0.004;   ///< [rad]
  bool operator==(const NavigationConfig&) const = default;
  /// @throws ConfigError
  void validate() const;
};

/// Polar posture regulation, corrected (3.2)-(3.6). (docs/equations.md#polar) `forward` = false drives backward.
[[nodiscard]] BaseTwist polar_law(const BasePose& base, const BasePose& target, const NavigationConfig& config) noexcept;

/// Graceful law of Park & Kuipers. (docs/equations.md#graceful)
[[nodiscard]] BaseTwist graceful_law(const BasePose& base, const BasePose& target, bool forward,
                                     const NavigationConfig& config) noexcept;

/// Drives to a pose: the shorter of forward and backward is chosen once and kept, limits scale v and ω together,
/// a terminal switch handles the singular point. (docs/equations.md#navigation)
class Navigator {
 public:
  /// @throws ConfigError
  Navigator(const NavigationConfig& config, double period);
  /// Chooses the sense by rolling out both.
  void set_target(const BasePose& base, const BasePose& target) noexcept;
  /// No allocation, no exception, bounded time.
  [[nodiscard]] BaseTwist step(const BasePose& base) noexcept;
  [[nodiscard]] bool arrived() const noexcept { return arrived_; }
  [[nodiscard]] bool forward() const noexcept { return forward_; }

 private:
  NavigationConfig config_;
  double period_;
  BasePose target_;
  BaseTwist last_;
  bool forward_ = true;
  int stage_ = 0;
  bool arrived_ = false;
};

}  // namespace ajar
