#include "ajar/core/config_range.hpp"

#include <sstream>

#include "ajar/core/error.hpp"

namespace ajar {

void check_ranges(const char* section, std::initializer_list<ConfigRange> ranges) {
  for (const ConfigRange& range : ranges) {
    if (!(range.value >= range.low && range.value <= range.high)) {
      std::ostringstream message;
      message << section << '.' << range.key << " = " << range.value << ": must be in [" << range.low << ", " << range.high
              << ']';
      throw ConfigError(message.str());
    }
  }
}

}  // namespace ajar
