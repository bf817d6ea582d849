#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "ajar/thesis/reproduction.hpp"
#include "commands.hpp"
#include "exit_codes.hpp"
#include "plants.hpp"

namespace {

struct ReproduceArguments {
  std::string what;
  std::vector<std::string> figures;
  std::string out = "thesis";
  int jobs = 0;
};

int reproduce(const ReproduceArguments& arguments) {
  ajar::ReproduceOptions options;
  options.figures = arguments.figures;
  options.threads = arguments.jobs > 0 ? arguments.jobs : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  options.progress = [](const std::string& chapter) { fmt::print(stderr, "{} …\n", chapter); };
  const ajar::Reproduction made = ajar::reproduce_thesis(make_plant, arguments.out, options);
  const auto held = std::count_if(made.statements.begin(), made.statements.end(), [](const auto& s) { return s.holds; });
  fmt::print("{:<24}{} of {} hold\n", "statements", held, made.statements.size());
  for (const ajar::ThesisStatement& s : made.statements) {
    if (!s.holds) fmt::print("{:<24}{}: {}\n", "", s.figure, s.statement);
  }
  fmt::print("{:<24}{}\n", "figures", made.figures.size());
  fmt::print("{:<24}{}/thesis.html\n", "page", arguments.out);
  return kReached;
}

}  // namespace

void add_reproduce(CLI::App& program, int& exit_code) {
  CLI::App* const command = program.add_subcommand(
      "reproduce", "Runs the thesis's experiments; writes thesis.html, thesis.json, figures/ and runs/");
  const auto arguments = std::make_shared<ReproduceArguments>();
  command->add_option("WHAT", arguments->what, "thesis")->required()->check(CLI::IsMember({"thesis"}));
  command->add_option("--figure", arguments->figures, "Only this figure, such as 6.6; may stand several times")
      ->allow_extra_args(false);
  command->add_option("--out", arguments->out, "Folder, default thesis");
  command->add_option("--jobs", arguments->jobs, "Runs at the same time; default one per core")->check(CLI::Range(1, 256));
  command->callback([arguments, &exit_code] { exit_code = reproduce(*arguments); });
}
