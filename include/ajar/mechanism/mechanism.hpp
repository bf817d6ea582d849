#pragma once

#include <optional>
#include <string>
#include <vector>

#include "ajar/core/types.hpp"

namespace ajar {

enum class JointKind { Hinge, Slide };
enum class HandleKind { Bar, Knob, Recess, None };

/// What one can hold, at the closed mechanism, in the world.
struct Handle {
  HandleKind kind = HandleKind::Bar;
  Vector3d position = Vector3d::Zero();  ///< Centre of the grip [m]
  Vector3d normal = -Vector3d::UnitY();  ///< Outward normal of the leaf on the robot's side, unit
  Vector3d bar = Vector3d::UnitZ();      ///< Direction of the bar, unit; unused for a knob
  double standoff = 0.06;                ///< Leaf face to grip centre [m]
  double thickness = 0.02;               ///< Of what the fingers close on [m]
  double length = 0.12;                  ///< Of the bar [m]
};

/// A constant closing moment with its own damping while closing (EN 1154).
struct Closer {
  double moment = 0.0;           ///< Closing moment at q = 0 [N m or N]
  double stiffness = 0.0;        ///< Increase with opening [N m/rad or N/m]
  double closing_damping = 0.0;  ///< Added to `viscous` while q falls [N m s/rad or N s/m]
  bool operator==(const Closer&) const = default;
};

/// A seal or catch that fades linearly within the first part of the travel.
struct Seal {
  double force = 0.0;  ///< At q = 0 [N m or N]
  double range = 0.0;  ///< Where it has faded to nothing [rad or m]
  bool operator==(const Seal&) const = default;
};

/// The one-degree-of-freedom thing: hinge (axis, radius) or slide (direction), as it truly is. Only plants and judges hold
/// one.
struct Mechanism {
  std::string name = "mechanism";
  JointKind kind = JointKind::Hinge;
  Vector3d axis = Vector3d::UnitZ();  ///< Unit; hinge: positive rotation opens, slide: positive direction opens
  Vector3d point = Vector3d::Zero();  ///< On the axis (hinge) [m]
  double travel = 1.9;                ///< Hard stop on the open side; the closed stop is at 0 [rad or m]
  double stop_time_constant = 0.005;  ///< Of the end stop's contact [s]
  double mass = 20.0;                 ///< Moving mass [kg]
  double inertia = 4.0;               ///< About the axis, or the moving mass again for a slide [kg m² or kg]
  Vector3d com = Vector3d::Zero();    ///< Centre of the moving mass, closed, world [m]
  double gravity_share = 0.0;         ///< Part of the weight that acts on the joint (1 = no counterbalance) [-]
  double armature = 0.02;             ///< Extra inertia [kg m² or kg]
  double coulomb = 1.0;               ///< Sliding friction [N m or N]
  double breakaway = 1.0;             ///< Static over sliding friction, ≥ 1 [-]
  double viscous = 0.5;               ///< [N m s/rad or N s/m]
  double stiffness = 0.0;             ///< Spring [N m/rad or N/m]
  double spring_reference = 0.0;      ///< Rest position of the spring [rad or m]
  double constant_closing = 0.0;      ///< E.g. a rising hinge [N m or N]
  Closer closer;
  Seal seal;
  Handle handle;
  bool latched = false;            ///< Has a latch; treated as free, the result says so
  std::string latch;               ///< Its name
  std::vector<Box> leaf;           ///< Moving boxes at the closed mechanism, world
  std::vector<Box> world;          ///< Walls, frame, furniture, world
  std::optional<Doorway> doorway;  ///< Edges of the frame on the side of the handle, world; none if there is no frame

  /// @throws ConfigError  naming the field, its value and what is allowed
  void validate() const;
};

/// Motion of the leaf from closed to q: p(q) = R p + t.
[[nodiscard]] Pose leaf_motion(const Mechanism& mechanism, double q) noexcept;

/// Where the handle is and how it moves at q.
struct HandleMotion {
  Vector3d position;   ///< World [m]
  Vector3d direction;  ///< Unit direction of motion for opening, x
  Vector3d curvature;  ///< k = axis / r, zero for a slide [1/m]
  double radius;       ///< Handle travel per unit of q: r for a hinge [m/rad], 1 for a slide [-]
};
[[nodiscard]] HandleMotion handle_motion(const Mechanism& mechanism, double q) noexcept;

/// Generalised force that resists opening at (q, q̇), Coulomb friction excluded: springs, closer, seal, gravity, viscous.
/// (docs/equations.md#mechanism) [N m or N]
[[nodiscard]] double resisting_force(const Mechanism& mechanism, double q, double dq) noexcept;

/// Force at the handle along its motion that a slow opening needs at q [N].
[[nodiscard]] double handle_force_needed(const Mechanism& mechanism, double q) noexcept;

}  // namespace ajar
