#include "draws.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "ajar/core/error.hpp"
#include "ajar/mechanism/random_mechanism.hpp"

namespace ajar {
namespace {

struct Generator {
  const char* name;
  MechanismConfig (*draw)(Random&);
};

/// The generators that a campaign may name.
constexpr Generator kGenerators[] = {
    {"pull", sample_pull}, {"push", sample_push}, {"sliding", sample_sliding}, {"oven", sample_oven}, {"any", sample_any}};

}  // namespace

std::vector<std::string> mechanism_draws() {
  std::vector<std::string> names;
  for (const Generator& generator : kGenerators) names.emplace_back(generator.name);
  return names;
}

MechanismConfig draw_mechanism(const std::string& generator, Random& random) {
  for (const Generator& candidate : kGenerators) {
    if (generator == candidate.name) return candidate.draw(random);
  }
  throw ConfigError(fmt::format("sample.draw = \"{}\": allowed: {}", generator, fmt::join(mechanism_draws(), ", ")));
}

std::vector<ResultField> mechanism_fields(const MechanismConfig& m) {
  const bool hinge = m.type != "slide";
  const auto only_hinge = [&](double value) -> decltype(ResultField::value) {
    if (hinge) return value;
    return std::monostate{};
  };
  std::string side = hinge ? (m.side == Side::Left ? "left" : "right") : "";
  return {{"mechanism.type", m.type},
          {"mechanism.radius", only_hinge(m.radius)},
          {"mechanism.tilt", only_hinge(m.tilt)},
          {"mechanism.side", side},
          {"mechanism.sense", std::string(m.sense == Sense::Pull ? "pull" : "push")},
          {"mechanism.travel", m.travel},
          {"mechanism.handle_height", m.handle_height},
          {"mechanism.bar", std::string(m.bar == BarOrientation::Vertical ? "vertical" : "horizontal")},
          {"mechanism.mass", m.mass},
          {"mechanism.coulomb", m.coulomb},
          {"mechanism.viscous", m.viscous},
          {"mechanism.stiffness", m.stiffness},
          {"mechanism.closer_moment", m.closer.moment},
          {"mechanism.closer_size", static_cast<std::int64_t>(m.closer_size)},
          {"mechanism.seal_force", m.seal.force}};
}

DrawnValue draw_value(const SampledKey& sampled, Random& random) {
  // Every law takes exactly one number from the generator, so that one key's law does not shift the draws of the next.
  const double share = random.uniform(0.0, 1.0);
  switch (sampled.law) {
    case SampledKey::Law::Uniform: {
      const double value = sampled.lower + share * (sampled.upper - sampled.lower);
      return {fmt::format("{}", value), {sampled.key, value}};
    }
    case SampledKey::Law::LogUniform: {
      const double value = sampled.lower * std::pow(sampled.upper / sampled.lower, share);
      return {fmt::format("{}", value), {sampled.key, value}};
    }
    case SampledKey::Law::Chance: {
      const bool value = share < sampled.probability;
      return {value ? "true" : "false", {sampled.key, static_cast<std::int64_t>(value ? 1 : 0)}};
    }
    case SampledKey::Law::Choice: break;
  }
  const std::size_t count = sampled.choices.size();
  const std::size_t index = std::min(count - 1, static_cast<std::size_t>(share * static_cast<double>(count)));
  std::string text = sampled.choices[index];
  text.erase(std::remove(text.begin(), text.end(), '"'), text.end());
  return {sampled.choices[index], {sampled.key, text}};
}

}  // namespace ajar
