#include "ajar/report/report.hpp"

#include <fmt/format.h>

#include <memory>
#include <string>
#include <vector>

#include "commands.hpp"
#include "exit_codes.hpp"

void add_report(CLI::App& program, int& exit_code) {
  CLI::App* const command = program.add_subcommand("report", "Makes or remakes report.html of run folders");
  const auto folders = std::make_shared<std::vector<std::string>>();
  command->add_option("RUN_DIR", *folders, "Run folders")->required();
  command->callback([folders, &exit_code] {
    for (const std::string& folder : *folders) {
      ajar::write_report(folder);
      fmt::print("{}/report.html\n", folder);
    }
    exit_code = kReached;
  });
}
