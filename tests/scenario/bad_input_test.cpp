// Strategy: golden messages. Each case is a small file with one mistake; the message must name file, line, key, value and
// what is allowed, word for word. "FILE" stands for the path. What the robot's own description may do wrong is checked with
// the model.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "ajar/core/error.hpp"
#include "ajar/scenario/scenario.hpp"

namespace ajar {
namespace {

namespace fs = std::filesystem;

struct Case {
  std::string name;
  std::string text;
  std::string message;
  std::vector<std::string> overrides{};
};

std::ostream& operator<<(std::ostream& out, const Case& c) { return out << c.name; }

class BadScenario : public ::testing::TestWithParam<Case> {};

std::string with_file(std::string text, const std::string& file) {
  for (auto at = text.find("FILE"); at != std::string::npos; at = text.find("FILE", at + file.size()))
    text.replace(at, 4, file);
  return text;
}

TEST_P(BadScenario, IsRefusedWithFileLineKeyValueAndWhatIsAllowed) {
  const fs::path file =
      fs::temp_directory_path() / ("ajar_bad_" + std::to_string(::getpid()) + "_" + GetParam().name + ".toml");
  std::ofstream(file) << GetParam().text;
  std::string message = "nothing was thrown";
  try {
    static_cast<void>(load_scenario(file, GetParam().overrides));
  } catch (const Error& error) {
    message = error.what();
  }
  fs::remove(file);
  EXPECT_EQ(message, with_file(GetParam().message, file.string()));
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

const std::string kHinge = "[mechanism]\ntype = \"hinge\"\n";
const std::string kForms = "exactly one of type, from and mjcf must be given; ";

INSTANTIATE_TEST_SUITE_P(
    Golden, BadScenario,
    ::testing::Values(
        Case{"Empty", "", "FILE:1: the file is empty; at least [mechanism] is needed"},
        Case{"OnlyBlanks", " \n\n", "FILE:1: the file is empty; at least [mechanism] is needed"},
        Case{"NoMechanism", "seed = 1\n",
             "FILE:1: mechanism: missing; a table [mechanism] with type, from or mjcf is needed"},
        Case{"MechanismIsNoTable", "mechanism = 3\n", "FILE:1: mechanism = 3: allowed: a table with type, from or mjcf"},
        Case{"NoForm", "\n[mechanism]\nmass_kg = 3\n", "FILE:2: mechanism: " + kForms + "none is"},
        Case{"TwoForms", kHinge + "from = \"doors.csv\"\nid = \"a\"\n",
             "FILE:3: mechanism.from: " + kForms + "type is there as well"},
        Case{"UnknownKey", kHinge + "radios_m = 0.8\n",
             "FILE:3: mechanism.radios_m: unknown key; the nearest valid name is mechanism.radius_m"},
        Case{"UnitForgotten", kHinge + "mass = 8\n",
             "FILE:3: mechanism.mass: unknown key; the nearest valid name is mechanism.mass_kg"},
        Case{"WrongTable", kHinge + "\n[control]\nspeed = 0.1\n",
             "FILE:5: control.speed: unknown key; the nearest valid name is control.force.speed"},
        Case{"UnknownTable", kHinge + "[belive]\ndirection_error_deg = 3\n",
             "FILE:3: belive: unknown key; the nearest valid name is belief"},
        Case{"TableExpected", "plant = 1\n" + kHinge, "FILE:1: plant = 1: allowed: a table [plant]"},
        Case{"WrongType", kHinge + "radius_m = \"wide\"\n",
             "FILE:3: mechanism.radius_m = \"wide\": allowed: from 0.05 … 3 m"},
        Case{"WrongWord", kHinge + "side = \"up\"\n", "FILE:3: mechanism.side = \"up\": allowed: \"left\" or \"right\""},
        Case{"NumberAsWord", kHinge + "side = 2\n", "FILE:3: mechanism.side = 2: allowed: \"left\" or \"right\""},
        Case{"NotFinite", kHinge + "mass_kg = nan\n", "FILE:3: mechanism.mass_kg = nan: allowed: above 0 … 2000 kg"},
        Case{"Infinite", kHinge + "viscous = inf\n", "FILE:3: mechanism.viscous = inf: allowed: at least 0 N m s/rad"},
        Case{"NegativeMass", kHinge + "mass_kg = -5\n", "FILE:3: mechanism.mass_kg = -5: allowed: above 0 … 2000 kg"},
        Case{"ZeroAxis", "[mechanism]\ntype = \"slide\"\nslide_direction = [0, 0, 0]\n",
             "FILE:3: mechanism.slide_direction = [0, 0, 0]: allowed: a list of 3 finite numbers, not all zero"},
        Case{"ShortAxis", "[mechanism]\ntype = \"slide\"\nslide_direction = [0, 1]\n",
             "FILE:3: mechanism.slide_direction = [0, 1]: allowed: a list of 3 finite numbers, not all zero"},
        Case{"HandleInsideTheWall", kHinge + "standoff_m = -0.02\n",
             "FILE:3: mechanism.standoff_m = -0.02: allowed: above 0 … 0.5 m"},
        Case{"KeyOfTheOtherType", "[mechanism]\ntype = \"slide\"\nradius_m = 0.8\n",
             "FILE:3: mechanism.radius_m: does not belong to a mechanism of type slide"},
        Case{"KeyOfTheOtherForm", "[mechanism]\nmjcf = \"a.xml\"\njoint = \"j\"\nhandle = \"h\"\nmass_kg = 3\n",
             "FILE:5: mechanism.mass_kg: does not belong to a mechanism from a model"},
        Case{"KeyMissing", "[mechanism]\nmjcf = \"a.xml\"\njoint = \"j\"\n",
             "FILE:1: mechanism.handle: missing; allowed: a text in quotes"},
        Case{"FlagAsNumber", kHinge + "walls = 1\n", "FILE:3: mechanism.walls = 1: allowed: true or false"},
        Case{"CloserSize", kHinge + "closer_size = 2.5\n",
             "FILE:3: mechanism.closer_size = 2.5: allowed: a whole number from 0 … 7"},
        Case{"NegativeSeed", "seed = -1\n" + kHinge, "FILE:1: seed = -1: allowed: a whole number at least 0"},
        Case{"Rate", kHinge + "[control]\nrate_hz = 0\n", "FILE:4: control.rate_hz = 0: allowed: from 20 … 1000 Hz"},
        Case{"Belief", kHinge + "[belief]\ndirection_error_deg = \"some\"\n",
             "FILE:4: belief.direction_error_deg = \"some\": allowed: from 0 … 180 ° or \"none\""},
        Case{"CurvatureTold", kHinge + "[belief]\ncurvature = 1.2\n", "FILE:4: belief.curvature = 1.2: allowed: only 0 1/m"},
        Case{"FaultKind", kHinge + "[[plant.fault]]\nkind = \"fire\"\n",
             "FILE:4: plant.fault.kind = \"fire\": allowed: \"sensor_nan\", \"sensor_silent\", \"base_blocked\", "
             "\"grasp_lost\", \"door_locked\" or \"joint_nan\""},
        Case{"FaultWithoutKind", kHinge + "[[plant.fault]]\ntime_s = 2\n",
             "FILE:3: plant.fault.kind: missing; allowed: \"sensor_nan\", \"sensor_silent\", \"base_blocked\", "
             "\"grasp_lost\", \"door_locked\" or \"joint_nan\""},
        Case{"TwoClosers", kHinge + "closer_size = 3\n[mechanism.closer]\nmoment = 4\n",
             "FILE: mechanism.closer_size = 3: allowed: either closer_size or [mechanism.closer], not both"},
        Case{"ForceAboveAbort", kHinge + "[limits]\nforce_N = 200\n",
             "FILE: limits.force_N = 200: allowed: below abort_force_N, 150"},
        Case{"Override", kHinge, "--set: mechanism.mass_kg = -1: allowed: above 0 … 2000 kg", {"mechanism.mass_kg=-1"}},
        Case{"OverrideUnknown",
             kHinge,
             "--set: goal.openning_m: unknown key; the nearest valid name is goal.opening_m",
             {"goal.openning_m=1"}},
        Case{"OverrideNoValue", kHinge, "--set mechanism.mass_kg: allowed: KEY=VALUE", {"mechanism.mass_kg"}}),
    [](const auto& one) { return one.param.name; });

TEST(BadScenarioFile, NoTomlNamesTheLine) {
  const fs::path file = fs::temp_directory_path() / ("ajar_bad_syntax_" + std::to_string(::getpid()) + ".toml");
  std::ofstream(file) << "seed = 1\n[mechanism\n";
  try {
    static_cast<void>(load_scenario(file));
    ADD_FAILURE() << "nothing was thrown";
  } catch (const ConfigError& error) {
    EXPECT_EQ(std::string(error.what()).rfind(file.string() + ":2: not TOML: ", 0), 0U) << error.what();
  }
  fs::remove(file);
}

TEST(BadScenarioFile, MissingFileAndFolderAreNamed) {
  const auto message = [](const fs::path& path) {
    try {
      static_cast<void>(load_scenario(path));
    } catch (const IoError& error) {
      return std::string(error.what());
    }
    return std::string("nothing was thrown");
  };
  EXPECT_EQ(message("/no/such/place.toml"), "/no/such/place.toml: no such file");
  EXPECT_EQ(message("/tmp"), "/tmp: is a directory; allowed: a TOML file");
}

}  // namespace
}  // namespace ajar
