#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "ajar/mechanism/mechanism.hpp"

namespace ajar {

enum class Side { Left, Right };
enum class Sense { Pull, Push };
enum class BarOrientation { Vertical, Horizontal };

/// A door, cabinet, flap or drawer by a few words; `make_mechanism` adds leaf, wall and cabinet boxes.
/// Leaf frame: handle above `at`, the wall plane through `at`, its outward normal turned by `yaw` from world -y.
struct MechanismConfig {
  std::string type = "hinge";  ///< hinge | slide
  double radius = 0.8;         ///< Hinge: distance handle - axis in the leaf plane [m]
  double tilt = 0.0;           ///< Turns the axis about the outward normal from vertical; ±π/2 = horizontal [rad]
  Side side = Side::Right;     ///< Hinge side as the robot sees it; for a flap: Right = below
  Sense sense = Sense::Pull;
  Vector3d slide_direction{0.0, -1.0, 0.0};  ///< Slide: opening direction in the leaf frame (x right, y into the wall, z up)
  double travel = 1.9;                       ///< End stop [rad or m]
  Vector2d at{0.0, 0.0};                     ///< Foot point of the handle on the wall plane, world [m]
  double yaw = 0.0;                          ///< [rad]
  double handle_height = 1.0;                ///< [m]
  double standoff = 0.06;                    ///< [m]
  HandleKind handle = HandleKind::Bar;
  BarOrientation bar = BarOrientation::Vertical;
  double handle_thickness = 0.02;   ///< [m]
  double handle_length = 0.12;      ///< [m]
  double mass = 20.0;               ///< [kg]
  std::optional<double> inertia{};  ///< Default: of a slab of that mass [kg m²]
  double coulomb = 1.0;
  double breakaway = 1.0;
  double viscous = 0.5;
  double stiffness = 0.0;
  double spring_reference = 0.0;
  double gravity_share = 0.0;
  int closer_size = 0;  ///< EN 1154 size 1-7, 0 = none; fills `closer`
  Closer closer{};
  Seal seal{};
  double front_width = 0.4;   ///< Drawer front [m]
  double front_height = 0.2;  ///< Drawer front [m]
  bool walls = true;          ///< Wall beside a door, cabinet body round a drawer

  bool operator==(const MechanismConfig&) const = default;
};

/// Builds geometry, dynamics and surroundings.
/// @throws ConfigError
[[nodiscard]] Mechanism make_mechanism(const MechanismConfig& config);

/// Reads one row of a door table (columns of the door table reference in campaigns/doors.md), seen from the -y side.
/// @throws ConfigError, IoError  with file, line, column, value and what is allowed
[[nodiscard]] Mechanism load_door(const std::filesystem::path& csv, const std::string& id);

/// All ids of a door table, in file order.
[[nodiscard]] std::vector<std::string> list_doors(const std::filesystem::path& csv);

/// Where a robot starts in front of a door of a table (`approach_*` columns), heading towards the handle.
[[nodiscard]] BasePose door_approach(const std::filesystem::path& csv, const std::string& id);

}  // namespace ajar
