#include "key.hpp"

namespace ajar::scenario {

Key& Section::add(const std::string& name, Target target, const std::string& meaning) {
  Key& key = keys_->emplace_back();
  key.name = prefix_ + name;
  key.target = std::move(target);
  key.meaning = meaning;
  return key;
}

void Section::number(const std::string& name, double& value, const Range& range, const std::string& unit,
                     const std::string& meaning) {
  Key& key = add(name, &value, meaning);
  key.range = range;
  key.unit.name = unit;
}

void Section::degrees(const std::string& name, double& value, const Range& range, const std::string& meaning) {
  number(name, value, range, "°", meaning);
  keys_->back().unit.scale = kDegree;
}

void Section::milliseconds(const std::string& name, double& value, const Range& range, const std::string& meaning) {
  number(name, value, range, "ms", meaning);
  keys_->back().unit.scale = 1e-3;
}

void Section::rate(const std::string& name, double& period, const Range& range, const std::string& meaning) {
  number(name, period, range, "Hz", meaning);
  keys_->back().unit.inverse = true;
}

void Section::integer(const std::string& name, int& value, const Range& range, const std::string& meaning) {
  add(name, &value, meaning).range = range;
}

void Section::seed(const std::string& name, std::uint64_t& value, const std::string& meaning) {
  add(name, &value, meaning).range = kNotNegative;
}

void Section::flag(const std::string& name, bool& value, const std::string& meaning) { add(name, &value, meaning); }

void Section::word(const std::string& name, std::string& value, const std::vector<std::string>& words,
                   const std::string& meaning) {
  add(name, &value, meaning).words = words;
}

void Section::required_word(const std::string& name, std::string& value, const std::vector<std::string>& words,
                            const std::string& meaning) {
  word(name, value, words, meaning);
  keys_->back().required = true;
}

void Section::required_file(const std::string& name, std::filesystem::path& value, const std::string& meaning) {
  add(name, &value, meaning).required = true;
}

void Section::numbers(const std::string& name, std::vector<double>& value, const Range& range, const Unit& unit,
                      const std::string& meaning) {
  Key& key = add(name, &value, meaning);
  key.range = range;
  key.unit = unit;
}

void Section::vector(const std::string& name, Vector2d& value, const std::string& unit, const std::string& meaning) {
  add(name, &value, meaning).unit.name = unit;
}

void Section::vector(const std::string& name, Vector3d& value, const std::string& unit, const std::string& meaning) {
  add(name, &value, meaning).unit.name = unit;
}

void Section::optional_number(const std::string& name, std::optional<double>& value, const Range& range, const Unit& unit,
                              const std::string& none, const std::string& meaning) {
  Key& key = add(name, &value, meaning);
  key.range = range;
  key.unit = unit;
  key.words = {none};
}

void Section::fixed(const std::string& name, double value, const std::string& unit, const std::string& meaning) {
  Key& key = add(name, Fixed{value}, meaning);
  key.unit.name = unit;
  key.range = {value, value, false};
}

void Section::faults(const std::string& name, std::vector<Fault>& value, const std::string& meaning) {
  add(name, &value, meaning);
}

}  // namespace ajar::scenario
