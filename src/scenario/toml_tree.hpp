#pragma once

#include <toml++/toml.h>

#include <filesystem>
#include <string>
#include <vector>

namespace ajar::scenario {

/// What stands as the file name of values that come from the command line.
inline const std::string kOverride = "--set";

[[nodiscard]] inline bool from_override(const toml::node& node) {
  return node.source().path && *node.source().path == kOverride;
}

/// The bytes of a file that is there, is no folder and is not empty. @throws IoError, ConfigError
[[nodiscard]] std::string file_text(const std::filesystem::path& file);

/// The values of a text with those of KEY=VALUE put over them; each value knows where it comes from. @throws ConfigError
[[nodiscard]] toml::table parse_tree(const std::string& text, const std::string& name,
                                     const std::vector<std::string>& overrides);

}  // namespace ajar::scenario
