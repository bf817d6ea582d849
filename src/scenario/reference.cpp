// Writing: the complete scenario and the reference of its keys, both from the same table of keys that reads.
#include <fmt/format.h>

#include "key.hpp"

namespace ajar {

namespace {

using scenario::Key;

std::string table_of(const std::string& name) {
  const auto dot = name.rfind('.');
  return dot == std::string::npos ? "" : name.substr(0, dot);
}

std::string leaf_of(const std::string& name) { return name.substr(name.rfind('.') + 1); }

void write_faults(std::string& out, const std::vector<Fault>& faults) {
  for (Fault fault : faults) {
    out += "\n[[plant.fault]]\n";
    for (const Key& key : scenario::bind_fault(fault)) out += leaf_of(key.name) + " = " + scenario::value_text(key) + "\n";
  }
}

void reference_table(std::string& out, const std::string& title, const std::vector<Key>& keys) {
  out += fmt::format("\n## {}\n\n| key | default | allowed | unit | meaning |\n|---|---|---|---|---|\n", title);
  for (const Key& key : keys) {
    const std::string standard = key.required ? "required" : fmt::format("`{}`", scenario::value_text(key));
    out += fmt::format("| `{}` | {} | {} | {} | {} |\n", leaf_of(key.name), standard, scenario::allowed_text(key),
                       key.unit.name, key.meaning);
  }
}

/// Tables of the keys, one per section, in order.
void reference_sections(std::string& out, const std::vector<Key>& keys, const std::string& note) {
  std::vector<Key> section;
  const auto flush = [&] {
    if (section.empty()) return;
    const std::string table = table_of(section.front().name);
    reference_table(out, table.empty() ? "Top of the file" : "`[" + table + "]`" + note, section);
    section.clear();
  };
  for (const Key& key : keys) {
    if (std::holds_alternative<std::vector<Fault>*>(key.target)) continue;
    if (!section.empty() && table_of(section.front().name) != table_of(key.name)) flush();
    section.push_back(key);
  }
  flush();
}

std::vector<Key> mechanism_keys(MechanismSource& source) {
  std::vector<Key> keys;
  scenario::bind_mechanism(scenario::Section(keys, "mechanism."), source);
  return keys;
}

}  // namespace

std::string to_toml(const Scenario& original) {
  Scenario copy = original;
  std::string out;
  std::string table;
  for (const Key& key : scenario::bind_keys(copy)) {
    if (const auto* const faults = std::get_if<std::vector<Fault>*>(&key.target)) {
      write_faults(out, **faults);
      continue;
    }
    if (table_of(key.name) != table) {
      table = table_of(key.name);
      out += fmt::format("\n[{}]\n", table);
    }
    out += leaf_of(key.name) + " = " + scenario::value_text(key) + "\n";
  }
  return out;
}

std::string scenario_reference() {
  Scenario defaults = scenario::default_scenario();
  std::string out =
      "# Keys of a scenario\n\n"
      "Written by `ajar validate --reference`; do not edit by hand.\n\n"
      "A scenario is one TOML file. Every key has a default but those of `[mechanism]` marked *required*; a key that is not "
      "listed here is an error.\n"
      "Any key can be set on the command line: `ajar run FILE --set control.rate_hz=125`; a word needs no quotes there.\n"
      "Numbers are in SI units and radians unless the name of the key says otherwise. Relative paths start at the folder of "
      "the file.\n"
      "`[mechanism]` has exactly one of three forms: described by `type`, a row of a door table by `from`, or a model by "
      "`mjcf`.\n";
  std::vector<Key> world;
  scenario::bind_top(scenario::Section(world, ""), defaults);
  reference_sections(out, world, "");

  MechanismSource hinge = defaults.mechanism;
  MechanismSource slide = scenario::with_type(defaults.mechanism, "slide");
  MechanismSource table;
  table.form = MechanismSource::Form::Table;
  MechanismSource mjcf;
  mjcf.form = MechanismSource::Form::Mjcf;
  reference_sections(out, mechanism_keys(hinge), " with `type = \"hinge\"`");
  reference_sections(out, mechanism_keys(slide), " with `type = \"slide\"`");
  reference_sections(out, mechanism_keys(table), " from a door table");
  reference_sections(out, mechanism_keys(mjcf), " from a model");

  world.clear();
  scenario::bind_world(scenario::Section(world, ""), defaults);
  reference_sections(out, world, "");
  Fault fault;
  reference_table(out, "`[[plant.fault]]`, any number of times", scenario::bind_fault(fault));
  return out;
}

}  // namespace ajar
