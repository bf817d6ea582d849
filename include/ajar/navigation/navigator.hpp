#pragma once

#include <array>
#include <optional>
#include <string>

#include "ajar/model/robot_model.hpp"
#include "ajar/navigation/base_motion.hpp"

namespace ajar {

struct NavigationConfig {
  std::string law = "graceful";   ///< graceful | polar | thesis (polar, with any gains: the thesis's miss the gain rule)
  bool printed = false;           ///< Polar: γ as printed in (3.3), which points away from the target
  double k_rho = 0.5;             ///< Polar k1 [1/s]
  double k_gamma = 2.0;           ///< Polar k2, > 2 k1 [1/s]
  double k_delta = 4.0;           ///< Polar k3, > k2/k1 - 1 [-]
  double k_phi = 2.0;             ///< Graceful k_p [-]
  double k_turn = 1.0;            ///< Graceful k_d [-]
  double beta = 0.4;              ///< Graceful: slowing in curves [-]
  double lambda = 2.0;            ///< Graceful: exponent [-]
  double slow_radius = 0.5;       ///< Graceful [m]
  double v_max = 0.5;             ///< [m/s]
  double v_reverse = 0.3;         ///< Largest backward speed of the navigator; MiR100 planner value 0.2, hardware more [m/s]
  double w_max = 0.8;             ///< [rad/s]
  double acceleration = 0.5;      ///< [m/s²]
  double yaw_acceleration = 1.0;  ///< [rad/s²]
  double k_final = 1.5;           ///< Heading gain of the terminal turn [1/s]
  double max_curvature = 6.0;     ///< Sharpest curve of the driven path [1/m]
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

/// A rectangle on the floor.
struct FloorBox {
  Vector2d centre = Vector2d::Zero();               ///< Odometry frame [m]
  Vector2d along = Vector2d::UnitX();               ///< Direction of its first side, unit [-]
  Vector2d half_extents = Vector2d::Constant(0.5);  ///< Along and across [m]
};

/// What the base must not enter: a half-plane such as the wall round a door, and what stands in front of it; with the base's
/// footprint.
struct KeepOut {
  Vector2d point = Vector2d::Zero();     ///< On the border, odometry frame [m]
  Vector2d normal = -Vector2d::UnitY();  ///< From the border into free space, unit [-]
  double margin = 0.10;                  ///< Distance that the footprint keeps if start and target allow it [m]
  double front = 0.487;                  ///< Footprint ahead of the axle; Heron's, see `base_footprint` [m]
  double rear = 0.411;                   ///< Behind the axle [m]
  double half_width = 0.292;             ///< To each side [m]
  std::optional<FloorBox> box;           ///< Kept out of as well
};

/// Smallest distance of the footprint's corners to the border, negative inside. [m]
[[nodiscard]] double footprint_clearance(const BasePose& base, const KeepOut& keep_out) noexcept;

/// Distance of the footprint to the box along the best of the four sides' directions: never more than the true one, negative
/// by what they overlap. Infinite without a box. [m]
[[nodiscard]] double box_clearance(const BasePose& base, const KeepOut& keep_out) noexcept;

/// How far a base drives straight on until it can turn on the spot with the margin to border and box.
/// @param sense  1 forward, -1 backward
/// @return Positive or 0; infinite if two metres do not get it there [m]
[[nodiscard]] double way_to_turn(const BasePose& base, const KeepOut& keep_out, double sense) noexcept;

/// Drives to a pose: the quickest of several routes (forward, backward, turning first, by way of a point where it can turn)
/// is chosen once by prediction and kept, limits scale v and ω together, a terminal switch handles the singular point.
/// (docs/equations.md#navigation)
class Navigator {
 public:
  /// @throws ConfigError
  Navigator(const NavigationConfig& config, double period);
  /// Chooses the route by rolling out all of them. `keep_out` = nullptr: free space everywhere. No allocation, below 5 ms.
  void set_target(const BasePose& base, const BasePose& target, const KeepOut* keep_out = nullptr) noexcept;
  /// No allocation, no exception, bounded time.
  [[nodiscard]] BaseTwist step(const BasePose& base) noexcept;
  [[nodiscard]] bool arrived() const noexcept { return state_.stage == Stage::Arrived; }
  /// Sense of the last leg.
  [[nodiscard]] bool forward() const noexcept { return state_.legs[static_cast<std::size_t>(state_.leg_count - 1)].forward; }
  /// Time that the chosen route takes by the prediction [s].
  [[nodiscard]] double predicted_time() const noexcept { return predicted_time_; }

 private:
  enum class Stage { Idle, Start, FirstTurn, Drive, Dock, Align, Creep, FinalTurn, Settle, Arrived };
  struct Leg {
    BasePose goal;
    bool forward = true;
    bool turn_first = false;
  };
  struct State {
    std::array<Leg, 2> legs;
    int leg_count = 1;
    int leg = 0;
    Stage stage = Stage::Idle;
    BasePose target;
    BaseTwist last;
    double timer = 0.0;      // in the present stage [s]
    double align_yaw = 0.0;  // of the correcting move [rad]
    int corrections = 0;
  };
  struct Prediction {
    double time = 0.0;
    double curvature = 0.0;
    double clearance = 0.0;  // to the border [m]
    double box = 0.0;        // to the box [m]
    bool arrives = false;
  };

  [[nodiscard]] BaseTwist advance(State& state, const BasePose& base, double dt) const noexcept;
  [[nodiscard]] bool leave_stage(State& state, const BasePose& base) const noexcept;
  [[nodiscard]] bool leave_journey(State& state, const BasePose& base) const noexcept;
  [[nodiscard]] bool leave_terminal(State& state, const BasePose& base) const noexcept;
  [[nodiscard]] double start_heading(const Leg& leg, const BasePose& base) const noexcept;
  [[nodiscard]] BaseTwist wanted(const State& state, const BasePose& base) const noexcept;
  [[nodiscard]] BaseTwist drive(const Leg& leg, const BasePose& base) const noexcept;
  [[nodiscard]] bool inside_tolerance(const State& state, const BasePose& base) const noexcept;
  void correct(State& state, const BasePose& base) const noexcept;
  [[nodiscard]] static Leg straight(const BasePose& from, const BasePose& to, bool forward) noexcept;
  [[nodiscard]] Prediction predict(State state, BasePose base, const KeepOut* keep_out) const noexcept;
  void consider(State candidate, const BasePose& base, const KeepOut* keep_out) noexcept;
  void consider_by_way(State fresh, const BasePose& base, const KeepOut& keep_out) noexcept;

  NavigationConfig config_;
  bool polar_;
  double period_;
  State state_;
  double best_cost_ = 0.0;
  double predicted_time_ = 0.0;
};

}  // namespace ajar
