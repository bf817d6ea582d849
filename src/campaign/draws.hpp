#pragma once

#include <string>
#include <vector>

#include "ajar/campaign/campaign.hpp"
#include "ajar/core/random.hpp"
#include "ajar/mechanism/builders.hpp"

namespace ajar {

/// A mechanism by the generator of that name. @throws ConfigError  naming those that exist
[[nodiscard]] MechanismConfig draw_mechanism(const std::string& generator, Random& random);

/// What tells drawn mechanisms apart, as columns `mechanism.*` in SI units.
[[nodiscard]] std::vector<ResultField> mechanism_fields(const MechanismConfig& mechanism);

/// One value of a sampled key: as a TOML literal for the scenario and as a field for the table.
struct DrawnValue {
  std::string literal;
  ResultField field;
};
[[nodiscard]] DrawnValue draw_value(const SampledKey& sampled, Random& random);

}  // namespace ajar
