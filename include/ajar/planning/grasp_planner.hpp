#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "ajar/model/clearance.hpp"
#include "ajar/model/robot_model.hpp"
#include "ajar/wbc/base_law.hpp"
#include "ajar/wbc/whole_body_controller.hpp"

namespace ajar {

/// A doorway whose leaf was felt to open away from the robot, as it is seen now; odometry frame.
/// (docs/equations.md#passage)
struct Passage {
  Vector3d inward = Vector3d::UnitY();  ///< Through the doorway, unit, horizontal
  Vector3d strike = Vector3d::Zero();   ///< Edge of the frame where the leaf shuts [m]
  Vector3d hinge = Vector3d::Zero();    ///< Edge of the frame where it is hinged, or what stands for it before a pivot [m]
  double overhang = 0.0;                ///< Leaf beyond a pivot within its width: it swings towards the robot [m]
  double opened = 0.0;                  ///< How far the leaf stands open already [rad]
};

/// Mechanism whose way was felt while it was moved, at the closed handle; odometry frame.
struct FeltMechanism {
  Vector3d direction = Vector3d::UnitX();  ///< In which the grip starts, unit
  Vector3d curvature = Vector3d::Zero();   ///< Zero for a slide [1/m]
  bool bar_turns = false;                  ///< The bar turns in the fingers
  double angle = 0.0;                      ///< Opening up to which the handle is held; 0 = the whole [rad]
};

/// A flap that was let go half open and is pressed on from inside, odometry frame. (docs/equations.md#press)
struct FlapPress {
  FeltMechanism way;                   ///< Of the closed handle
  Vector3d centre = Vector3d::Zero();  ///< Point of its axis nearest to the handle [m]
  double opened = 0.0;                 ///< How far it stands open [rad]
};

/// What is believed of the handle when a grasp is chosen, odometry frame.
struct HandleBelief {
  Vector3d position = Vector3d::Zero();  ///< Grip centre [m]
  Vector3d normal = -Vector3d::UnitY();  ///< Outward leaf normal, unit, horizontal
  Vector3d bar = Vector3d::UnitZ();      ///< Bar direction, unit; zero for a knob
  double standoff = 0.06;                ///< Leaf face to grip centre [m]
  double thickness = 0.02;               ///< Of what the fingers close on [m]
  std::optional<Doorway> doorway;        ///< Edges of the frame round the leaf, if one is seen [m]
  std::optional<Passage> passage;        ///< Set once the leaf was felt to open away: to be pushed
  std::optional<FeltMechanism> felt;     ///< Set once its way is known: nothing else is planned for
  std::optional<FlapPress> press;  ///< Set once it was let go half open: position and normal are those of the closed leaf
};

struct PlannerConfig {
  std::vector<double> hinge_radii{0.33, 0.8};       ///< Radii tried for both hinge sides [m]
  double hinge_angle = 1.5708;                      ///< Opening that each hinge roll-out must reach [rad]
  double drawer_travel = 0.45;                      ///< [m]
  double sliding_travel = 0.75;                     ///< Sideways, vertical bar [m]
  double flap_radius = 0.42;                        ///< Horizontal hinge below, horizontal bar [m]
  std::vector<double> distances{0.65, 0.75, 0.85};  ///< Base - handle [m]
  std::vector<double> azimuths{-0.35, 0.0, 0.35};   ///< Of the base round the handle, from the normal [rad]
  int headings = 12;                                ///< Base headings tried per place
  int ik_starts = 22;                               ///< Random starts per place and hand roll
  int roll_outs = 150;                              ///< Candidates rolled out
  int kept = 6;                                     ///< Candidates handed over, and checked with disturbed placements
  double step = 0.1;                                ///< Time step of a roll-out [s]
  double speed = 0.30;                              ///< Cruise of a roll-out along the mechanism [m/s]
  double least_sigma = 0.09;                        ///< Of a candidate at the grasp [-]
  double own_clearance = 0.025;                     ///< Of a candidate at the grasp [m]
  double wall_clearance = 0.07;                     ///< Of the base where it stands, to the believed wall [m]
  std::vector<double> passage_distances{0.80, 0.88, 0.96};  ///< Base - handle along a doorway to push through [m]
  std::vector<double> passage_yaws{0.5, 0.65, 0.8, 0.95,
                                   1.1};  ///< Hand turned towards the hinge at the start of a push [rad]
  double approach_distance = 0.10;        ///< The hand waits this far in front of the handle [m]
  bool operator==(const PlannerConfig&) const = default;
  /// @throws ConfigError
  void validate() const;
};

/// One way to take the handle.
struct GraspCandidate {
  BasePose base;                         ///< Where the base stands, odometry frame
  JointVector grasp;                     ///< Hand at the handle, shape (n)
  JointVector approach;                  ///< Hand in front of the handle, shape (n)
  Pose hand = Pose::Identity();          ///< Hand pose of the grasp, odometry frame
  double value = -1.0;                   ///< Worst case over what may be true; ≥ -0.01 is usable, larger is better [-]
  std::vector<std::string> falls_short;  ///< Names of the hypotheses whose way it does not follow to the end
};

/// Chooses grasp posture and base pose by rolling out the same QP and base law over the mechanisms that may be true.
/// (docs/equations.md#choice) Set-up and planning only: may allocate.
class GraspPlanner {
 public:
  /// @throws ConfigError
  GraspPlanner(const RobotModel& model, const PlannerConfig& config, const WbcConfig& wbc, const BaseLawConfig& base_law,
               const ClearanceConfig& clearance);
  ~GraspPlanner();

  /// Candidates, best first; empty if the handle cannot be reached from anywhere. `why` then names the reason.
  [[nodiscard]] std::vector<GraspCandidate> choose(const HandleBelief& belief, std::uint64_t seed,
                                                   std::string* why = nullptr) const;

  /// Checks at the base pose reached: keeps the planned posture if it is still good, else tries all postures from there.
  /// @return false if no posture is good enough from here
  [[nodiscard]] bool choose_posture(const HandleBelief& belief, const BasePose& base, std::uint64_t seed,
                                    GraspCandidate& candidate) const;

  /// Value of a grasp for the mechanism that was felt, belief.felt: one roll-out. No allocation, no exception, about 1 ms.
  [[nodiscard]] double value_for_felt(const HandleBelief& belief, const GraspCandidate& candidate) const noexcept;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Hand orientation that meets the leaf along its normal with the fingers across the bar: hand z into the leaf.
/// `flip` turns by half a turn about hand z.
[[nodiscard]] Matrix3d grasp_orientation(const HandleBelief& belief, bool flip);

}  // namespace ajar
