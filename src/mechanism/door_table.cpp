#include <algorithm>
#include <cmath>
#include <set>

#include "ajar/core/error.hpp"
#include "ajar/mechanism/builders.hpp"
#include "closers.hpp"
#include "table.hpp"

namespace ajar {
namespace {

constexpr double kWallWidth = 1.6;      // modelled to either side of an opening, beyond it nothing reaches [m]
constexpr double kWallHeight = 2.1;     // [m]
constexpr double kMinThickness = 0.01;  // a chain-link gate has a leaf of wires; its frame has this [m]
constexpr double kPostHeight = 0.1;     // a gate's posts stand above its leaf by this [m]

// What stands in `handle_type`: how it is held, how its bar runs and its length where the table has none [m].
struct HandleWord {
  const char* word;
  HandleKind kind;
  BarOrientation bar;
  double length;
};
// Levers and lifting handles lie, pulls stand; of a ring one holds the hanging part. Lengths of usual fittings.
constexpr HandleWord kHandleWords[] = {
    {"lever", HandleKind::Bar, BarOrientation::Horizontal, 0.12},
    {"pull", HandleKind::Bar, BarOrientation::Vertical, 0.15},
    {"bar", HandleKind::Bar, BarOrientation::Vertical, 0.30},
    {"paddle", HandleKind::Bar, BarOrientation::Vertical, 0.10},
    {"ring", HandleKind::Bar, BarOrientation::Horizontal, 0.05},
    {"fork_latch", HandleKind::Bar, BarOrientation::Horizontal, 0.036},
    {"knob", HandleKind::Knob, BarOrientation::Vertical, 0.05},
    {"slide_latch_knob", HandleKind::Knob, BarOrientation::Vertical, 0.02},
    {"drop_bolt_knob", HandleKind::Knob, BarOrientation::Vertical, 0.03},
    {"flush_recess", HandleKind::Recess, BarOrientation::Vertical, 0.10},
};

const HandleWord& handle_word(const RowReader& row) {
  const std::string& word = row.text("handle_type");
  std::string known;
  for (const HandleWord& entry : kHandleWords) {
    if (word == entry.word) return entry;
    known += (known.empty() ? "" : ", ") + std::string(entry.word);
  }
  row.fail("handle_type", known);
}

Handle read_handle(const RowReader& row, const Mechanism& mechanism) {
  const HandleWord& word = handle_word(row);
  Handle handle;
  handle.kind = word.kind;
  handle.normal = -Vector3d::UnitY();
  if (row.blank("grip_n_x")) {  // a handle on the far side only: the place where one would look for it
    handle.kind = HandleKind::None;
    handle.position = row.vector("grip_p");
    handle.position.y() = std::min(handle.position.y(), mechanism.com.y() - 0.5 * row.positive("leaf_thickness_m"));
  } else {
    handle.position = row.vector("grip_n");
  }
  const bool lifting = row.text("motion_from_minus_y") == "pull" && std::abs(mechanism.axis.z()) < 0.5;
  const bool lies = word.bar == BarOrientation::Horizontal || lifting;
  handle.bar = lies ? Vector3d::UnitX() : Vector3d::UnitZ();
  handle.standoff = row.number_or("grip_standoff_m", 0.0);
  const bool holdable = handle.kind == HandleKind::Bar || handle.kind == HandleKind::Knob;
  handle.thickness = holdable ? row.positive("grip_thickness_m") : 0.0;
  handle.length = row.number_or("lever_length_m", word.length);
  return handle;
}

// Size n of a closer's name "... ENn", 0 if it has none.
int closer_size(const std::string& name) {
  const std::size_t at = name.rfind(" EN");
  if (at == std::string::npos || at + 4 != name.size()) return 0;
  const int size = name[at + 3] - '0';
  return size >= 1 && size <= 7 ? size : 0;
}

void read_joint(const RowReader& row, Mechanism& out) {
  const std::string& type = row.text("joint_type");
  if (type != "hinge" && type != "slide") row.fail("joint_type", "hinge, slide");
  out.kind = type == "hinge" ? JointKind::Hinge : JointKind::Slide;
  const Vector3d axis = row.vector("axis");
  if (axis.norm() < 1e-6) row.fail("axis_x", "an axis that is not zero");
  out.axis = axis.normalized();
  out.point = row.vector("axis_pt");
  out.travel = row.number("q_max") - row.number("q_min");
  if (out.travel <= 0.0) row.fail("q_max", "> q_min");
  out.stop_time_constant = row.positive("limit_time_const_s");
}

void read_dynamics(const RowReader& row, Mechanism& out) {
  out.mass = row.positive("moving_mass_kg");
  out.com = row.vector("com");
  if (out.kind == JointKind::Slide) {
    out.inertia = out.mass;
  } else {
    // Some rows carry most of their mass in the handles; a slab of that mass is the better door.
    const bool suspect = row.number("mass_distribution_suspect") != 0.0;
    out.inertia = row.positive(suspect ? "inertia_uniform_slab_kgm2" : "inertia_kgm2");
  }
  out.armature = row.not_negative("armature");
  out.viscous = row.not_negative("damping");
  out.coulomb = row.not_negative("frictionloss");
  out.breakaway = 1.0;
  out.stiffness = row.not_negative("stiffness");
  out.spring_reference = row.number_or("springref", 0.0);
  // A rising hinge lifts the leaf in proportion to the angle; any other vertical axis feels no weight.
  const bool rising = row.number_or("rise_m_per_rad", 0.0) > 0.0;
  out.constant_closing = rising ? row.number("gravity_at_closed") : 0.0;
  out.gravity_share = rising ? 0.0 : 1.0;
  const int size = closer_size(row.text("closer"));
  if (size > 0) out.closer.closing_damping = closing_damping_of_size(size);
}

Box box_between(const Vector3d& lower, const Vector3d& upper) {
  Box box;
  box.pose.translation() = 0.5 * (lower + upper);
  box.half_extents = 0.5 * (upper - lower);
  return box;
}

// Where the closed leaf stands along x: on its joint if it slides, in the middle of an opening that it fills, else
// (one of a pair) from its hinge inwards.
double leaf_centre_x(const RowReader& row, const Mechanism& m, double width) {
  if (m.kind == JointKind::Slide || std::abs(m.axis.x()) > 0.5) return m.point.x();
  const double left = row.number("jamb_left_x");
  const double right = row.number("jamb_right_x");
  if (width > 0.8 * (right - left)) return 0.5 * (left + right);
  return m.point.x() + std::copysign(0.5 * width, m.handle.position.x() - m.point.x());
}

void add_leaf(const RowReader& row, Mechanism& out) {
  const double width = row.positive("leaf_width_m");
  const double height = row.positive("leaf_height_m");
  const double thickness = std::max(kMinThickness, row.positive("leaf_thickness_m"));
  const double x = leaf_centre_x(row, out, width);
  const double y = out.kind == JointKind::Slide ? out.point.y() : 0.0;
  const double z = std::max(out.com.z(), 0.5 * height + 0.005);
  const Vector3d half(0.5 * width, 0.5 * thickness, 0.5 * height);
  const Vector3d centre(x, y, z);
  out.leaf.push_back(box_between(centre - half, centre + half));
  if (row.text("family") == "swing_double") {  // the other leaf of the pair stays shut
    const double middle = 0.5 * (row.number("jamb_left_x") + row.number("jamb_right_x"));
    const Vector3d other(2.0 * middle - x, y, z);
    out.world.push_back(box_between(other - half, other + half));
    // The shut leaf is the frame on its side.
    if (out.doorway) {
      (other.x() < x ? out.doorway->left : out.doorway->right).x() = other.x() + std::copysign(half.x(), x - other.x());
    }
  }
}

// The opening as one sees it from the robot's side; doors only, a sliding or lifting leaf has no frame to pass.
void add_doorway(const RowReader& row, Mechanism& out) {
  if (out.kind != JointKind::Hinge || std::abs(out.axis.z()) < 0.9) return;
  const double y = row.number("wall_y_min");
  out.doorway = Doorway{{row.number("jamb_left_x"), y, 0.0}, {row.number("jamb_right_x"), y, 0.0}};
}

// From an opening's edge outwards: the frame up to the wall, then the wall; a gate has posts instead.
void add_surroundings(const RowReader& row, Mechanism& out) {
  const double y0 = row.number("wall_y_min");
  const double y1 = row.number("wall_y_max");
  if (y1 <= y0) row.fail("wall_y_max", "> wall_y_min");
  const auto add = [&](double from, double to, double height) {
    if (std::abs(to - from) < 1e-4) return;
    out.world.push_back(box_between({std::min(from, to), y0, 0.0}, {std::max(from, to), y1, height}));
  };
  for (const double side : {-1.0, 1.0}) {
    const double jamb = row.number(side < 0.0 ? "jamb_left_x" : "jamb_right_x");
    const char* column = side < 0.0 ? "wall_left_x" : "wall_right_x";
    if (row.blank(column)) {
      add(jamb, jamb + side * (y1 - y0), row.positive("leaf_height_m") + kPostHeight);
      continue;
    }
    const double wall = row.number(column);
    if (side * (wall - jamb) > 0.0) add(jamb, wall, kWallHeight);
    add(wall, wall + side * kWallWidth, kWallHeight);
  }
}

const Table::Row& find_row(const Table& table, const std::filesystem::path& csv, const std::string& id) {
  const std::size_t column = table.column("id");
  for (const Table::Row& row : table.rows()) {
    if (row.cells[column] == id) return row;
  }
  throw ConfigError(csv.string() + ": id: \"" + id + "\": allowed: " + table.rows().front().cells[column] + " .. " +
                    table.rows().back().cells[column] + ", " + std::to_string(table.rows().size()) + " rows");
}

// The row's own statement of its direction must be the one that axis and grip give.
void check_direction(const RowReader& row, const Mechanism& m) {
  const std::string& motion = row.text("motion_from_minus_y");
  if (motion != "pull" && motion != "push" && motion != "slide") row.fail("motion_from_minus_y", "pull, push, slide");
  const double y = handle_motion(m, 0.0).direction.y();
  const bool agrees = motion == "pull" ? y < -0.5 : motion == "push" ? y > 0.5 : std::abs(y) < 0.5;
  if (!agrees) row.fail("motion_from_minus_y", "the direction that axis and grip give");
}

}  // namespace

Mechanism load_door(const std::filesystem::path& csv, const std::string& id) {
  const Table table(csv);
  const Table::Row& cells = find_row(table, csv, id);
  const RowReader row(table, cells);
  Mechanism out;
  out.name = id;
  read_joint(row, out);
  read_dynamics(row, out);
  out.handle = read_handle(row, out);
  out.latch = row.text("latch") == "none" ? "" : row.text("latch");
  out.latched = !out.latch.empty();
  add_doorway(row, out);
  add_leaf(row, out);
  add_surroundings(row, out);
  try {
    out.validate();
  } catch (const ConfigError& error) {
    table.fail(cells.line, error.what());
  }
  check_direction(row, out);
  return out;
}

std::vector<std::string> list_doors(const std::filesystem::path& csv) {
  const Table table(csv);
  const std::size_t column = table.column("id");
  std::vector<std::string> ids;
  std::set<std::string> seen;
  for (const Table::Row& row : table.rows()) {
    const std::string& id = row.cells[column];
    if (id.empty() || !seen.insert(id).second) table.fail(row, "id", id, "a name that no other row has");
    ids.push_back(id);
  }
  return ids;
}

BasePose door_approach(const std::filesystem::path& csv, const std::string& id) {
  const Table table(csv);
  const RowReader row(table, find_row(table, csv, id));
  const std::string grip = row.blank("grip_n_x") ? "grip_p" : "grip_n";
  const double x = row.number("approach_x");
  const double y = row.number("approach_y");
  return {x, y, std::atan2(row.number(grip + "_y") - y, row.number(grip + "_x") - x)};
}

}  // namespace ajar
