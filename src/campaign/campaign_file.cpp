// Reading of campaign files.
#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>
#include <sstream>
#include <tuple>

#include "ajar/campaign/campaign.hpp"
#include "ajar/core/error.hpp"
#include "base_scenario.hpp"
#include "draws.hpp"

namespace ajar {
namespace {

constexpr double kNotANumber = std::numeric_limits<double>::quiet_NaN();
constexpr std::array kLaws{"uniform", "log_uniform", "choice", "chance"};

std::string place(const Campaign& campaign, const toml::node& node) {
  return fmt::format("{}:{}: ", campaign.file.string(), node.source().begin.line);
}

std::string literal(const toml::node& node) {
  std::ostringstream text;
  node.visit([&](const auto& value) { text << value; });
  return text.str();
}

[[noreturn]] void refuse(const Campaign& campaign, const toml::node& node, const std::string& key,
                         const std::string& allowed) {
  throw ConfigError(fmt::format("{}{} = {}: allowed: {}", place(campaign, node), key,
                                node.is_table() ? "a table" : literal(node), allowed));
}

void check_keys(const Campaign& campaign, const toml::table& table, const std::string& prefix,
                const std::vector<std::string>& valid) {
  for (const auto& [key, node] : table) {
    if (std::find(valid.begin(), valid.end(), key.str()) != valid.end()) continue;
    throw ConfigError(fmt::format("{}{}{}: unknown key; valid here: {}", place(campaign, node), prefix, key.str(),
                                  fmt::join(valid, ", ")));
  }
}

const toml::table* find_table(const Campaign& campaign, const toml::table& parent, const std::string& key) {
  const toml::node* node = parent.get(key);
  if (node == nullptr) return nullptr;
  if (!node->is_table()) refuse(campaign, *node, key, "a table [" + key + "]");
  return node->as_table();
}

std::string read_file(const std::filesystem::path& file) {
  std::error_code status;
  if (!std::filesystem::exists(file, status)) throw IoError(file.string() + ": no such file");
  if (std::filesystem::is_directory(file, status)) throw IoError(file.string() + ": is a directory; allowed: a TOML file");
  std::ifstream stream(file, std::ios::binary);
  if (!stream) throw IoError(file.string() + ": cannot be read");
  std::string text((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  if (std::all_of(text.begin(), text.end(), [](unsigned char c) { return std::isspace(c) != 0; })) {
    throw ConfigError(file.string() + ":1: the file is empty; at least runs and [base] are needed");
  }
  return text;
}

std::pair<double, double> read_range(const Campaign& campaign, const toml::node& node, const std::string& key,
                                     bool positive) {
  const char* allowed =
      positive ? "two numbers [lower, upper], 0 < lower <= upper" : "two numbers [lower, upper], lower <= upper";
  const toml::array* array = node.as_array();
  if (array == nullptr || array->size() != 2 || !array->get(0)->is_number() || !array->get(1)->is_number())
    refuse(campaign, node, key, allowed);
  const double lower = array->get(0)->value<double>().value_or(kNotANumber);
  const double upper = array->get(1)->value<double>().value_or(kNotANumber);
  if (!std::isfinite(lower) || !std::isfinite(upper) || lower > upper || (positive && lower <= 0.0))
    refuse(campaign, node, key, allowed);
  return {lower, upper};
}

SampledKey read_law(const Campaign& campaign, const toml::table& table, const std::string& key) {
  SampledKey sampled;
  sampled.key = key;
  if (table.size() != 1)
    refuse(campaign, table, "sample.keys." + key, "exactly one of uniform, log_uniform, choice, chance");
  const std::string law(table.begin()->first.str());
  const toml::node& node = table.begin()->second;
  const std::string name = "sample.keys." + key + "." + law;
  if (law == "uniform" || law == "log_uniform") {
    sampled.law = law == "uniform" ? SampledKey::Law::Uniform : SampledKey::Law::LogUniform;
    std::tie(sampled.lower, sampled.upper) = read_range(campaign, node, name, law == "log_uniform");
  } else if (law == "chance") {
    sampled.law = SampledKey::Law::Chance;
    sampled.probability = node.is_number() ? node.value<double>().value_or(-1.0) : -1.0;
    if (!(sampled.probability >= 0.0 && sampled.probability <= 1.0))
      refuse(campaign, node, name, "a probability from 0 to 1");
  } else {
    sampled.law = SampledKey::Law::Choice;
    const toml::array* array = node.as_array();
    if (array == nullptr || array->empty()) refuse(campaign, node, name, "a list of values");
    for (const toml::node& element : *array) {
      if (element.is_table() || element.is_array()) refuse(campaign, node, name, "a list of plain values");
      sampled.choices.push_back(literal(element));
    }
  }
  return sampled;
}

/// Keys may be written as "a.b" = {…} or as tables; a table that holds a law is one key.
void read_sampled(Campaign& campaign, const toml::table& table, const std::string& prefix) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string(key.str());
    if (!node.is_table()) refuse(campaign, node, "sample.keys." + name, "a table, e.g. { uniform = [0, 60] }");
    const toml::table& inner = *node.as_table();
    const bool law = std::any_of(inner.begin(), inner.end(), [](const auto& entry) {
      return std::find(kLaws.begin(), kLaws.end(), entry.first.str()) != kLaws.end();
    });
    if (law) {
      campaign.sampled.push_back(read_law(campaign, inner, name));
    } else if (inner.empty()) {
      refuse(campaign, node, "sample.keys." + name, "one of uniform, log_uniform, choice, chance");
    } else {
      read_sampled(campaign, inner, name + ".");
    }
  }
}

void read_sample(Campaign& campaign, const toml::table& sample) {
  check_keys(campaign, sample, "sample.", {"draw", "keys"});
  if (const toml::node* draw = sample.get("draw")) {
    const auto names = mechanism_draws();
    campaign.draw = draw->value<std::string>().value_or("");
    if (std::find(names.begin(), names.end(), campaign.draw) == names.end()) {
      refuse(campaign, *draw, "sample.draw", fmt::format("{}", fmt::join(names, ", ")));
    }
  }
  if (const toml::table* keys = find_table(campaign, sample, "keys")) read_sampled(campaign, *keys, "");
  std::sort(campaign.sampled.begin(), campaign.sampled.end(),
            [](const SampledKey& a, const SampledKey& b) { return a.key < b.key; });
}

void read_table(Campaign& campaign, const toml::table& table) {
  check_keys(campaign, table, "table.", {"from", "ids"});
  const toml::node* from = table.get("from");
  if (from == nullptr) throw ConfigError(place(campaign, table) + "table.from: missing; allowed: a door table (CSV)");
  if (!from->is_string()) refuse(campaign, *from, "table.from", "a path in quotes");
  const std::filesystem::path path = from->value<std::string>().value_or("");
  campaign.table = (std::filesystem::absolute(campaign.file).parent_path() / path).lexically_normal();
  const std::vector<std::string> known = list_doors(campaign.table);
  const toml::node* ids = table.get("ids");
  if (ids == nullptr || ids->value<std::string>() == "all") {
    campaign.doors = known;
    return;
  }
  if (!ids->is_array() || ids->as_array()->empty()) refuse(campaign, *ids, "table.ids", "\"all\" or a list of ids");
  for (const toml::node& id : *ids->as_array()) {
    const std::string name = id.value<std::string>().value_or("");
    if (std::find(known.begin(), known.end(), name) == known.end())
      refuse(campaign, id, "table.ids", "ids of " + campaign.table.string());
    campaign.doors.push_back(name);
  }
}

std::int64_t read_integer(const Campaign& campaign, const toml::node& node, const std::string& key, std::int64_t least,
                          const char* allowed) {
  const auto value = node.is_integer() ? node.value<std::int64_t>() : std::nullopt;
  if (!value || *value < least) refuse(campaign, node, key, allowed);
  return *value;
}

/// Lines of the keys of [base], so that what the scenario refuses is told with the line of the campaign file.
void collect_lines(const toml::table& table, const std::string& prefix,
                   std::vector<std::pair<std::string, std::uint32_t>>& lines) {
  for (const auto& [key, node] : table) {
    const std::string name = prefix + std::string(key.str());
    lines.emplace_back(name, node.source().begin.line);
    if (node.is_table()) collect_lines(*node.as_table(), name + ".", lines);
  }
}

void check_first_run(const Campaign& campaign, const toml::table& tree) {
  try {
    static_cast<void>(make_run(campaign, 0));
  } catch (const ConfigError& error) {
    std::vector<std::pair<std::string, std::uint32_t>> lines;
    for (const auto* table : {tree["base"].as_table(), tree["sample"]["keys"].as_table()}) {
      if (table != nullptr) collect_lines(*table, "", lines);
    }
    const std::string message = error.what();
    std::uint32_t line = tree.get("base") != nullptr ? tree.get("base")->source().begin.line : 1;
    std::size_t longest = 0;
    for (const auto& [name, where] : lines) {
      if (message.find(name) == std::string::npos || name.size() <= longest) continue;
      longest = name.size();
      line = where;
    }
    throw ConfigError(fmt::format("{}:{}: {}", campaign.file.string(), line, message));
  }
}

toml::table parse(const std::string& text, const std::string& name) {
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw ConfigError(fmt::format("{}:{}: not TOML: {}", name, error.source().begin.line, error.description()));
  }
}

}  // namespace

Campaign load_campaign(const std::filesystem::path& file) {
  Campaign campaign;
  campaign.file = file;
  campaign.text = read_file(file);
  const toml::table tree = parse(campaign.text, file.string());
  check_keys(campaign, tree, "", {"runs", "seed", "sample", "table", "base"});
  if (const toml::table* sample = find_table(campaign, tree, "sample")) read_sample(campaign, *sample);
  if (const toml::table* table = find_table(campaign, tree, "table")) read_table(campaign, *table);
  if (const toml::table* base = find_table(campaign, tree, "base")) {
    std::ostringstream text;
    text << *base << '\n';
    campaign.base = text.str();
    const bool mechanism = base->contains("mechanism");
    if (mechanism && !campaign.draw.empty())
      refuse(campaign, *base->get("mechanism"), "base.mechanism", "nothing where sample.draw is given");
    if (mechanism && !campaign.table.empty())
      refuse(campaign, *base->get("mechanism"), "base.mechanism", "nothing where [table] is given");
  }
  if (!campaign.draw.empty() && !campaign.table.empty())
    throw ConfigError(file.string() + ":1: allowed: either sample.draw or [table], not both");
  campaign.runs = static_cast<int>(campaign.doors.size());
  if (const toml::node* runs = tree.get("runs")) {
    campaign.runs = static_cast<int>(
        std::min<std::int64_t>(read_integer(campaign, *runs, "runs", 1, "a whole number of at least 1"), 10000000));
  }
  if (campaign.runs < 1) throw ConfigError(file.string() + ":1: runs: missing; allowed: a whole number of at least 1");
  if (const toml::node* seed = tree.get("seed")) {
    campaign.seed = static_cast<std::uint64_t>(read_integer(campaign, *seed, "seed", 0, "a whole number of at least 0"));
  }
  check_first_run(campaign, tree);
  return campaign;
}

}  // namespace ajar
