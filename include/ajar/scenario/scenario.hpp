#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "ajar/mechanism/builders.hpp"
#include "ajar/mission/mission.hpp"
#include "ajar/plant/plant.hpp"

namespace ajar {

/// Where the mechanism comes from: exactly one of the three forms.
struct MechanismSource {
  enum class Form { Described, Table, Mjcf };
  Form form = Form::Described;
  MechanismConfig described;    ///< Form::Described
  std::filesystem::path table;  ///< Form::Table: door table
  std::string id;               ///< Form::Table: row
  std::filesystem::path mjcf;   ///< Form::Mjcf: model file
  std::string joint;            ///< Form::Mjcf
  std::string handle_site;      ///< Form::Mjcf
};

/// Start of the base; default: in front of the handle with an error.
struct StartConfig {
  double distance = 1.6;                      ///< From the handle, along its normal [m]
  double sideways = 0.3;                      ///< [m]
  double heading_error = 0.2617993877991494;  ///< From facing the handle; 15° [rad]
  bool operator==(const StartConfig&) const = default;
};

/// One TOML file: robot, mechanism, plant, controller, gains, seed and stop conditions.
struct Scenario {
  std::filesystem::path file;  ///< Where it was read from; relative paths start there
  std::string robot = "heron";
  std::uint64_t seed = 1;
  MechanismSource mechanism;
  BeliefConfig belief;
  StartConfig start;
  PlantConfig plant;
  MissionConfig mission;
};

/// Reads a scenario; `overrides` are KEY=VALUE with dotted keys, VALUE in TOML, a bare word is a text. An override that
/// changes the form or the type of the mechanism drops the file's keys that only the old one has.
/// @throws ConfigError, IoError  naming file, line, key, value and what is allowed; unknown keys name the nearest valid one
[[nodiscard]] Scenario load_scenario(const std::filesystem::path& file, const std::vector<std::string>& overrides = {});

/// The same from text; `file` is the name for messages and the place where relative paths start.
/// @throws ConfigError, IoError
[[nodiscard]] Scenario parse_scenario(const std::string& text, const std::filesystem::path& file,
                                      const std::vector<std::string>& overrides = {});

/// The complete scenario as TOML, all defaults included; reading it again gives the same scenario.
[[nodiscard]] std::string to_toml(const Scenario& scenario);

/// All keys with type, default, unit and meaning, as Markdown.
[[nodiscard]] std::string scenario_reference();

/// Checks what single keys cannot tell. @throws ConfigError
void validate(const Scenario& scenario);

}  // namespace ajar
