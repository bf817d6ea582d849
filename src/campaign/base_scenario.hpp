#pragma once

#include <string>
#include <vector>

#include "ajar/scenario/scenario.hpp"

namespace ajar {

/// Reads a scenario from text, with overrides KEY=VALUE. @throws ConfigError, IoError
[[nodiscard]] Scenario scenario_from_text(const std::string& text, const std::vector<std::string>& overrides = {});

}  // namespace ajar
