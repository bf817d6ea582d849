#pragma once

#include <array>
#include <limits>
#include <memory>
#include <vector>

#include "ajar/model/robot_model.hpp"

namespace ajar {

/// What a distance is measured between.
enum class ClearanceKind { Self, ArmWorld, BaseWorld };

/// When a pair is looked at, what distance must remain and how fast it may shrink.
struct ClearanceLimits {
  double influence;  ///< Pairs farther than this are ignored [m]
  double stop;       ///< Distance to keep [m]
  double rate;       ///< Approach speed per metre of reserve, ξ [1/s]
};

struct ClearanceConfig {
  ClearanceLimits self{0.12, 0.02, 3.0};
  ClearanceLimits arm_world{0.15, 0.03, 3.0};
  ClearanceLimits base_world{0.40, 0.04, 0.6};  // ξ² · 0.36 m: a third of what the base can brake with
};

/// One close pair: d(distance)/dt = row·u - normal·v_obstacle.
struct ClearanceRow {
  InputRow row;           ///< shape (1, n + 2)
  double distance = 0.0;  ///< [m]
  ClearanceKind kind = ClearanceKind::Self;
  int obstacle = -1;                              ///< Index of the obstacle, -1 for the robot's own body
  int shape = -1;                                 ///< Index in RobotModel::shapes()
  int other_shape = -1;                           ///< Self: index of the body it is near to; -1 for obstacles
  Vector3d normal = Vector3d::UnitZ();            ///< From obstacle to robot, world axes
  Vector3d point_on_obstacle = Vector3d::Zero();  ///< World [m]
};

inline constexpr int kMaxClearanceRows = 24;
inline constexpr int kMaxObstacles = 12;

/// The closest pairs of one evaluation, sorted by reserve, and the smallest distance of each kind.
struct ClearanceResult {
  std::array<ClearanceRow, kMaxClearanceRows> rows;
  int count = 0;
  /// Smallest distance per kind (Self, ArmWorld, BaseWorld); +inf where none within influence [m]
  std::array<double, 3> smallest{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity(),
                                 std::numeric_limits<double>::infinity()};
};

/// What of the hand may touch an obstacle, so that its distance does not count.
enum class MayTouch {
  Nothing,
  Fingers,  ///< What closes round the handle: bodies of the last link that reach to the tool centre point
  Hand      ///< The tool and the last wrist link
};

/// Distances of the robot to itself and to boxes that it believes in, by Coal.
class ClearanceChecker {
 public:
  /// @throws ConfigError  naming the limit, its value and its range
  ClearanceChecker(const RobotModel& model, const ClearanceConfig& config);
  ClearanceChecker(const ClearanceChecker& other);
  ClearanceChecker& operator=(const ClearanceChecker&) = delete;
  ~ClearanceChecker();

  /// Places an obstacle (world frame). No allocation.
  void set_obstacle(int index, const Box& box, MayTouch hand) noexcept;
  /// Removes an obstacle.
  void clear_obstacle(int index) noexcept;

  /// Evaluates all pairs. Non-finite inputs: no rows and all smallest distances 0, the cautious reading. Needs
  /// model.compute(base, q) to have been called on the given model just before. No allocation, no exception, bounded time.
  void compute(const RobotModel& model, const BasePose& base, ClearanceResult& out) noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ajar
