// Strategy: the geometry of built mechanisms by what a person standing in front would say (left, right, towards me,
// above), the door table against its own columns for grip direction and force, broken tables by their message.
#include "ajar/mechanism/builders.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <sstream>

#include "ajar/core/error.hpp"
#include "ajar/core/random.hpp"
#include "ajar/core/so3.hpp"

namespace {

using namespace ajar;
constexpr double kPi = std::numbers::pi;

std::filesystem::path doors_csv() { return std::filesystem::path(AJAR_SOURCE_DIR) / "campaigns" / "doors.csv"; }

// Position relative to the closed handle in the leaf frame: x right, y into the wall, z up, as the robot sees it.
Vector3d seen(const MechanismConfig& config, const Vector3d& p_W) {
  return Eigen::AngleAxisd(-config.yaw, Vector3d::UnitZ()) * (p_W - make_mechanism(config).handle.position);
}

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Builders, PullMovesTheHandleToTheRobotAndPushAway) {
  Random random(1);
  for (const Side side : {Side::Left, Side::Right}) {
    for (const Sense sense : {Sense::Pull, Sense::Push}) {
      for (int i = 0; i < 10; ++i) {
        MechanismConfig config{.side = side, .sense = sense};
        config.yaw = random.uniform(-kPi, kPi);
        config.at = {random.uniform(-2.0, 2.0), random.uniform(-2.0, 2.0)};
        config.tilt = random.uniform(-kPi / 2.0, kPi / 2.0);
        const Mechanism m = make_mechanism(config);
        const double out = handle_motion(m, 0.0).direction.dot(m.handle.normal);
        EXPECT_GT(out * (sense == Sense::Pull ? 1.0 : -1.0), 0.95);
        const Vector3d pull_foot = seen(config, m.point) - Vector3d(0.0, config.standoff, 0.0);
        EXPECT_NEAR(Vector3d(pull_foot.x(), 0.0, pull_foot.z()).norm(), config.radius, 1e-12);
      }
    }
  }
}

TEST(Builders, HingeStandsOnItsSideAndFlapsHangAboveOrBelow) {
  MechanismConfig config{.radius = 0.5, .yaw = 0.7};
  config.at = {1.0, -2.0};
  config.side = Side::Right;
  EXPECT_NEAR(seen(config, make_mechanism(config).point).x(), 0.5, 1e-12);
  config.side = Side::Left;
  EXPECT_NEAR(seen(config, make_mechanism(config).point).x(), -0.5, 1e-12);
  for (const double tilt : {kPi / 2.0, -kPi / 2.0, 1.5708, -1.5708}) {
    config.tilt = tilt;
    config.side = Side::Right;
    EXPECT_NEAR(seen(config, make_mechanism(config).point).z(), -0.5, 1e-5) << tilt;
    config.side = Side::Left;
    EXPECT_NEAR(seen(config, make_mechanism(config).point).z(), 0.5, 1e-5) << tilt;
    EXPECT_NEAR(make_mechanism(config).axis.z(), 0.0, 1e-5);
  }
}

TEST(Builders, TiltTurnsTheAxisAboutTheOutwardNormal) {
  MechanismConfig config{.yaw = 0.4};
  const Vector3d upright = make_mechanism(config).axis;
  const Vector3d normal = make_mechanism(config).handle.normal;
  for (const double tilt : {-1.2, -0.3, 0.05, 0.9}) {
    config.tilt = tilt;
    EXPECT_LT((make_mechanism(config).axis - exp_so3(tilt * normal) * upright).norm(), 1e-12);
  }
}

TEST(Builders, HandleStandsInFrontOfTheLeafFace) {
  MechanismConfig config{.yaw = -1.1, .standoff = 0.07};
  for (const char* type : {"hinge", "slide"}) {
    for (const double tilt : {0.0, 0.8, kPi / 2.0}) {
      config.type = type;
      config.tilt = tilt;
      const Mechanism m = make_mechanism(config);
      const Vector3d p = m.leaf.front().pose.inverse() * m.handle.position;
      EXPECT_NEAR(-p.y() - m.leaf.front().half_extents.y(), 0.07, 1e-12);
      EXPECT_LT(std::abs(p.x()), m.leaf.front().half_extents.x());
      EXPECT_LT(std::abs(p.z()), m.leaf.front().half_extents.z());
    }
  }
}

TEST(Builders, FlapFeelsItsWeight) {
  MechanismConfig config{.radius = 0.45, .tilt = kPi / 2.0, .mass = 8.0, .gravity_share = 1.0};
  config.side = Side::Right;  // hinge below: hangs open, so that its weight helps more and more
  const Mechanism m = make_mechanism(config);
  const Vector3d arm = m.com - m.point;
  const double level = resisting_force(m, kPi / 2.0, 0.0);
  EXPECT_NEAR(level, -8.0 * 9.81 * arm.z(), 1e-9);
  config.side = Side::Left;
  EXPECT_GT(resisting_force(make_mechanism(config), kPi / 2.0, 0.0), 0.0);
}

TEST(Builders, SlideOpensAlongItsDirection) {
  MechanismConfig config{.type = "slide", .slide_direction = {3.0, -4.0, 0.0}, .yaw = 0.5};
  const Mechanism m = make_mechanism(config);
  const Vector3d expected = Eigen::AngleAxisd(0.5, Vector3d::UnitZ()) * Vector3d(0.6, -0.8, 0.0);
  EXPECT_LT((handle_motion(m, 0.2).direction - expected).norm(), 1e-12);
  EXPECT_EQ(m.inertia, config.mass);
}

TEST(Builders, SlabInertiaIsThatOfALeafThatHangsAtItsEdge) {
  const MechanismConfig config{.radius = 0.865, .mass = 20.0};
  const double width = 2.0 * make_mechanism(config).leaf.front().half_extents.x();
  // Integral of s² + y² over the leaf, which begins 1 cm from the axis and lies 0 .. 4 cm behind it.
  const double exact = 20.0 * ((std::pow(width + 0.01, 3) - std::pow(0.01, 3)) / (3.0 * width) + 0.04 * 0.04 / 3.0);
  EXPECT_NEAR(make_mechanism(config).inertia, exact, 1e-9);
}

TEST(Builders, CloserSizesCloseWithinTheirBandAndOpenBelowTheirMaximum) {
  // EN 1154: closing moment 0-4 deg (lower, upper) and largest opening moment [N m].
  const double bands[7][3] = {{9, 13, 26},  {13, 18, 36},  {18, 26, 47},  {26, 37, 62},
                              {37, 54, 83}, {54, 87, 134}, {87, 140, 215}};
  for (int size = 1; size <= 7; ++size) {
    MechanismConfig config;
    config.closer_size = size;
    const Mechanism m = make_mechanism(config);
    EXPECT_GE(resisting_force(m, 0.0, 0.0), bands[size - 1][0]);
    EXPECT_LE(resisting_force(m, 0.0, 0.0), bands[size - 1][1]);
    EXPECT_NEAR(resisting_force(m, kPi / 2.0, 0.0), bands[size - 1][2], 1e-9);
    EXPECT_GE(m.closer.closing_damping, 40.0);
    EXPECT_LE(m.closer.closing_damping, 120.0);
  }
}

TEST(Builders, EqualConfigsCompareEqual) {
  MechanismConfig config;
  EXPECT_EQ(config, MechanismConfig{});
  config.seal.force = 1.0;
  EXPECT_NE(config, MechanismConfig{});
}

TEST(Builders, BadConfigNamesKeyValueAndRule) {
  const auto message = [](const std::function<void(MechanismConfig&)>& spoil) {
    MechanismConfig config;
    spoil(config);
    return message_of([&] { (void)make_mechanism(config); });
  };
  EXPECT_EQ(message([](auto& c) { c.mass = -2.0; }), "mechanism.mass: -2: allowed: > 0");
  EXPECT_EQ(message([](auto& c) { c.type = "door"; }), "mechanism.type: \"door\": allowed: hinge, slide");
  EXPECT_NE(message([](auto& c) { c.slide_direction.setZero(); }).find("slide_direction"), std::string::npos);
  EXPECT_NE(message([](auto& c) { c.radius = std::nan(""); }).find("mechanism.radius: nan"), std::string::npos);
  EXPECT_NE(message([](auto& c) { c.closer_size = 8; }).find("closer_size: 8"), std::string::npos);
  EXPECT_NE(message([](auto& c) { c.travel = 0.0; }).find("travel: 0"), std::string::npos);
  EXPECT_NE(message([](auto& c) { c.standoff = -0.05; }).find("standoff: -0.05"), std::string::npos);
}

// Column of a row of the table, read independently of the loader.
std::string cell(const std::string& id, const std::string& column) {
  std::ifstream in(doors_csv());
  std::string line;
  std::getline(in, line);
  const auto split = [](const std::string& text) {
    std::vector<std::string> out;
    std::stringstream stream(text + ",");
    for (std::string part; std::getline(stream, part, ',');) out.push_back(part);
    return out;
  };
  const std::vector<std::string> header = split(line);
  const auto at = static_cast<std::size_t>(std::find(header.begin(), header.end(), column) - header.begin());
  while (std::getline(in, line)) {
    const std::vector<std::string> row = split(line);
    if (row.front() == id) return row.at(at);
  }
  return "";
}

TEST(DoorTable, EveryDoorMovesItsGripAsItsRowSays) {
  const std::vector<std::string> ids = list_doors(doors_csv());
  ASSERT_EQ(ids.size(), 40u);
  for (const std::string& id : ids) {
    const Mechanism m = load_door(doors_csv(), id);
    const Vector3d expected(std::stod(cell(id, "grip_dir_x")), std::stod(cell(id, "grip_dir_y")),
                            std::stod(cell(id, "grip_dir_z")));
    EXPECT_LT((handle_motion(m, 0.0).direction - expected).norm(), 2e-4) << id;  // five digits in the table
    if (m.kind == JointKind::Hinge) {
      EXPECT_NEAR(handle_motion(m, 0.0).radius, std::stod(cell(id, "grip_radius_m")), 2e-4) << id;
    }
  }
}

TEST(DoorTable, EveryDoorNeedsTheForceOfItsRow) {
  for (const std::string& id : list_doors(doors_csv())) {
    const Mechanism m = load_door(doors_csv(), id);
    const double closed = std::stod(cell(id, "grip_force_closed_N"));
    const double open = std::stod(cell(id, "grip_force_qmax_N"));
    // 2 %: positions of the table are rounded to 0.1 mm, which the tilt-up's 9 mm lever of weight feels most.
    EXPECT_NEAR(handle_force_needed(m, 0.0), closed, 0.02 * std::abs(closed) + 0.01) << id;
    EXPECT_NEAR(handle_force_needed(m, m.travel), open, 0.02 * std::abs(open) + 0.01) << id;
  }
}

TEST(DoorTable, RecessesOfferNothingToGripAndHandlesDo) {
  int recesses = 0;
  int sized = 0;
  for (const std::string& id : list_doors(doors_csv())) {
    const Mechanism m = load_door(doors_csv(), id);
    const bool recess = cell(id, "handle_type") == "flush_recess";
    recesses += recess ? 1 : 0;
    EXPECT_EQ(m.handle.kind == HandleKind::Recess, recess) << id;
    EXPECT_EQ(m.handle.thickness == 0.0, recess) << id;
    EXPECT_EQ(m.handle.kind == HandleKind::Knob, cell(id, "handle_type").find("knob") != std::string::npos) << id;
    EXPECT_EQ(m.latched, cell(id, "latch") != "none") << id;
    const bool is_sized = cell(id, "closer").find(" EN") != std::string::npos;
    sized += is_sized ? 1 : 0;
    EXPECT_EQ(m.closer.closing_damping >= 40.0, is_sized) << id;
  }
  EXPECT_EQ(recesses, 3);
  EXPECT_EQ(sized, 7);
}

TEST(DoorTable, ClosedLeafFillsTheOpeningBehindTheGrip) {
  for (const std::string& id : list_doors(doors_csv())) {
    const Mechanism m = load_door(doors_csv(), id);
    const Box& leaf = m.leaf.front();
    const Vector3d p = leaf.pose.inverse() * m.handle.position;
    EXPECT_LT(std::abs(p.x()), leaf.half_extents.x() + 0.02) << id;  // fork and bolt grips reach past their leaf
    EXPECT_LE(p.y(), -leaf.half_extents.y() + 1e-9) << id;
    if (m.kind == JointKind::Hinge) {
      EXPECT_GT(leaf.pose.translation().x() - leaf.half_extents.x(), std::stod(cell(id, "jamb_left_x")) - 0.01) << id;
      EXPECT_LT(leaf.pose.translation().x() + leaf.half_extents.x(), std::stod(cell(id, "jamb_right_x")) + 0.01) << id;
    }
    EXPECT_GE(m.world.size(), 2u) << id;
  }
}

TEST(DoorTable, ApproachHeadsForTheGrip) {
  for (const std::string& id : list_doors(doors_csv())) {
    const BasePose start = door_approach(doors_csv(), id);
    const Vector3d grip = load_door(doors_csv(), id).handle.position;
    const Vector2d way(grip.x() - start.x, grip.y() - start.y);
    EXPECT_GT(way.norm(), 1.0) << id;
    EXPECT_NEAR(std::cos(start.yaw), way.x() / way.norm(), 1e-9) << id;
    EXPECT_NEAR(std::sin(start.yaw), way.y() / way.norm(), 1e-9) << id;
  }
}

class BrokenTable : public testing::Test {
 protected:
  BrokenTable() { std::filesystem::create_directories(folder); }
  ~BrokenTable() override { std::filesystem::remove_all(folder); }

  // The table with one cell of the first door replaced.
  std::string with(const std::string& column, const std::string& value) {
    std::ifstream in(doors_csv());
    std::string header;
    std::string row;
    std::getline(in, header);
    std::getline(in, row);
    std::size_t skip = static_cast<std::size_t>(std::count(
        header.begin(), header.begin() + static_cast<std::ptrdiff_t>(("," + header).find("," + column + ",")), ','));
    std::size_t from = 0;
    while (skip-- > 0) from = row.find(',', from) + 1;
    row.replace(from, row.find(',', from) - from, value);
    return message(header + "\n" + row + "\n");
  }
  std::string message(const std::string& text) {
    const std::filesystem::path file = folder / "broken_doors.csv";
    std::ofstream(file) << text;
    const std::string what = message_of([&] { (void)load_door(file, "db0002_swing_single"); });
    const std::size_t at = what.find("broken_doors.csv");
    return at == std::string::npos ? what : what.substr(at);
  }

  // One of its own: tests run side by side.
  std::filesystem::path folder =
      std::filesystem::path(testing::TempDir()) / ("ajar_broken_table_" + std::to_string(::getpid()));
};

TEST_F(BrokenTable, MessagesGiveLineColumnValueAndRule) {
  EXPECT_EQ(with("moving_mass_kg", "-3"), "broken_doors.csv:2: moving_mass_kg: -3: allowed: > 0");
  EXPECT_EQ(with("moving_mass_kg", "nan"), "broken_doors.csv:2: moving_mass_kg: nan: allowed: a finite number");
  EXPECT_EQ(with("damping", "12x"), "broken_doors.csv:2: damping: 12x: allowed: a finite number");
  EXPECT_EQ(with("damping", ""), "broken_doors.csv:2: damping: blank: allowed: a finite number");
  EXPECT_EQ(with("axis_z", "0"), "broken_doors.csv:2: axis_x: 0: allowed: an axis that is not zero");
  EXPECT_EQ(with("q_max", "0"), "broken_doors.csv:2: q_max: 0: allowed: > q_min");
  EXPECT_NE(with("handle_type", "rope").find(":2: handle_type: rope: allowed: lever, pull"), std::string::npos);
  EXPECT_NE(with("motion_from_minus_y", "push").find(":2: motion_from_minus_y: push"), std::string::npos);
  EXPECT_EQ(with("joint_type", "ball"), "broken_doors.csv:2: joint_type: ball: allowed: hinge, slide");
}

TEST_F(BrokenTable, TooFewColumnsNoRowsAndNoTextAreRefused) {
  EXPECT_EQ(message("id,axis_x\ndb0002_swing_single\n"), "broken_doors.csv:2: 1 columns: allowed: 2 as in the header");
  EXPECT_EQ(message(""), "broken_doors.csv:1: empty file: allowed: a header row and one row per door");
  EXPECT_EQ(message("id,axis_x\n"), "broken_doors.csv:1: no rows: allowed: at least one row under the header");
  EXPECT_NE(message("id,axis_x\nother,1\n").find("id: \"db0002_swing_single\": allowed: other"), std::string::npos);
  EXPECT_EQ(message("id,axis_x\ndb0002_swing_single,1\n"), "broken_doors.csv:1: column joint_type is missing");
}

TEST(DoorTable, MissingFileAndDirectoryAreIoErrors) {
  EXPECT_THROW((void)load_door("/nowhere/doors.csv", "x"), IoError);
  EXPECT_THROW((void)list_doors(testing::TempDir()), IoError);
}

}  // namespace
