// ajar_bench_estimation [--only PART] [--seed tune|judge] [--runs N] [--json] [--all] [--figures DIR]: how good the
// estimator is, in figures with what they must reach. Seeds for tuning and for judging differ; thresholds were set on the
// first alone.
#include <fmt/format.h>

#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

#include "ajar/core/error.hpp"
#include "figures.hpp"

namespace {

using ajar::bench::Effort;
using ajar::bench::Row;
using ajar::bench::Table;

constexpr std::uint64_t kTuneSeed = 1001;
constexpr std::uint64_t kJudgeSeed = 9001;

struct Part {
  const char* name;
  std::function<void(const Effort&, Table&)> judge;
};

std::vector<Part> parts() {
  using namespace ajar::bench;
  return {{"bound", judge_bound},
          {"honesty", judge_honesty},
          {"type", judge_types},
          {"failures", judge_failures},
          {"recordings", [](const Effort&, Table& table) { judge_recordings(table); }},
          {"cost", [](const Effort&, Table& table) { judge_cost(table); }},
          {"peers", judge_peers}};
}

struct Options {
  Effort effort{400, kJudgeSeed};
  std::string only, figures;
  bool json = false;
  bool all = false;  // also the rows that hold
};

Options parse(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const auto value = [&] {
      if (++i >= argc) throw ajar::ConfigError(word + " needs a value");
      return std::string(argv[i]);
    };
    if (word == "--json") {
      options.json = true;
    } else if (word == "--all") {
      options.all = true;
    } else if (word == "--only") {
      options.only = value();
    } else if (word == "--figures") {
      options.figures = value();
    } else if (word == "--runs") {
      options.effort.runs = std::atoi(value().c_str());
    } else if (word == "--seed") {
      const std::string seed = value();
      if (seed != "tune" && seed != "judge") throw ajar::ConfigError("--seed " + seed + ": must be tune or judge");
      options.effort.seed = seed == "tune" ? kTuneSeed : kJudgeSeed;
    } else {
      throw ajar::ConfigError("unknown option '" + word +
                              "'; allowed: --only PART, --seed tune|judge, --runs N, --all, --json, --figures DIR");
    }
  }
  if (options.effort.runs < 8) throw ajar::ConfigError("--runs: must be a number of at least 8");
  return options;
}

void print_json(const Table& table) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const Row& row : table) {
    list.push_back({{"bench", "estimation"},
                    {"contestant", row.contestant},
                    {"problem", row.problem},
                    {"value", row.value},
                    {"unit", row.unit},
                    {"bar", row.bar},
                    {"holds", row.holds}});
  }
  fmt::print("{}\n", list.dump(2));
}

void print_rows(const Table& table, bool all) {
  int asked = 0;
  int held = 0;
  for (const Row& row : table) {
    asked += row.bar.empty() ? 0 : 1;
    held += !row.bar.empty() && row.holds ? 1 : 0;
    if (!all && row.holds && row.problem.find(" cm: ") != std::string::npos && !row.bar.empty()) continue;
    fmt::print("{:<72} {:<24} {:>9.3f} {:<6} {:<12} {}\n", row.problem, row.contestant, row.value, row.unit, row.bar,
               row.bar.empty() ? ""
               : row.holds     ? "holds"
                               : "MISSED");
  }
  fmt::print("{} of {} figures hold{}\n", held, asked, all ? "" : "; --all shows every cell");
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const Options options = parse(argc, argv);
    Table table;
    bool any = false;
    std::string names;
    for (const Part& part : parts()) {
      names.append(" ").append(part.name);
      if (!options.only.empty() && options.only != part.name) continue;
      any = true;
      part.judge(options.effort, table);
    }
    if (!any) throw ajar::ConfigError("no part '" + options.only + "'; allowed:" + names);
    if (!options.figures.empty()) ajar::bench::write_figures(options.figures, table);
    if (options.json) {
      print_json(table);
    } else {
      print_rows(table, options.all);
    }
    return 0;
  } catch (const ajar::Error& error) {
    fmt::print(stderr, "ajar_bench_estimation: {}\n", error.what());
    return 2;
  }
}
