#include "ajar/report/report.hpp"

#include <fmt/format.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "ajar/core/error.hpp"
#include "commands.hpp"
#include "exit_codes.hpp"

namespace {

namespace fs = std::filesystem;

struct ReportArguments {
  std::vector<std::string> folders;
  std::string out;
};

void make(const ReportArguments& arguments) {
  const std::vector<fs::path> folders(arguments.folders.begin(), arguments.folders.end());
  for (const fs::path& folder : folders) {
    if (!fs::is_directory(folder)) throw ajar::IoError(folder.string() + ": no such folder; allowed: folders of runs");
  }
  if (folders.size() == 1 && fs::exists(folders.front() / "runs.csv")) {
    const fs::path file = arguments.out.empty() ? folders.front() / "report.html" : fs::path(arguments.out);
    ajar::write_page(file, ajar::make_campaign_page(folders.front()));
    fmt::print("{}\n", file.string());
    return;
  }
  const fs::path own = folders.size() == 1 ? folders.front() / "report.html" : fs::path("comparison.html");
  const fs::path file = arguments.out.empty() ? own : fs::path(arguments.out);
  ajar::write_page(file, ajar::make_report(folders));
  fmt::print("{}\n", file.string());
}

}  // namespace

void add_report(CLI::App& program, int& exit_code) {
  CLI::App* const command =
      program.add_subcommand("report", "Makes the page of a run, of a campaign, or of several runs for comparison");
  const auto arguments = std::make_shared<ReportArguments>();
  command
      ->add_option("RUN_DIR", arguments->folders, "Folder of a run or campaign; several runs are laid on top of each other")
      ->required();
  command->add_option("--out", arguments->out, "Page; default RUN_DIR/report.html, for several comparison.html");
  command->callback([arguments, &exit_code] {
    make(*arguments);
    exit_code = kReached;
  });
}
