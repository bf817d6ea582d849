#pragma once

#include <string>
#include <vector>

namespace ajar {

/// Columns of one length as text for the page: 32-bit floats column by column, the four bytes of every number apart (all
/// lowest bytes of a column first), deflated (zlib), base64. NaN stays NaN.
[[nodiscard]] std::string pack_columns(const std::vector<const std::vector<double>*>& columns);

/// Bytes as base64. (RFC 4648)
[[nodiscard]] std::string base64(const std::string& bytes);

}  // namespace ajar
