#include "run_files.hpp"

#include <fstream>
#include <iterator>

namespace ajar::page {

std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

nlohmann::ordered_json read_json(const std::filesystem::path& file) {
  nlohmann::ordered_json json = nlohmann::ordered_json::parse(read_text(file), nullptr, false);
  return json.is_object() ? json : nlohmann::ordered_json(nullptr);
}

}  // namespace ajar::page
