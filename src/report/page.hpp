#pragma once

#include <string_view>

namespace ajar::page {

/// The parts of the page in their order; data stands between kBody and kScript.
extern const std::string_view kStyle;
extern const std::string_view kBody;
extern const std::string_view kPlotScript;
extern const std::string_view kViewScript;

}  // namespace ajar::page
