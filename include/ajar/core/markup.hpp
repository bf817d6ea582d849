#pragma once

#include <string>

namespace ajar {

/// Text with the characters that XML and HTML reserve written out, safe between tags and in quoted attributes.
[[nodiscard]] std::string escape_markup(const std::string& text);

}  // namespace ajar
