#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "ajar/campaign/campaign.hpp"
#include "ajar/core/error.hpp"
#include "ajar/mujoco/mujoco_plant.hpp"
#include "commands.hpp"
#include "complain.hpp"
#include "exit_codes.hpp"
#include "plants.hpp"

namespace {

namespace fs = std::filesystem;

struct ValidateArguments {
  std::vector<std::string> files;
  std::string joint;
  std::string handle;
  bool reference = false;
};

/// A campaign is told from a scenario by what stands at the top: number of runs, base, what is drawn, or a table of doors.
bool is_campaign(const fs::path& file) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    const auto start = line.find_first_not_of(" \t");
    if (start == std::string::npos) continue;
    if (line.compare(start, 10, "[mechanism") == 0) return false;
    for (const char* const mark : {"runs", "base", "[base", "[sample", "[table"}) {
      if (line.rfind(mark, start) == start) return true;
    }
  }
  return false;
}

void check_doors(const fs::path& file) {
  for (const std::string& id : ajar::list_doors(file)) static_cast<void>(ajar::load_door(file, id));
}

/// @return what a scenario falls short of, if it is one that does
std::string check_file(const std::string& name, const ValidateArguments& arguments) {
  const fs::path file(name);
  std::error_code status;
  if (!fs::exists(file, status)) throw ajar::IoError(name + ": no such file");
  if (fs::is_directory(file, status))
    throw ajar::IoError(name + ": is a directory; allowed: a .toml, .urdf, .xml or .csv file");
  const std::string type = file.extension().string();
  if (type == ".toml" && is_campaign(file)) {
    static_cast<void>(ajar::load_campaign(file));
  } else if (type == ".toml") {
    return check_scenario(ajar::load_scenario(file));
  } else if (type == ".urdf") {
    static_cast<void>(ajar::load_robot(name));
  } else if (type == ".csv") {
    check_doors(file);
  } else if (type == ".xml" && arguments.joint.empty() && arguments.handle.empty()) {
    ajar::check_mjcf(file);
  } else if (type == ".xml") {
    ajar::MjcfWorld world;
    world.path = file;
    world.joint = arguments.joint;
    world.handle_site = arguments.handle;
    static_cast<void>(ajar::load_mjcf_mechanism(world));
  } else {
    throw ajar::ConfigError(name + ": unknown kind of file; allowed: .toml, .urdf, .xml (MJCF) or .csv (door table)");
  }
  return {};
}

int validate(const ValidateArguments& arguments) {
  if (arguments.reference) {
    fmt::print("{}", ajar::scenario_reference());
    return kReached;
  }
  int exit_code = kReached;
  for (const std::string& file : arguments.files) {
    try {
      const std::string shortfall = check_file(file, arguments);
      fmt::print("ok: {}\n", file);
      if (!shortfall.empty()) fmt::print("    falls short: {}\n", shortfall);
    } catch (const ajar::Error& error) {
      complain(error.what());
      exit_code = kBadInput;
    }
  }
  return exit_code;
}

}  // namespace

void add_validate(CLI::App& program, int& exit_code) {
  CLI::App* const command =
      program.add_subcommand("validate", "Checks scenario, campaign, URDF, MJCF or door files without running");
  const auto arguments = std::make_shared<ValidateArguments>();
  CLI::Option* const files = command->add_option("FILE", arguments->files, "Files");
  command->add_option("--joint", arguments->joint, "MJCF: also look for the joint that opens");
  command->add_option("--handle", arguments->handle, "MJCF: also look for the site at the centre of the grip");
  CLI::Option* const reference =
      command->add_flag("--reference", arguments->reference, "Prints all keys of a scenario as Markdown");
  command->callback([=, &exit_code] {
    if (files->count() + reference->count() == 0) throw CLI::RequiredError("FILE");
    exit_code = validate(*arguments);
  });
}
