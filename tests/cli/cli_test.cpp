// Strategy: the program is tested as a program: what it prints, where, and its exit code. Every kind of bad input must give
// exit code 2, exactly one line on standard error that names the file, nothing on standard output and no folder. One short
// kinematic mission checks the files of a run, that its saved scenario runs again to the same log, and that Ctrl-C ends
// safely. How well doors open is checked by the scenario tests.
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <thread>

namespace {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

struct Output {
  int exit_code = -1;
  std::string out;
  std::string err;
};

class Program : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = fs::temp_directory_path() / ("ajar_cli_" + std::to_string(::getpid()) + "_" +
                                           ::testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  /// Starts the program in the test's folder.
  pid_t start(const std::vector<std::string>& arguments) const {
    const pid_t child = ::fork();
    if (child != 0) return child;
    std::vector<std::string> words{AJAR_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    if (::chdir(folder_.c_str()) != 0 || std::freopen("out.txt", "w", stdout) == nullptr ||
        std::freopen("err.txt", "w", stderr) == nullptr) {
      ::_exit(126);
    }
    ::execv(argv[0], argv.data());
    ::_exit(127);
  }
  Output wait(pid_t child) const {
    int status = 0;
    ::waitpid(child, &status, 0);
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, text_of(folder_ / "out.txt"), text_of(folder_ / "err.txt")};
  }
  Output run(const std::vector<std::string>& arguments) const { return wait(start(arguments)); }

  fs::path write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return folder_ / name;
  }

  /// Exit code 2, one line that contains `part`, no results and no new folder.
  void expect_refused(const std::vector<std::string>& arguments, const std::string& part) const {
    const Output output = run(arguments);
    EXPECT_EQ(output.exit_code, 2) << output.err;
    EXPECT_EQ(std::count(output.err.begin(), output.err.end(), '\n'), 1) << output.err;
    EXPECT_NE(output.err.find(part), std::string::npos) << output.err;
    EXPECT_EQ(output.out, "");
    for (const auto& entry : fs::directory_iterator(folder_)) EXPECT_FALSE(entry.is_directory()) << entry.path();
  }

  fs::path folder_;
};

const std::string kSource = AJAR_SOURCE_DIR;
const std::string kDoor =
    "[mechanism]\ntype = \"hinge\"\nradius_m = 0.8\n[belief]\ndirection_error_deg = 10\n[plant]\nkind = \"kinematic\"\n";

TEST_F(Program, HelpNamesEveryCommandAndTheExitCodes) {
  const Output output = run({"--help"});
  EXPECT_EQ(output.exit_code, 0);
  for (const char* const word : {"run", "campaign", "validate", "report", "view", "Exit codes"})
    EXPECT_NE(output.out.find(word), std::string::npos) << word;
  EXPECT_EQ(run({"run", "--help"}).exit_code, 0);
}

TEST_F(Program, VersionIsThatOfTheBuild) {
  std::smatch match;
  const std::string lists = text_of(kSource + "/CMakeLists.txt");
  ASSERT_TRUE(std::regex_search(lists, match, std::regex(R"(project\(ajar VERSION ([0-9.]+))")));
  const Output output = run({"--version"});
  EXPECT_EQ(output.exit_code, 0);
  EXPECT_EQ(output.out, match[1].str() + "\n");
}

TEST_F(Program, RefusesWrongUsageInOneLine) {
  expect_refused({}, "subcommand is required");
  expect_refused({"fly"}, "fly");
  expect_refused({"run"}, "SCENARIO");
  expect_refused({"run", "a.toml", "--sed", "1"}, "--sed");
  expect_refused({"run", write("a.toml", kDoor), "--seed", "many"}, "--seed");
  expect_refused({"validate"}, "FILE");
}

TEST_F(Program, RefusesBadScenariosInOneLine) {
  expect_refused({"run", "nowhere.toml"}, "nowhere.toml: no such file");
  expect_refused({"run", "/tmp"}, "/tmp: is a directory");
  expect_refused({"run", write("empty.toml", "")}, "empty.toml:1: the file is empty");
  expect_refused({"run", write("syntax.toml", "seed = = 1\n")}, "syntax.toml:1: ");
  expect_refused({"run", write("mass.toml", kDoor + "[mechanism.closer]\nmoment = nan\n")},
                 "mass.toml:9: mechanism.closer.moment = nan");
  expect_refused({"run", write("door.toml", kDoor), "--set", "mechanism.mass_kg=-3"},
                 "mechanism.mass_kg = -3: allowed: above 0");
  expect_refused({"run", "door.toml", "--set", "robot=hero"}, "hero");
  expect_refused({"run", write("table.toml", "[mechanism]\nfrom = \"no.csv\"\nid = \"a\"\n")}, "no.csv");
  expect_refused({"run", write("model.toml", "[mechanism]\nmjcf = \"no.xml\"\njoint = \"a\"\nhandle = \"b\"\n")}, "no.xml");
}

TEST_F(Program, RefusesAHandleThatTheArmReachesFromNowhere) {
  expect_refused({"run", write("high.toml", kDoor), "--set", "mechanism.handle_height_m=2.45"},
                 "mechanism.handle_height_m = 2.45: allowed: what robot");
}

TEST_F(Program, RefusesAnOutputThatCannotBeWritten) {
  write("door.toml", kDoor);
  expect_refused({"run", "door.toml", "--out", "door.toml/run"}, "door.toml/run");
}

TEST_F(Program, RefusesRobotsWithoutAHandFrame) {
  std::string description = text_of(kSource + "/robots/heron/heron.toml");
  ASSERT_FALSE(description.empty());
  description = std::regex_replace(description, std::regex(R"(\[hand\]\s*frame = "[^"]*")"), "[hand]\nframe = \"nothing\"");
  write("heron.toml", description);
  write("heron.urdf", text_of(kSource + "/robots/heron/heron.urdf"));
  expect_refused({"run", write("door.toml", kDoor), "--set", "robot=heron.urdf"}, "nothing");
}

TEST_F(Program, RefusesModelsWithoutTheJoint) {
  write("box.xml",
        "<mujoco><worldbody><body name='leaf'><joint name='hinge'/><geom size='.1'/><site "
        "name='grip'/></body></worldbody></mujoco>");
  expect_refused({"run", write("m.toml", "[mechanism]\nmjcf = \"box.xml\"\njoint = \"slider\"\nhandle = \"grip\"\n")},
                 "slider");
}

TEST_F(Program, RefusesDoorTablesWithABrokenRow) {
  const std::string table = text_of(kSource + "/campaigns/doors.csv");
  ASSERT_FALSE(table.empty());
  const auto second_row = table.find('\n', table.find('\n') + 1);
  write("doors.csv", table.substr(0, second_row - 40) + "\n");
  const std::string id = table.substr(table.find('\n') + 1, table.find(',', table.find('\n')) - table.find('\n') - 1);
  expect_refused({"run", write("t.toml", "[mechanism]\nfrom = \"doors.csv\"\nid = \"" + id + "\"\n")}, "doors.csv:2");
}

TEST_F(Program, ValidatesEveryKindOfFileAndReportsAllThatAreWrong) {
  const Output right = run({"validate", kSource + "/scenarios/demo.toml", kSource + "/robots/heron/heron.urdf",
                            kSource + "/campaigns/doors.csv"});
  EXPECT_EQ(right.exit_code, 0) << right.err;
  EXPECT_EQ(std::count(right.out.begin(), right.out.end(), '\n'), 3);
  const Output model = run({"validate", write("box.xml", "<mujoco><worldbody><geom size='.1'/></worldbody></mujoco>")});
  EXPECT_EQ(model.exit_code, 0) << model.err;
  expect_refused({"validate", write("broken.xml", "<mujoco><world/></mujoco>")}, "broken.xml");
  const Output wrong = run({"validate", "a.toml", kSource + "/scenarios/demo.toml", "b.toml"});
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_NE(wrong.err.find("a.toml: no such file"), std::string::npos);
  EXPECT_NE(wrong.err.find("b.toml: no such file"), std::string::npos);
  EXPECT_EQ(wrong.out, "ok: " + kSource + "/scenarios/demo.toml\n");
}

TEST_F(Program, SaysBeforeItMovesWhyARunCannotBegin) {
  expect_refused({"run", write("near.toml", kDoor + "[start]\ndistance_m = 0.4\n")},
                 "the robot starts in collision: base_link");
  const std::string narrow = "[mechanism]\ntype = \"hinge\"\nsense = \"push\"\nradius_m = 0.47\n";
  expect_refused({"run", write("narrow.toml", narrow)}, "base 0.58 m wide, opening 0.52 m: -0.03 m each side");
  expect_refused({"validate", "narrow.toml"}, "narrow.toml: the doorway is too narrow");
}

TEST_F(Program, ValidateSaysWhatAScenarioFallsShortOf) {
  const std::string low =
      "[mechanism]\ntype = \"hinge\"\ntilt_deg = 90\nside = \"right\"\nradius_m = 0.45\nhandle_height_m = 0.62\nbar = "
      "\"horizontal\"\n";
  const Output output = run({"validate", write("low.toml", low)});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  EXPECT_NE(output.out.find("falls short: no posture"), std::string::npos) << output.out;
}

TEST_F(Program, PrintsTheReferenceOfTheScenarioKeys) {
  const Output output = run({"validate", "--reference"});
  EXPECT_EQ(output.exit_code, 0);
  EXPECT_EQ(output.out, text_of(kSource + "/docs/scenario.md"));
}

TEST_F(Program, ARunLeavesAFolderThatRunsAgainToTheSameBytes) {
  write("door.toml", kDoor);
  // A goal of 10° keeps the run short; what is compared is the whole log.
  const Output first = run({"run", "door.toml", "--seed", "5", "--set", "goal.opening_deg=10", "--out", "one"});
  ASSERT_LE(first.exit_code, 1) << first.err;
  EXPECT_NE(first.out.find("one/report.html"), std::string::npos);
  for (const char* const name : {"scenario.toml", "result.json", "log.csv", "report.html", "version.txt"}) {
    EXPECT_TRUE(fs::exists(folder_ / "one" / name)) << name;
  }
  const Output second = run({"run", "one/scenario.toml", "--out", "two", "--quiet"});
  EXPECT_EQ(second.exit_code, first.exit_code);
  EXPECT_EQ(second.err, "");
  EXPECT_EQ(text_of(folder_ / "two/log.csv"), text_of(folder_ / "one/log.csv"));
  EXPECT_EQ(text_of(folder_ / "two/scenario.toml"), text_of(folder_ / "one/scenario.toml"));
}

TEST_F(Program, ACampaignLeavesOneRowPerRun) {
  write("c.toml",
        "runs = 3\nseed = 2\n[base.mechanism]\ntype = \"slide\"\n[base.belief]\ndirection_error_deg = 10\n"
        "[base.plant]\nkind = \"kinematic\"\n[base.goal]\nopening_m = 0.1\n");
  const Output output = run({"campaign", "c.toml", "--runs", "2", "--jobs", "2", "--keep", "none", "--out", "c", "--quiet"});
  EXPECT_EQ(output.exit_code, 0) << output.err;
  const std::string rows = text_of(folder_ / "c/runs.csv");
  EXPECT_EQ(std::count(rows.begin(), rows.end(), '\n'), 3) << rows;
  EXPECT_TRUE(fs::exists(folder_ / "c/summary.json"));
}

TEST_F(Program, RefusesToShowWhatIsNoRun) {
  expect_refused({"report", "nowhere"}, "nowhere: no such folder");
  expect_refused({"view"}, "FOLDER");
  expect_refused({"view", "nowhere"}, "nowhere: no such folder");
  expect_refused({"view", "--live"}, "runs: no run goes on here");
  expect_refused({"run", "a.toml", "--speed", "2"}, "--live");
}

TEST_F(Program, ReportsSayWhichFileIsNoLog) {
  fs::create_directories(folder_ / "foreign");
  write("foreign/log.csv", "a,b\n1,2\n");
  const Output output = run({"report", "foreign"});
  EXPECT_EQ(output.exit_code, 2);
  EXPECT_EQ(output.err, "ajar: foreign/log.csv:1: not a log of a run: columns time and phase are needed\n");
  EXPECT_FALSE(fs::exists(folder_ / "foreign/report.html"));
}

TEST_F(Program, RefusesBadCampaignsInOneLine) {
  expect_refused({"campaign", "nowhere.toml"}, "nowhere.toml: no such file");
  expect_refused({"campaign", write("k.toml", "runs = 3\nruns_ = 2\n")}, "k.toml:2: runs_: unknown key");
  expect_refused({"campaign", "k.toml", "--keep", "some"}, "--keep");
}

TEST_F(Program, CtrlCStopsTheRobotAndExitsOne) {
  write("door.toml", kDoor);
  const pid_t child = start({"run", "door.toml", "--set", "control.rate_hz=1000", "--out", "one"});
  // The folder appears when the robot starts to act.
  for (int i = 0; i < 1000 && !fs::exists(folder_ / "one/log.csv"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(5));
  ::kill(child, SIGINT);
  const Output output = wait(child);
  EXPECT_EQ(output.exit_code, 1) << output.err;
  EXPECT_NE(text_of(folder_ / "one/result.json").find("\"stopped\""), std::string::npos);
  EXPECT_NE(output.out.find("interrupted"), std::string::npos) << output.out;
}

TEST_F(Program, IdentifiesATrackInWordsInJsonAndOnAPage) {
  std::string track;
  for (int i = 0; i < 100; ++i) {
    const double angle = 0.01 * i;  // a hinge of 0.5 m about z through (0, 0, 1)
    track += std::to_string(0.5 * std::cos(angle)) + " " + std::to_string(0.5 * std::sin(angle)) + " 1\n";
  }
  write("door.txt", track);
  const Output words = run({"identify", "door.txt", "--out", "door.html"});
  EXPECT_EQ(words.exit_code, 0) << words.err;
  EXPECT_EQ(words.out.find("hinge"), 0U) << words.out;
  EXPECT_NE(text_of(folder_ / "door.html").find("<svg"), std::string::npos);
  const auto json = nlohmann::json::parse(run({"identify", "door.txt", "--json", "--sensor", "vision"}).out);
  EXPECT_EQ(json["type"], "hinge");
  EXPECT_NEAR(json["radius_m"], 0.5, 0.01);
  EXPECT_NEAR(json["axis"][2], 1.0, 1e-3);
  EXPECT_LT(std::hypot(double(json["point"][0]), double(json["point"][1])), 0.01);
  EXPECT_EQ(json["samples"], 100);
  for (const char* key : {"type_confidence", "curvature_per_m", "direction", "outliers", "rms_m", "radius_m_sigma"}) {
    EXPECT_TRUE(json.contains(key)) << key;
  }
}

TEST_F(Program, RefusesBadTracksInOneLine) {
  expect_refused({"identify", "nowhere.txt"}, "nowhere.txt: cannot be read");
  expect_refused({"identify", write("a.txt", "0 0 0\n1 nan 0\n")}, "a.txt:2: y = nan");
  expect_refused({"identify", write("b.txt", "0 0\n1 1\n")}, "b.txt:1: 2 columns");
  expect_refused({"identify", write("c.txt", "0 0 0\n1 1\n")}, "c.txt:2: 2 columns");
  expect_refused({"identify", write("d.txt", "0 0 0 0\n2 0 0 1\n1 0 0 2\n")}, "d.txt:3: time = 1: goes back");
  expect_refused({"identify", write("e.txt", "0 0 0\n1 0 0\n2 0 0\n")}, "e.txt: 3 samples");
  std::string still;
  for (int i = 0; i < 50; ++i) still += "0.1 0.2 0.3\n";
  expect_refused({"identify", write("f.txt", still)}, "f.txt: all samples are at one point");
  expect_refused({"identify", "f.txt", "--sensor", "sonar"}, "sonar");
}

}  // namespace
