#include "toml_tree.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <iterator>
#include <utility>

#include "ajar/core/error.hpp"

namespace ajar::scenario {

namespace {

toml::table parse(const std::string& text, const std::string& name) {
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw ConfigError(fmt::format("{}:{}: not TOML: {}", name, error.source().begin.line, error.description()));
  }
}

/// KEY=VALUE as a small TOML document; a bare word is a text.
toml::table parse_override(const std::string& text) {
  const auto equals = text.find('=');
  if (equals == std::string::npos || equals == 0) throw ConfigError(kOverride + " " + text + ": allowed: KEY=VALUE");
  try {
    return toml::parse(text, kOverride);
  } catch (const toml::parse_error&) {
    std::string escaped;
    for (const char c : text.substr(equals + 1)) {
      if (c == '"' || c == '\\') escaped += '\\';
      escaped += c;
    }
    return parse(text.substr(0, equals) + "=\"" + escaped + "\"", kOverride);
  }
}

/// Moves what an override says into the file's tree; a copy would forget where it comes from.
void merge(toml::table& into, toml::table&& from) {
  for (auto&& [key, node] : from) {
    toml::node* const present = into.get(key);
    if (present != nullptr && present->is_table() && node.is_table()) {
      merge(*present->as_table(), std::move(*node.as_table()));
    } else {
      into.insert_or_assign(key, std::move(node));
    }
  }
}

}  // namespace

std::string file_text(const std::filesystem::path& file) {
  std::error_code status;
  if (!std::filesystem::exists(file, status)) throw IoError(file.string() + ": no such file");
  if (std::filesystem::is_directory(file, status)) throw IoError(file.string() + ": is a directory; allowed: a TOML file");
  std::ifstream in(file, std::ios::binary);
  if (!in) throw IoError(file.string() + ": cannot be read");
  std::string text((std::istreambuf_iterator<char>(in)), std::istreambuf_iterator<char>());
  if (std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isspace(c) != 0; })) {
    throw ConfigError(file.string() + ":1: the file is empty; at least [mechanism] is needed");
  }
  return text;
}

toml::table parse_tree(const std::string& text, const std::string& name, const std::vector<std::string>& overrides) {
  toml::table tree = parse(text, name);
  for (const std::string& change : overrides) merge(tree, parse_override(change));
  return tree;
}

}  // namespace ajar::scenario
