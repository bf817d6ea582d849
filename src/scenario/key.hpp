#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "ajar/core/types.hpp"
#include "ajar/scenario/scenario.hpp"

namespace ajar::scenario {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
/// One degree [rad].
inline constexpr double kDegree = std::numbers::pi / 180.0;

/// Numbers that a key takes, in the unit of the file.
struct Range {
  double lower = -kInfinity;
  double upper = kInfinity;
  bool above = false;  ///< True: lower itself is not allowed
};

inline constexpr Range kAny{};
inline constexpr Range kPositive{0.0, kInfinity, true};
inline constexpr Range kNotNegative{0.0, kInfinity, false};
inline constexpr Range kShare{0.0, 1.0, false};

/// How a number of the file becomes the number of the program.
struct Unit {
  std::string name = "-";  ///< As printed
  double scale = 1.0;      ///< Program value = scale · file value …
  bool inverse = false;    ///< … or 1 / file value
};

[[nodiscard]] inline double to_program(const Unit& unit, double value) noexcept {
  return unit.inverse ? 1.0 / value : unit.scale * value;
}

/// A closed set of words that stands for an enumeration.
struct Choice {
  std::function<int()> get;
  std::function<void(int)> set;
};

/// A value that the file may state but not change: the robot is never told it.
struct Fixed {
  double value = 0.0;
};

/// The variable that a key stands for.
using Target = std::variant<double*, int*, std::uint64_t*, bool*, std::string*, std::filesystem::path*, std::vector<double>*,
                            Vector2d*, Vector3d*, std::optional<double>*, Choice, Fixed, std::vector<Fault>*>;

/// One key of a scenario: the single place that names it, bounds it, explains it and says where its value lives.
/// Reading, writing and the reference all go through it.
struct Key {
  std::string name;  ///< Dotted
  Target target;
  Unit unit;
  Range range;
  std::vector<std::string> words;  ///< Allowed words; for an optional number the word that means none
  std::string meaning;
  bool required = false;
};

/// Adds the keys of one table.
class Section {
 public:
  Section(std::vector<Key>& keys, std::string prefix) : keys_(&keys), prefix_(std::move(prefix)) {}

  /// A table within this one.
  [[nodiscard]] Section table(const std::string& name) const { return {*keys_, prefix_ + name + "."}; }

  void number(const std::string& name, double& value, const Range& range, const std::string& unit,
              const std::string& meaning);
  void degrees(const std::string& name, double& value, const Range& range, const std::string& meaning);
  void milliseconds(const std::string& name, double& value, const Range& range, const std::string& meaning);
  /// A rate in the file, its inverse in the program.
  void rate(const std::string& name, double& period, const Range& range, const std::string& meaning);
  void integer(const std::string& name, int& value, const Range& range, const std::string& meaning);
  void seed(const std::string& name, std::uint64_t& value, const std::string& meaning);
  void flag(const std::string& name, bool& value, const std::string& meaning);
  /// Without words any text but the empty one is allowed.
  void word(const std::string& name, std::string& value, const std::vector<std::string>& words, const std::string& meaning);
  void required_word(const std::string& name, std::string& value, const std::vector<std::string>& words,
                     const std::string& meaning);
  void required_file(const std::string& name, std::filesystem::path& value, const std::string& meaning);
  void numbers(const std::string& name, std::vector<double>& value, const Range& range, const Unit& unit,
               const std::string& meaning);
  void vector(const std::string& name, Vector2d& value, const std::string& unit, const std::string& meaning);
  void vector(const std::string& name, Vector3d& value, const std::string& unit, const std::string& meaning);
  /// A number in the unit and range of the key, or the word that means none.
  void optional_number(const std::string& name, std::optional<double>& value, const Range& range, const Unit& unit,
                       const std::string& none, const std::string& meaning);
  /// Words in the order of the enumeration.
  template <class Enum>
  void choice(const std::string& name, Enum& value, const std::vector<std::string>& words, const std::string& meaning) {
    Enum* const place = &value;
    add(name, Choice{[place] { return static_cast<int>(*place); }, [place](int i) { *place = static_cast<Enum>(i); }},
        meaning)
        .words = words;
  }
  void fixed(const std::string& name, double value, const std::string& unit, const std::string& meaning);
  void faults(const std::string& name, std::vector<Fault>& value, const std::string& meaning);

 private:
  Key& add(const std::string& name, Target target, const std::string& meaning);

  std::vector<Key>* keys_;
  std::string prefix_;
};

// The tables, in the order in which they are written.

/// All keys of a scenario with the form and the type of mechanism that it has; their targets point into it.
[[nodiscard]] std::vector<Key> bind_keys(Scenario& scenario);
/// Keys of one [[plant.fault]].
[[nodiscard]] std::vector<Key> bind_fault(Fault& fault);
/// The keys `robot` and `seed`.
void bind_top(Section top, Scenario& scenario);
/// Names of the keys of [mechanism] in all its forms and types.
[[nodiscard]] const std::vector<std::string>& mechanism_names();
void bind_mechanism(Section section, MechanismSource& source);
void bind_world(Section top, Scenario& scenario);
void bind_control(Section section, MissionConfig& mission);

// Text.

/// Value in the notation of TOML, shortest text that reads back to the same number; empty for faults.
[[nodiscard]] std::string value_text(const Key& key);
/// What the key takes, in words.
[[nodiscard]] std::string allowed_text(const Key& key);
/// A number of the program as the number of the file, shortest text that reads back to the same number.
[[nodiscard]] std::string number_text(const Unit& unit, double value);
/// Moves a number to the nearest one that the file can express exactly (degrees and rates), so that a written scenario reads
/// back the same.
void make_expressible(const Key& key);
/// The name among `names` that is meant by an unknown one.
[[nodiscard]] std::string nearest_name(const std::string& unknown, const std::vector<std::string>& names);
/// A scenario with the defaults that a file starts from.
[[nodiscard]] Scenario default_scenario();
/// The defaults of a mechanism of that type; lengths and angles share fields, so each type has its own.
[[nodiscard]] MechanismSource with_type(MechanismSource source, const std::string& type);

}  // namespace ajar::scenario
