#pragma once

#include <string>

#include "ajar/estimation/identify.hpp"

/// "hinge", "slide" or "unknown".
[[nodiscard]] const char* type_name(ajar::MechanismType type);

/// Writes one HTML page with the track, the path found and the samples' distances from it.
/// @throws ajar::IoError
void write_identify_page(const std::string& file, const std::string& title, const ajar::Track& track,
                         const ajar::Identification& found);
