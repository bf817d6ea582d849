#pragma once

#include <initializer_list>

namespace ajar {

/// A value of a configuration and the closed range that it must lie in.
struct ConfigRange {
  const char* key;  ///< Name within its section
  double value;     ///< In the unit of the key
  double low;       ///< Smallest allowed, unit of the key
  double high;      ///< Largest allowed, unit of the key
};

/// Checks values against their ranges; NaN lies in none. Set-up only.
/// @throws ConfigError  naming section, key, value and range of the first that is outside
void check_ranges(const char* section, std::initializer_list<ConfigRange> ranges);

}  // namespace ajar
