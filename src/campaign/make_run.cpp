#include <fmt/format.h>

#include "ajar/campaign/campaign.hpp"
#include "ajar/core/error.hpp"
#include "ajar/core/random.hpp"
#include "base_scenario.hpp"
#include "draws.hpp"

namespace ajar {
namespace {

/// Finaliser of SplitMix64: neighbouring numbers give unrelated seeds.
std::uint64_t mix(std::uint64_t x) noexcept {
  x ^= x >> 30;
  x *= 0xbf58476d1ce4e5b9ULL;
  x ^= x >> 27;
  x *= 0x94d049bb133111ebULL;
  return x ^ (x >> 31);
}

constexpr std::uint64_t kGolden = 0x9e3779b97f4a7c15ULL;
/// Keeps the draws of a campaign apart from those inside of the run, which start from the run's seed.
constexpr std::uint64_t kDrawStream = 0x64726177ULL;
/// A mechanism that stands in until the drawn one takes its place.
constexpr const char* kPlaceholder = "\n[mechanism]\ntype = \"hinge\"\n";

bool has_field(const std::vector<ResultField>& fields, const std::string& name) {
  for (const ResultField& field : fields) {
    if (field.name == name) return true;
  }
  return false;
}

}  // namespace

std::uint64_t run_seed(std::uint64_t campaign_seed, int index) noexcept {
  // 48 bits: exact in every reader of JSON and CSV, and still no two alike among thousands.
  return mix(mix(campaign_seed + kGolden) + kGolden * (static_cast<std::uint64_t>(index) + 1)) >> 16;
}

CampaignRun make_run(const Campaign& campaign, int index) {
  const std::uint64_t seed = run_seed(campaign.seed, index);
  Random random(mix(seed ^ kDrawStream));
  CampaignRun run;
  std::vector<std::string> overrides{fmt::format("seed={}", seed)};
  std::string base = campaign.base;
  MechanismConfig mechanism;
  if (!campaign.draw.empty()) {
    base += kPlaceholder;
    mechanism = draw_mechanism(campaign.draw, random);
    run.drawn = mechanism_fields(mechanism);
  } else if (!campaign.doors.empty()) {
    const std::string& door = campaign.doors[static_cast<std::size_t>(index) % campaign.doors.size()];
    overrides.push_back("mechanism.from=\"" + campaign.table.string() + "\"");
    overrides.push_back("mechanism.id=\"" + door + "\"");
    run.drawn.push_back({"mechanism.id", door});
  }
  if (base.find_first_not_of(" \n") == std::string::npos) base = "# nothing differs from the defaults\n";
  for (const SampledKey& sampled : campaign.sampled) {
    DrawnValue value = draw_value(sampled, random);
    overrides.push_back(sampled.key + "=" + value.literal);
    run.drawn.push_back(std::move(value.field));
  }
  run.scenario = scenario_from_text(base, overrides);
  if (!campaign.draw.empty()) {
    // Through the text and back, so that the scenario kept in a run folder gives the same bytes again.
    run.scenario.mechanism.described = mechanism;
    run.scenario = scenario_from_text(to_toml(run.scenario));
  }
  run.scenario.file = campaign.file;
  if (!has_field(run.drawn, "belief.direction_error_deg")) {
    const auto& error = run.scenario.belief.direction_error;
    ResultField field{"belief.direction_error_deg", std::string("none")};
    if (error) field.value = *error * 180.0 / M_PI;
    run.drawn.push_back(field);
  }
  return run;
}

}  // namespace ajar
