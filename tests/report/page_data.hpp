#pragma once

#include <zlib.h>

#include <cstring>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

namespace ajar::test {

/// The data that a page holds, as its script would read them.
inline nlohmann::json page_data(const std::string& page) {
  const std::string slot = "<script id=\"data\" type=\"application/json\">";
  const auto begin = page.find(slot) + slot.size();
  return nlohmann::json::parse(page.substr(begin, page.find("</script>", begin) - begin));
}

inline std::string from_base64(const std::string& text) {
  const std::string digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string bytes;
  unsigned group = 0;
  int bits = 0;
  for (const char c : text) {
    if (c == '=') break;
    group = group << 6 | static_cast<unsigned>(digits.find(c));
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes += static_cast<char>(group >> bits & 255u);
  }
  return bytes;
}

/// Columns as the page unpacks them: inflated, the four bytes of every number put together again.
inline std::vector<std::vector<float>> unpack(const std::string& text, std::size_t columns, std::size_t rows) {
  const std::string packed = from_base64(text);
  std::string bytes(4 * columns * rows + 1, '\0');
  uLongf size = static_cast<uLongf>(bytes.size());
  const int status = uncompress(reinterpret_cast<Bytef*>(bytes.data()), &size, reinterpret_cast<const Bytef*>(packed.data()),
                                static_cast<uLong>(packed.size()));
  if (status != Z_OK || size != 4 * columns * rows) throw std::runtime_error("packed columns have another size");
  std::vector<std::vector<float>> out(columns, std::vector<float>(rows));
  for (std::size_t c = 0; c < columns; ++c) {
    for (std::size_t i = 0; i < rows; ++i) {
      char number[4];
      for (std::size_t k = 0; k < 4; ++k) number[k] = bytes[(4 * c + k) * rows + i];
      std::memcpy(&out[c][i], number, 4);
    }
  }
  return out;
}

/// One column of one run of a page; empty if the page has none of that name.
inline std::vector<float> column(const nlohmann::json& run, const std::string& name) {
  const std::vector<std::string> names = run["columns"];
  const auto all = unpack(run["data"], names.size(), run["rows"]);
  for (std::size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return all[i];
  }
  return {};
}

}  // namespace ajar::test
