#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

namespace ajar::page {

/// Content of a file, empty if there is none.
[[nodiscard]] std::string read_text(const std::filesystem::path& file);

/// A JSON object of ours that a run which broke off may have left out or half written: then null.
[[nodiscard]] nlohmann::ordered_json read_json(const std::filesystem::path& file);

}  // namespace ajar::page
