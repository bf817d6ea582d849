#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <vector>

#include "ajar/core/error.hpp"
#include "ajar/model/robot_model.hpp"
#include "robot_config.hpp"

namespace ajar {
namespace {

namespace fs = std::filesystem;

// Folders that hold one folder per robot, in the order of the search.
std::vector<fs::path> robot_folders() {
  std::vector<fs::path> folders;
  if (const char* given = std::getenv("AJAR_ROBOTS"); given != nullptr && *given != '\0') {
    folders.emplace_back(given);
  }
  std::error_code ignored;
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  if (!program.empty()) {  // an installed program takes its own robots even where its source tree still exists
    folders.push_back(program.parent_path().parent_path() / "share" / "ajar" / "robots");
  }
  folders.emplace_back(AJAR_ROBOTS_DIR);
  folders.emplace_back(AJAR_ROBOTS_INSTALL_DIR);
  return folders;
}

std::vector<std::string> robot_names(const std::vector<fs::path>& folders) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (const fs::path& folder : folders) {
    for (const auto& entry : fs::directory_iterator(folder, ignored)) {
      const std::string name = entry.path().filename().string();
      if (fs::exists(entry.path() / (name + ".urdf"), ignored)) {
        names.push_back(name);
      }
    }
  }
  std::sort(names.begin(), names.end());
  names.erase(std::unique(names.begin(), names.end()), names.end());
  return names;
}

}  // namespace

RobotModel load_robot(const std::string& name_or_path) {
  const fs::path given(name_or_path);
  if (given.extension() == ".urdf") {
    return RobotModel::load(given, fs::path(given).replace_extension(".toml"));
  }
  const std::vector<fs::path> folders = robot_folders();
  std::error_code ignored;
  if (!name_or_path.empty() && !given.has_parent_path()) {
    for (const fs::path& folder : folders) {
      const fs::path urdf = folder / given / (name_or_path + ".urdf");
      if (fs::exists(urdf, ignored)) {
        return RobotModel::load(urdf, fs::path(urdf).replace_extension(".toml"));
      }
    }
  }
  throw IoError("robot: \"" + name_or_path +
                "\"; allowed: a path to a .urdf with its .toml beside it, or one of: " + join_names(robot_names(folders)));
}

}  // namespace ajar
