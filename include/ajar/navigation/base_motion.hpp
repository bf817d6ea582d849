#pragma once

#include "ajar/core/types.hpp"

namespace ajar {

/// A base velocity command.
struct BaseTwist {
  double v = 0.0;  ///< [m/s]
  double w = 0.0;  ///< [rad/s]
};

}  // namespace ajar
