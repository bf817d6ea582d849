#pragma once

#include <optional>
#include <string>

#include "ajar/core/types.hpp"
#include "ajar/navigation/base_motion.hpp"

namespace ajar {

struct BaseLawConfig {
  std::string kind = "corotating";     ///< corotating | distance (the thesis's distance and heading) | line
  double gain_along = 1.0;             ///< k_x [1/s]
  double gain_across = 5.0;            ///< k_y [1/m²]
  double gain_heading = 0.8;           ///< k_θ [1/s]
  double full_curvature = 1.8;         ///< κ up to which the base follows the whole turning [1/m]
  double least_share = 0.3;            ///< Smallest share of the turning [-]
  double distance = 0.75;              ///< Wanted hand-base distance of "distance" and "line" [m]
  double gain_distance = 1.0;          ///< [1/s]
  double gain_heading_distance = 2.0;  ///< [1/s]
  bool operator==(const BaseLawConfig&) const = default;
  /// @throws ConfigError
  void validate() const;
};

/// A straight way that the base keeps to, e.g. the middle of a doorway.
struct BaseLine {
  Vector3d point = Vector3d::Zero();       ///< On the line, odometry frame [m]
  Vector3d direction = Vector3d::UnitX();  ///< Unit, horizontal
};

struct BaseLawInput {
  double dt = 0.002;                       ///< [s]
  BasePose base;                           ///< Odometry
  Vector3d hand = Vector3d::Zero();        ///< [m]
  Vector3d direction = Vector3d::UnitX();  ///< x̂
  Vector3d curvature = Vector3d::Zero();   ///< k̂
  double wanted_speed = 0.0;               ///< v_d along x̂ [m/s]
  double measured_speed = 0.0;             ///< x̂·V, signed; drives the turning of the reference [m/s]
  double confidence = 0.0;                 ///< 0 … 1: scales the output
};

struct BaseLawOutput {
  BaseTwist twist;
  double lag = 0.0;            ///< Distance of the base from its reference, and a turn that it must make first [m]
  double heading_error = 0.0;  ///< [rad]
};

/// Base motion along the estimated mechanism: a pose that turns with it (corotating), or the thesis's laws.
/// (docs/equations.md#base-law)
class BaseLaw {
 public:
  /// @throws ConfigError
  explicit BaseLaw(const BaseLawConfig& config);
  /// @param line  If given, the base keeps to it and follows the hand only along it ("corotating")
  void reset(const BasePose& base, const Vector3d& hand, const std::optional<BaseLine>& line = std::nullopt) noexcept;
  /// No allocation, no exception, bounded time; output finite.
  [[nodiscard]] BaseLawOutput step(const BaseLawInput& input) noexcept;

 private:
  [[nodiscard]] BaseLawOutput corotating(const BaseLawInput& input) noexcept;
  [[nodiscard]] BaseLawOutput keep_distance(const BaseLawInput& input) noexcept;
  void choose_sense(double heading, double yaw, double confidence) noexcept;

  enum class Kind { Corotating, Distance, Line };

  BaseLawConfig config_;
  Kind kind_ = Kind::Corotating;
  std::optional<BaseLine> line_;
  Vector3d offset_ = Vector3d::Zero();
  double turned_ = 0.0;
  double start_yaw_ = 0.0;
  double last_heading_ = 0.0;
  int drive_sense_ = 0;
};

}  // namespace ajar
