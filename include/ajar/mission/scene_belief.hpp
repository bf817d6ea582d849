#pragma once

#include <array>
#include <optional>

#include "ajar/estimation/mechanism_estimate.hpp"
#include "ajar/model/clearance.hpp"
#include "ajar/planning/grasp_planner.hpp"

namespace ajar {

/// Indices of the believed obstacles in a ClearanceChecker.
inline constexpr int kWallObstacle = 0;
inline constexpr int kLeafObstacle = 1;
inline constexpr int kHingeWallObstacle = 2;  ///< Of a doorway; kWallObstacle is then its other side
inline constexpr int kRevealObstacle = 2;     ///< And the next: frame left and right of a leaf that lies behind it

inline constexpr int kMisreadObstacle = 4;  ///< And the next: the wall as it may stand, while the arm reaches

/// Where wall and leaf are, as far as sight and touch tell. (docs/equations.md#scene-belief)
class SceneBelief {
 public:
  /// Starts from what the camera sees; the leaf is a small box behind the handle until its kind is known.
  void reset(const HandleBelief& belief);

  /// Refines the wall's normal from the fitted mechanism and moves the leaf with the hand. No allocation, no exception.
  /// @param hand     Hand position now, odometry frame [m]
  /// @param turned   Rotation of the leaf since the grasp, rotation vector [rad]
  void update(const MechanismEstimate& estimate, const Vector3d& hand, const Vector3d& turned) noexcept;

  /// Turns a flap that is pressed on. @param angle  By which it stands open [rad]  No allocation, no exception.
  void turn_flap(double angle) noexcept;

  /// Writes wall and leaf into the checker. No allocation.
  /// @param hand_near  The hand may touch them: it holds the handle, or is about to
  void place(ClearanceChecker& checker, bool hand_near = true) const noexcept;

  /// Writes the leaf alone into the checker, moved by `shift` [m], with nothing that may touch it. No allocation.
  void place_leaf_moved(ClearanceChecker& checker, const Vector3d& shift) const noexcept;

  /// Writes the wall as it stands if its normal was misread, to either side; share 0 takes both away again. No allocation.
  void place_misread(ClearanceChecker& checker, double share) const noexcept;

  /// Outward normal of the wall at the closed handle, unit.
  [[nodiscard]] const Vector3d& normal() const noexcept { return belief_.normal; }
  /// Outward normal of the leaf as it stands, unit.
  [[nodiscard]] Vector3d leaf_normal() const noexcept { return -leaf_.pose.linear().col(1); }

 private:
  // The way travelled tells the plane of the wall better than the camera did.
  void refine_normal(const MechanismEstimate& estimate) noexcept;
  // R_leaf: axes of the leaf as it stands now (to the right, into the wall, up).
  void place_leaf(const MechanismEstimate& estimate, const Vector3d& hand, const Matrix3d& R_leaf) noexcept;

  HandleBelief belief_;  // its normal is horizontal and refined by touch
  Box wall_;
  Box hinge_wall_;
  std::optional<std::array<Box, 2>> reveal_;
  Vector3d axis_ = Vector3d::Zero();  // of the leaf in a doorway, until its own is felt
  Box leaf_;
};

}  // namespace ajar
