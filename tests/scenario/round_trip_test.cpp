// Strategy: whatever a file says must arrive in the structures and come out again unchanged. The dump of a scenario is read
// back and compared text by text (numbers are printed so that they read back to the same bits); every key is changed alone
// and exactly its own line of the dump must change, so no two keys share a field and none is dead; fields are counted by the
// compiler and compared with the keys, so a new field without a key fails. A few values are compared with hand-converted
// ones.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "../../src/scenario/key.hpp"
#include "ajar/scenario/scenario.hpp"

namespace ajar {
namespace {

namespace fs = std::filesystem;

class ScenarioFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("ajar_scenario_" + std::to_string(::getpid()) + "_" +
                                           ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  fs::path write(const std::string& text, const std::string& name = "s.toml") const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }
  Scenario read(const std::string& text, const std::vector<std::string>& overrides = {}) const {
    return load_scenario(write(text), overrides);
  }

  fs::path folder_;
};

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::string> out;
  for (std::string line; std::getline(in, line);) out.push_back(line);
  return out;
}

const std::string kHinge = "[mechanism]\ntype = \"hinge\"\n";
const std::string kSlide = "[mechanism]\ntype = \"slide\"\n";

TEST_F(ScenarioFiles, KeepsEveryBitThroughWritingAndReading) {
  for (const std::string& text : {kHinge, kSlide,
                                  kHinge + "tilt_deg = 12.3\nyaw_deg = 0.1\n[control]\nrate_hz = 333\ndelay_ms = "
                                           "7.7\n[[plant.fault]]\nkind = \"door_locked\"\ntime_s = 0.1\n"}) {
    const Scenario first = read(text);
    const std::string dump = to_toml(first);
    const Scenario second = load_scenario(write(dump, "again.toml"));
    EXPECT_EQ(to_toml(second), dump);
    EXPECT_EQ(second.mission.period, first.mission.period);
    EXPECT_EQ(second.mission.dead_time, first.mission.dead_time);
    EXPECT_EQ(second.mission.goal, first.mission.goal);
    EXPECT_EQ(second.mission.planner, first.mission.planner);
    EXPECT_EQ(second.mission.force, first.mission.force);
    EXPECT_EQ(second.plant, first.plant);
    EXPECT_EQ(second.start, first.start);
    EXPECT_EQ(second.mechanism.described.tilt, first.mechanism.described.tilt);
    EXPECT_EQ(second.mechanism.described.yaw, first.mechanism.described.yaw);
    EXPECT_EQ(second.mechanism.described.travel, first.mechanism.described.travel);
  }
}

TEST_F(ScenarioFiles, ExpressesAnyAngleSoThatItReadsBackToTheSameBits) {
  // Degrees cannot express every radian value; the loader moves to one that they can, and stays there.
  const scenario::Unit degrees{"°", scenario::kDegree, false};
  for (int i = 1; i < 2000; ++i) {
    double value = 0.001 * i * 1.2345678901234567;
    scenario::Key key;
    key.target = &value;
    key.unit = degrees;
    const double before = value;
    scenario::make_expressible(key);
    EXPECT_NEAR(value, before, 1e-15 * before);
    EXPECT_EQ(scenario::to_program(degrees, std::stod(scenario::number_text(degrees, value))), value);
  }
}

TEST_F(ScenarioFiles, ConvertsUnitsAsTheNamesSay) {
  const Scenario s = read(
      "seed = 7\n[mechanism]\ntype = \"hinge\"\nradius_m = 0.35\nside = \"left\"\ntravel_deg = 180\nmass_kg = 4\nhandle = "
      "\"knob\"\n"
      "bar = \"horizontal\"\nsense = \"push\"\nat_m = [1, 2.5]\n[mechanism.seal]\nforce = 3\nrange_deg = 18\n"
      "[belief]\ndirection_error_deg = 30\ncurvature = 0\n[plant]\nkind = "
      "\"kinematic\"\n[plant.perception]\nnormal_error_deg = -10\n"
      "[control]\nrate_hz = 125\ndelay_ms = 40\n[limits]\nforce_N = 60\ntime_s = 90\n[goal]\nopening_deg = 45\nopening_m = "
      "0.3\nto_the_stop = true\n");
  const double pi = std::acos(-1.0);
  EXPECT_EQ(s.seed, 7U);
  EXPECT_EQ(s.mechanism.described.radius, 0.35);
  EXPECT_EQ(s.mechanism.described.side, Side::Left);
  EXPECT_EQ(s.mechanism.described.sense, Sense::Push);
  EXPECT_EQ(s.mechanism.described.handle, HandleKind::Knob);
  EXPECT_EQ(s.mechanism.described.bar, BarOrientation::Horizontal);
  EXPECT_DOUBLE_EQ(s.mechanism.described.travel, pi);
  EXPECT_DOUBLE_EQ(s.mechanism.described.seal.range, pi / 10.0);
  EXPECT_EQ(s.mechanism.described.at, Vector2d(1.0, 2.5));
  EXPECT_DOUBLE_EQ(s.belief.direction_error.value(), pi / 6.0);
  EXPECT_EQ(s.plant.kind, "kinematic");
  EXPECT_DOUBLE_EQ(s.plant.perception.normal_error, -pi / 18.0);
  EXPECT_DOUBLE_EQ(s.mission.period, 0.008);
  EXPECT_DOUBLE_EQ(s.mission.dead_time, 0.04);
  EXPECT_DOUBLE_EQ(s.plant.delay, 0.04);
  EXPECT_EQ(s.mission.limits.force, 60.0);
  EXPECT_EQ(s.mission.force.force_limit, 60.0);
  EXPECT_EQ(s.mission.limits.time, 90.0);
  EXPECT_DOUBLE_EQ(s.mission.goal.opening_angle, pi / 4.0);
  EXPECT_EQ(s.mission.goal.opening_length, 0.3);
  EXPECT_TRUE(s.mission.goal.to_the_stop);
}

TEST_F(ScenarioFiles, TellsTheRobotNothingByDefault) {
  EXPECT_FALSE(read(kHinge).belief.direction_error.has_value());
  EXPECT_FALSE(read(kHinge + "[belief]\ndirection_error_deg = \"none\"\n").belief.direction_error.has_value());
}

/// Some other value that the key takes, as text.
std::string other_value(const scenario::Key& key) {
  const std::string now = scenario::value_text(key);
  if (std::holds_alternative<bool*>(key.target)) return now == "true" ? "false" : "true";
  if (std::holds_alternative<int*>(key.target) || std::holds_alternative<std::uint64_t*>(key.target))
    return std::to_string(std::stoll(now) + 1);
  if (std::holds_alternative<double*>(key.target)) {
    const double value = std::stod(now);
    double changed = value == 0.0 ? 0.01 : value * 1.01;
    if (changed > key.range.upper) changed = value * 0.99;
    return std::to_string(changed) == std::to_string(value) ? scenario::number_text({}, changed) : std::to_string(changed);
  }
  if (std::holds_alternative<std::optional<double>*>(key.target)) return "1.5";
  if (!key.words.empty()) return now == '"' + key.words.back() + '"' ? key.words.front() : key.words.back();
  if (std::holds_alternative<Vector2d*>(key.target)) return "[0.5, -0.25]";
  if (std::holds_alternative<Vector3d*>(key.target)) return "[0.5, -0.25, 0.125]";
  if (std::holds_alternative<std::vector<double>*>(key.target)) return "[0.5, 0.625]";
  return "other";
}

TEST_F(ScenarioFiles, EveryKeyChangesItsOwnLineAndNoOther) {
  std::set<std::string> seen;
  for (const std::string& text : {kHinge, kSlide}) {
    Scenario base = read(text);
    const auto before = lines_of(to_toml(base));
    for (const scenario::Key& key : scenario::bind_keys(base)) {
      const bool fixed =
          std::holds_alternative<scenario::Fixed>(key.target) || std::holds_alternative<std::vector<Fault>*>(key.target);
      if (fixed || key.name == "mechanism.type" || (text == kSlide && key.name.rfind("mechanism.", 0) != 0)) continue;
      seen.insert(key.name);
      const std::string change = key.name + "=" + other_value(key);
      const auto after = lines_of(to_toml(load_scenario(write(text), {change})));
      ASSERT_EQ(after.size(), before.size()) << change;
      std::vector<std::string> changed;
      for (std::size_t i = 0; i < before.size(); ++i) {
        if (before[i] != after[i]) changed.push_back(after[i]);
      }
      ASSERT_EQ(changed.size(), 1U) << change;
      EXPECT_EQ(changed[0].rfind(key.name.substr(key.name.rfind('.') + 1) + " = ", 0), 0U)
          << change << " gave " << changed[0];
    }
  }
  EXPECT_GT(seen.size(), 180U);
}

/// Converts to any field; counts the fields of an aggregate.
struct AnyField {
  template <class T>
  operator T() const;  // NOLINT(google-explicit-constructor)
};
template <class T, class... Fields>
constexpr std::size_t field_count() {
  if constexpr (requires { T{Fields{}..., AnyField{}}; }) {
    return field_count<T, Fields..., AnyField>();
  } else {
    return sizeof...(Fields);
  }
}

TEST_F(ScenarioFiles, HasAKeyForEveryFieldOfEveryConfig) {
  Scenario s = read(kHinge);
  const auto keys = scenario::bind_keys(s);
  const auto count = [&](const std::string& table) {
    std::size_t n = 0;
    for (const scenario::Key& key : keys)
      n += key.name.rfind(table + ".", 0) == 0 && key.name.find('.', table.size() + 1) == std::string::npos;
    return n;
  };
  EXPECT_EQ(count("control.wbc"), field_count<WbcConfig>());
  EXPECT_EQ(count("control.base_law"), field_count<BaseLawConfig>());
  EXPECT_EQ(count("control.navigation"), field_count<NavigationConfig>());
  EXPECT_EQ(count("control.planner"), field_count<PlannerConfig>());
  EXPECT_EQ(count("control.force") + 1, field_count<ForceLawConfig>());       // force_limit is limits.force_N
  EXPECT_EQ(count("control.estimator") + 1, field_count<EstimatorConfig>());  // noise has its own table
  EXPECT_EQ(count("control.estimator.noise"), field_count<PoseNoise>());
  EXPECT_EQ(count("control.clearance.self"), field_count<ClearanceLimits>());
  EXPECT_EQ(count("goal"), field_count<GoalConfig>());
  EXPECT_EQ(count("limits"), field_count<MissionLimits>());
  EXPECT_EQ(count("start"), field_count<StartConfig>());
  EXPECT_EQ(count("plant.grasp"), field_count<GraspConfig>());
  EXPECT_EQ(count("plant.wrist_sensor"), field_count<WristSensorConfig>());
  EXPECT_EQ(count("plant.base"), field_count<BasePlantConfig>());
  EXPECT_EQ(count("plant.arm"), field_count<ArmPlantConfig>());
  EXPECT_EQ(count("plant.perception"), field_count<PerceptionConfig>());
}

TEST_F(ScenarioFiles, OverridesWinOverTheFileAndTakeBareWords) {
  const Scenario s = read(kHinge + "[control]\nrate_hz = 500\n",
                          {"control.rate_hz=125", "plant.kind=kinematic", "belief.direction_error_deg=none",
                           "mechanism.closer.moment=2.5", "mechanism.at_m=[1, 2]"});
  EXPECT_DOUBLE_EQ(s.mission.period, 0.008);
  EXPECT_EQ(s.plant.kind, "kinematic");
  EXPECT_EQ(s.mechanism.described.closer.moment, 2.5);
  EXPECT_EQ(s.mechanism.described.at, Vector2d(1.0, 2.0));
}

TEST_F(ScenarioFiles, AnOverrideOfTheTypeDropsWhatTheFileSaysOfTheOldOne) {
  const Scenario s = read(kHinge + "radius_m = 0.4\nmass_kg = 3\n", {"mechanism.type=slide", "mechanism.travel_m=0.3"});
  EXPECT_EQ(s.mechanism.described.type, "slide");
  EXPECT_EQ(s.mechanism.described.travel, 0.3);
  EXPECT_EQ(s.mechanism.described.mass, 3.0);
}

TEST_F(ScenarioFiles, PathsStartAtTheFolderOfTheFile) {
  write("x", "model.xml");
  const Scenario s = read("[mechanism]\nmjcf = \"model.xml\"\njoint = \"door\"\nhandle = \"grip\"\n");
  EXPECT_EQ(s.mechanism.form, MechanismSource::Form::Mjcf);
  EXPECT_EQ(s.mechanism.mjcf, folder_ / "model.xml");
  EXPECT_EQ(s.mechanism.joint, "door");
  EXPECT_EQ(s.mechanism.handle_site, "grip");
  // A copy in another folder still finds the model.
  fs::create_directories(folder_ / "run");
  EXPECT_EQ(load_scenario(write(to_toml(s), "run/scenario.toml")).mechanism.mjcf, s.mechanism.mjcf);
}

TEST(ScenarioLibrary, EveryFileLoadsAndRoundTrips) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(fs::path(AJAR_SOURCE_DIR) / "scenarios")) {
    if (entry.path().extension() != ".toml") continue;
    SCOPED_TRACE(entry.path());
    const Scenario s = load_scenario(entry.path());
    EXPECT_EQ(text_of(entry.path()).rfind("# ", 0), 0U) << "the first line tells what the scenario is about";
    const fs::path copy = fs::temp_directory_path() / ("ajar_copy_" + std::to_string(::getpid()) + ".toml");
    std::ofstream(copy) << to_toml(s);
    EXPECT_EQ(to_toml(load_scenario(copy)), to_toml(s));
    fs::remove(copy);
    ++count;
  }
  EXPECT_GE(count, 10);
}

TEST(ScenarioReference, TheDocumentIsTheOneThatTheTablesGive) {
  EXPECT_EQ(text_of(fs::path(AJAR_SOURCE_DIR) / "docs/scenario.md"), scenario_reference())
      << "write it anew: ajar validate --reference > docs/scenario.md";
}

}  // namespace
}  // namespace ajar
