// Reading: from the values of a file to the structures, through the table of keys.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "ajar/core/error.hpp"
#include "key.hpp"
#include "toml_tree.hpp"

namespace ajar {

namespace {

using scenario::from_override;
using scenario::Key;
using scenario::kOverride;

/// What is known while a file is read.
struct Reader {
  std::string file;
};

/// "file:line: " or "--set: ".
std::string place(const Reader& reader, const toml::node& node) {
  if (from_override(node)) return kOverride + ": ";
  return fmt::format("{}:{}: ", reader.file, node.source().begin.line);
}

/// A value as it stands in the file, on one line.
std::string shown(const toml::node& node) {
  if (node.is_table()) return "a table";
  std::ostringstream text;
  if (const auto* const word = node.as_string()) {
    text << '"' << word->get() << '"';
  } else if (const auto* const array = node.as_array()) {
    text << '[';
    for (const toml::node& element : *array) text << (&element == array->get(0) ? "" : ", ") << shown(element);
    text << ']';
  } else {
    node.visit([&](const auto& value) {
      if constexpr (toml::is_value<decltype(value)>) text << value;
    });
  }
  return text.str();
}

[[noreturn]] void refuse(const Reader& reader, const toml::node& node, const std::string& name, const std::string& allowed) {
  throw ConfigError(fmt::format("{}{} = {}: allowed: {}", place(reader, node), name, shown(node), allowed));
}

bool inside(const scenario::Range& range, double value) {
  return std::isfinite(value) && value <= range.upper && (range.above ? value > range.lower : value >= range.lower);
}

std::optional<double> number_of(const toml::node& node) {
  if (!node.is_floating_point() && !node.is_integer()) return std::nullopt;
  return node.value<double>();
}

std::optional<double> ranged(const toml::node& node, const Key& key) {
  const auto value = number_of(node);
  return value && inside(key.range, *value) ? value : std::nullopt;
}

std::vector<double> numbers_of(const toml::node& node) {
  std::vector<double> out;
  const auto* const array = node.as_array();
  if (array == nullptr) return out;
  for (const toml::node& element : *array) {
    const auto value = number_of(element);
    if (!value || !std::isfinite(*value)) return {};
    out.push_back(*value);
  }
  return out;
}

template <class Vector>
bool read_vector(const toml::node& node, Vector& target) {
  const auto values = numbers_of(node);
  if (values.size() != static_cast<std::size_t>(target.size())) return false;
  Vector read = Vector::Zero();
  for (std::size_t i = 0; i < values.size(); ++i) read(static_cast<Eigen::Index>(i)) = values[i];
  if (target.size() == 3 && read.norm() < 1e-9) return false;
  target = read;
  return true;
}

void read_faults(const Reader& reader, const toml::node& node, std::vector<Fault>& target);

/// Puts one value of the file where its key says. @return false if it is not allowed
struct Assign {
  const Reader& reader;
  const Key& key;
  const toml::node& node;

  bool operator()(double* target) const {
    const auto value = ranged(node, key);
    if (value) *target = scenario::to_program(key.unit, *value);
    return value.has_value();
  }
  bool operator()(int* target) const {
    const auto value = ranged(node, key);
    if (!value || !node.is_integer()) return false;
    *target = static_cast<int>(*value);
    return true;
  }
  bool operator()(std::uint64_t* target) const {
    const auto* const value = node.as_integer();
    if (value == nullptr || value->get() < 0) return false;
    *target = static_cast<std::uint64_t>(value->get());
    return true;
  }
  bool operator()(bool* target) const {
    const auto* const value = node.as_boolean();
    if (value != nullptr) *target = value->get();
    return value != nullptr;
  }
  bool operator()(std::string* target) const {
    const auto* const value = node.as_string();
    if (value == nullptr || value->get().empty()) return false;
    if (!key.words.empty() && std::find(key.words.begin(), key.words.end(), value->get()) == key.words.end()) return false;
    *target = value->get();
    return true;
  }
  bool operator()(std::filesystem::path* target) const {
    const auto* const value = node.as_string();
    if (value == nullptr || value->get().empty()) return false;
    *target = value->get();
    return true;
  }
  bool operator()(std::vector<double>* target) const {
    auto values = numbers_of(node);
    if (values.empty() || !std::all_of(values.begin(), values.end(), [&](double v) { return inside(key.range, v); }))
      return false;
    std::transform(values.begin(), values.end(), values.begin(),
                   [&](double v) { return scenario::to_program(key.unit, v); });
    *target = values;
    return true;
  }
  bool operator()(Vector2d* target) const { return read_vector(node, *target); }
  bool operator()(Vector3d* target) const { return read_vector(node, *target); }
  bool operator()(std::optional<double>* target) const {
    const auto* const word = node.as_string();
    if (word != nullptr && word->get() == key.words.front()) {
      target->reset();
      return true;
    }
    const auto value = ranged(node, key);
    if (value) *target = scenario::to_program(key.unit, *value);
    return value.has_value();
  }
  bool operator()(const scenario::Choice& target) const {
    const auto* const value = node.as_string();
    const auto found = value == nullptr ? key.words.end() : std::find(key.words.begin(), key.words.end(), value->get());
    if (found == key.words.end()) return false;
    target.set(static_cast<int>(found - key.words.begin()));
    return true;
  }
  bool operator()(const scenario::Fixed&) const { return ranged(node, key).has_value(); }
  bool operator()(std::vector<Fault>* target) const {
    if (!node.is_array()) return false;
    read_faults(reader, node, *target);
    return true;
  }
};

void read_key(const Reader& reader, const Key& key, const toml::node& node) {
  if (!std::visit(Assign{reader, key, node}, key.target)) refuse(reader, node, key.name, scenario::allowed_text(key));
}

const Key* find_key(const std::vector<Key>& keys, const std::string& name) {
  const auto found = std::find_if(keys.begin(), keys.end(), [&](const Key& key) { return key.name == name; });
  return found == keys.end() ? nullptr : &*found;
}

bool is_table_name(const std::vector<Key>& keys, const std::string& name) {
  return std::any_of(keys.begin(), keys.end(), [&](const Key& key) { return key.name.rfind(name + ".", 0) == 0; });
}

/// A value of the file and its dotted name.
struct Leaf {
  std::string name;
  const toml::node* node;
};

/// All values below a table, in the order of the file, overrides last.
std::vector<Leaf> leaves_of(const toml::table& tree, const std::vector<Key>& keys) {
  std::vector<Leaf> out;
  const auto visit = [&](const auto& self, const toml::table& table, const std::string& prefix) -> void {
    for (const auto& [key, node] : table) {
      const std::string name = prefix + std::string(key.str());
      if (node.is_table() && is_table_name(keys, name)) {
        self(self, *node.as_table(), name + ".");
      } else {
        out.push_back({name, &node});
      }
    }
  };
  visit(visit, tree, "");
  std::stable_sort(out.begin(), out.end(), [](const Leaf& a, const Leaf& b) {
    const auto rank = [](const Leaf& leaf) {
      const auto& begin = leaf.node->source().begin;
      return std::make_tuple(from_override(*leaf.node), begin.line, begin.column);
    };
    return rank(a) < rank(b);
  });
  return out;
}

[[noreturn]] void refuse_unknown(const Reader& reader, const Leaf& leaf, const std::vector<Key>& keys) {
  std::vector<std::string> names;
  for (const Key& key : keys) {
    names.push_back(key.name);
    const auto dot = key.name.rfind('.');
    if (dot != std::string::npos && leaf.node->is_table()) names.push_back(key.name.substr(0, dot));
  }
  if (is_table_name(keys, leaf.name)) {
    throw ConfigError(
        fmt::format("{}{} = {}: allowed: a table [{}]", place(reader, *leaf.node), leaf.name, shown(*leaf.node), leaf.name));
  }
  throw ConfigError(fmt::format("{}{}: unknown key; the nearest valid name is {}", place(reader, *leaf.node), leaf.name,
                                scenario::nearest_name(leaf.name, names)));
}

void require_keys(const Reader& reader, const std::vector<Key>& keys, const std::vector<Leaf>& leaves, std::uint32_t line) {
  for (const Key& key : keys) {
    const bool given = std::any_of(leaves.begin(), leaves.end(), [&](const Leaf& leaf) { return leaf.name == key.name; });
    if (key.required && !given) {
      throw ConfigError(
          fmt::format("{}:{}: {}: missing; allowed: {}", reader.file, line, key.name, scenario::allowed_text(key)));
    }
  }
}

void read_faults(const Reader& reader, const toml::node& node, std::vector<Fault>& target) {
  target.clear();
  for (const toml::node& element : *node.as_array()) {
    if (!element.is_table()) refuse(reader, element, "plant.fault", "a table with kind and time_s");
    Fault fault;
    const auto keys = scenario::bind_fault(fault);
    std::vector<Leaf> leaves;
    for (const auto& [name, value] : *element.as_table())
      leaves.push_back({"plant.fault." + std::string(name.str()), &value});
    for (const Leaf& leaf : leaves) {
      const Key* const key = find_key(keys, leaf.name);
      if (key == nullptr) refuse_unknown(reader, leaf, keys);
      read_key(reader, *key, *leaf.node);
    }
    require_keys(reader, keys, leaves, element.source().begin.line);
    target.push_back(fault);
  }
}

/// Which form the [mechanism] has; exactly one of `type`, `from` and `mjcf`. An override wins over the file.
MechanismSource mechanism_form(const Reader& reader, const toml::table& mechanism) {
  std::vector<std::pair<std::string, const toml::node*>> found;
  bool overridden = false;
  for (const char* const name : {"type", "from", "mjcf"}) {
    const toml::node* const node = mechanism.get(name);
    if (node == nullptr) continue;
    if (from_override(*node) && !overridden) {
      overridden = true;
      found.clear();
    }
    if (from_override(*node) || !overridden) found.emplace_back(name, node);
  }
  if (found.empty()) {
    throw ConfigError(place(reader, mechanism) + "mechanism: exactly one of type, from and mjcf must be given; none is");
  }
  if (found.size() > 1) {
    throw ConfigError(fmt::format("{}mechanism.{}: exactly one of type, from and mjcf must be given; {} is there as well",
                                  place(reader, *found[1].second), found[1].first, found[0].first));
  }
  MechanismSource source = scenario::default_scenario().mechanism;
  if (found[0].first == "from") source.form = MechanismSource::Form::Table;
  if (found[0].first == "mjcf") source.form = MechanismSource::Form::Mjcf;
  if (found[0].first == "type" && found[0].second->value<std::string>() == "slide")
    source = scenario::with_type(source, "slide");
  return source;
}

/// Reads every value; the mechanism's form is already set.
void read_tree(const Reader& reader, const toml::table& tree, Scenario& target) {
  const auto keys = scenario::bind_keys(target);
  const auto& others = scenario::mechanism_names();
  const toml::table& mechanism = *tree["mechanism"].as_table();
  const bool form_overridden = std::any_of(mechanism.begin(), mechanism.end(), [](const auto& entry) {
    return from_override(entry.second) && (entry.first == "type" || entry.first == "from" || entry.first == "mjcf");
  });
  const auto leaves = leaves_of(tree, keys);
  for (const Leaf& leaf : leaves) {
    if (const Key* const key = find_key(keys, leaf.name)) {
      read_key(reader, *key, *leaf.node);
      continue;
    }
    const bool other_form = std::any_of(others.begin(), others.end(), [&](const std::string& name) {
      return name == leaf.name || (leaf.node->is_table() && name.rfind(leaf.name + ".", 0) == 0);
    });
    // An override that changes the form or type of the mechanism replaces what the file says of the old one.
    if (other_form && form_overridden && !from_override(*leaf.node)) continue;
    if (other_form) {
      const bool described = target.mechanism.form == MechanismSource::Form::Described;
      throw ConfigError(fmt::format("{}{}: does not belong to a mechanism {}", place(reader, *leaf.node), leaf.name,
                                    described ? "of type " + target.mechanism.described.type
                                    : target.mechanism.form == MechanismSource::Form::Table ? "from a door table"
                                                                                            : "from a model"));
    }
    refuse_unknown(reader, leaf, keys);
  }
  require_keys(reader, keys, leaves, mechanism.source().begin.line);
}

/// Paths count from the folder of the scenario, so that a copy of it elsewhere still finds them.
void resolve_paths(Scenario& target) {
  const auto folder = std::filesystem::absolute(target.file).parent_path();
  const auto resolve = [&](std::filesystem::path& path) {
    if (!path.empty() && path.is_relative()) path = (folder / path).lexically_normal();
  };
  if (target.mechanism.form == MechanismSource::Form::Table) resolve(target.mechanism.table);
  if (target.mechanism.form == MechanismSource::Form::Mjcf) resolve(target.mechanism.mjcf);
  const std::filesystem::path robot = target.robot;
  std::error_code status;
  if (robot.is_relative() && robot.extension() == ".urdf" && std::filesystem::exists(folder / robot, status)) {
    target.robot = (folder / robot).lexically_normal().string();
  }
}

}  // namespace

Scenario load_scenario(const std::filesystem::path& file, const std::vector<std::string>& overrides) {
  return parse_scenario(scenario::file_text(file), file, overrides);
}

Scenario parse_scenario(const std::string& text, const std::filesystem::path& file,
                        const std::vector<std::string>& overrides) {
  const Reader reader{file.string()};
  const toml::table tree = scenario::parse_tree(text, file.string(), overrides);
  const toml::node* const mechanism = tree.get("mechanism");
  if (mechanism == nullptr)
    throw ConfigError(file.string() + ":1: mechanism: missing; a table [mechanism] with type, from or mjcf is needed");
  if (!mechanism->is_table()) refuse(reader, *mechanism, "mechanism", "a table with type, from or mjcf");

  Scenario result = scenario::default_scenario();
  result.file = file;
  result.mechanism = mechanism_form(reader, *mechanism->as_table());
  read_tree(reader, tree, result);
  for (const Key& key : scenario::bind_keys(result)) scenario::make_expressible(key);
  result.plant.delay = result.mission.dead_time;
  result.mission.force.force_limit = result.mission.limits.force;
  resolve_paths(result);
  try {
    validate(result);
  } catch (const ConfigError& error) {
    throw ConfigError(file.string() + ": " + error.what());
  }
  return result;
}

}  // namespace ajar
