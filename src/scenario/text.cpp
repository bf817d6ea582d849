// Values as text: what is written into a scenario, a message and the reference.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "key.hpp"

namespace ajar::scenario {

namespace {

template <class... Ts>
struct Overloaded : Ts... {
  using Ts::operator()...;
};
template <class... Ts>
Overloaded(Ts...) -> Overloaded<Ts...>;

/// Shortest text of a double; always recognisable as a floating-point number.
std::string plain(double value) {
  std::string text = fmt::format("{}", value);
  if (text.find_first_of(".en") == std::string::npos) text += ".0";
  return text;
}

bool reads_back(const Unit& unit, double file_value, double value) { return to_program(unit, file_value) == value; }

/// The number of the file that gives `value` exactly, or the closest one.
double file_number(const Unit& unit, double value) {
  const double close = unit.inverse ? 1.0 / value : value / unit.scale;
  for (int digits = 1; digits <= 17; ++digits) {
    const double rounded = std::strtod(fmt::format("{:.{}g}", close, digits).c_str(), nullptr);
    if (reads_back(unit, rounded, value)) return rounded;
  }
  // Scaling rounds: a neighbour within two units in the last place may give the value exactly.
  double below = close;
  double above = close;
  for (int step = 0; step < 2; ++step) {
    below = std::nextafter(below, -kInfinity);
    above = std::nextafter(above, kInfinity);
    if (reads_back(unit, below, value)) return below;
    if (reads_back(unit, above, value)) return above;
  }
  return close;
}

bool converts(const Unit& unit) { return unit.inverse || unit.scale != 1.0; }

/// A basic TOML string.
std::string toml_string(const std::string& text) {
  std::string out = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      out += '\\';
      out += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      out += fmt::format("\\u{:04X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
    } else {
      out += c;
    }
  }
  return out + "\"";
}

template <class Values>
std::string list_text(const Unit& unit, const Values& values) {
  std::string out = "[";
  for (const double value : values) out += (out.size() > 1 ? ", " : "") + number_text(unit, value);
  return out + "]";
}

std::string range_text(const Key& key, bool whole) {
  const auto limit = [&](double value) { return whole ? fmt::format("{:.0f}", value) : fmt::format("{}", value); };
  const Range& r = key.range;
  const std::string unit = key.unit.name == "-" ? "" : " " + key.unit.name;
  const bool lower = std::isfinite(r.lower);
  const bool upper = std::isfinite(r.upper);
  if (lower && upper && r.lower == r.upper) return limit(r.lower) + unit;
  if (lower && upper) return fmt::format("{} {} … {}{}", r.above ? "above" : "from", limit(r.lower), limit(r.upper), unit);
  if (lower) return fmt::format("{} {}{}", r.above ? "above" : "at least", limit(r.lower), unit);
  return "any finite number" + (unit.empty() ? "" : " [" + key.unit.name + "]");
}

std::string words_text(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) out += i + 1 == words.size() ? " or " : ", ";
    out += toml_string(words[i]);
  }
  return out;
}

/// Levenshtein's distance.
std::size_t edit_distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) row[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t above = row[j];
      row[j] = std::min({above + 1, row[j - 1] + 1, diagonal + (a[i - 1] == b[j - 1] ? 0 : 1)});
      diagonal = above;
    }
  }
  return row[b.size()];
}

std::string last_part(const std::string& name) { return name.substr(name.rfind('.') + 1); }
std::string parent_of(const std::string& name) {
  const auto dot = name.rfind('.');
  return dot == std::string::npos ? "" : name.substr(0, dot);
}

}  // namespace

std::string number_text(const Unit& unit, double value) { return plain(converts(unit) ? file_number(unit, value) : value); }

std::string value_text(const Key& key) {
  return std::visit<std::string>(
      Overloaded{
          [&](double* v) { return number_text(key.unit, *v); }, [](int* v) { return fmt::format("{}", *v); },
          [](std::uint64_t* v) { return fmt::format("{}", *v); }, [](bool* v) { return std::string(*v ? "true" : "false"); },
          [](std::string* v) { return toml_string(*v); }, [](std::filesystem::path* v) { return toml_string(v->string()); },
          [&](std::vector<double>* v) { return list_text(key.unit, *v); },
          [&](Vector2d* v) { return list_text(key.unit, *v); }, [&](Vector3d* v) { return list_text(key.unit, *v); },
          [&](std::optional<double>* v) {
            return v->has_value() ? number_text(key.unit, **v) : toml_string(key.words.front());
          },
          [&](const Choice& v) { return toml_string(key.words.at(static_cast<std::size_t>(v.get()))); },
          [&](const Fixed& v) { return number_text(key.unit, v.value); }, [](std::vector<Fault>*) { return std::string(); }},
      key.target);
}

std::string allowed_text(const Key& key) {
  return std::visit<std::string>(
      Overloaded{[&](double*) { return range_text(key, false); },
                 [&](int*) { return "a whole number " + range_text(key, true); },
                 [&](std::uint64_t*) { return "a whole number " + range_text(key, true); },
                 [](bool*) { return std::string("true or false"); },
                 [&](std::string*) { return key.words.empty() ? "a text in quotes" : words_text(key.words); },
                 [](std::filesystem::path*) { return std::string("a path in quotes"); },
                 [&](std::vector<double>*) { return "a list of at least one number " + range_text(key, false); },
                 [](Vector2d*) { return std::string("a list of 2 finite numbers"); },
                 [](Vector3d*) { return std::string("a list of 3 finite numbers, not all zero"); },
                 [&](std::optional<double>*) { return range_text(key, false) + " or " + words_text(key.words); },
                 [&](const Choice&) { return words_text(key.words); },
                 [&](const Fixed&) { return "only " + range_text(key, false); },
                 [](std::vector<Fault>*) { return std::string("tables [[plant.fault]]"); }},
      key.target);
}

void make_expressible(const Key& key) {
  if (!converts(key.unit)) return;
  const auto move = [&](double& value) { value = to_program(key.unit, file_number(key.unit, value)); };
  if (auto* const number = std::get_if<double*>(&key.target)) move(**number);
  if (auto* const list = std::get_if<std::vector<double>*>(&key.target))
    std::for_each((*list)->begin(), (*list)->end(), move);
  if (auto* const maybe = std::get_if<std::optional<double>*>(&key.target)) {
    std::optional<double>& value = **maybe;
    if (value) move(*value);
  }
}

std::string nearest_name(const std::string& unknown, const std::vector<std::string>& names) {
  std::string best;
  double best_cost = kInfinity;
  for (const std::string& name : names) {
    // A key of the right name in the wrong table is meant as often as a slip of the pen in the right one.
    double cost = static_cast<double>(edit_distance(unknown, name));
    if (last_part(name) == last_part(unknown)) cost = std::min(cost, 1.5);
    if (parent_of(name) == parent_of(unknown)) {
      // A name without its unit, as in radius for radius_m.
      if (last_part(name).rfind(last_part(unknown) + "_", 0) == 0) cost = std::min(cost, 1.2);
      cost -= 0.5;
    }
    if (cost < best_cost) {
      best_cost = cost;
      best = name;
    }
  }
  return best;
}

}  // namespace ajar::scenario
