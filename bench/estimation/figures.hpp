#pragma once

#include <string>

#include "cells.hpp"

namespace ajar::bench {

/// Draws the errors of all contestants over the path travelled: estimation_hinge.svg and estimation_slide.svg.
/// @throws IoError
void write_figures(const std::string& folder, const Table& table);

}  // namespace ajar::bench
