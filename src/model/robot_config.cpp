#include "robot_config.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <iterator>
#include <sstream>

#include "ajar/core/error.hpp"

namespace ajar {
namespace {

// Reads one table strictly: remembers the line of each key, refuses what is not in the list of names.
class Section {
 public:
  Section(RobotConfig& config, const toml::table& root, std::string name, std::vector<std::string> names)
      : config_(config), name_(std::move(name)) {
    const toml::node* node = root.get(name_);
    if (node == nullptr) {
      throw ModelError(config_.file + ": [" + name_ + "]: missing; allowed: a table with " + join_names(names));
    }
    table_ = node->as_table();
    if (table_ == nullptr) {
      throw ModelError(at(*node) + name_ + ": not a table; allowed: [" + name_ + "]");
    }
    for (const auto& [key, value] : *table_) {
      const std::string text(key.str());
      config_.lines[name_ + "." + text] = static_cast<int>(value.source().begin.line);
      if (std::find(names.begin(), names.end(), text) == names.end()) {
        throw ModelError(at(value) + name_ + "." + text + ": unknown key; allowed: " + join_names(names));
      }
    }
  }

  [[nodiscard]] bool has(const std::string& key) const { return table_->contains(key); }

  [[nodiscard]] std::string text(const std::string& key) const {
    const toml::node& node = required(key, "a string");
    const auto value = node.value_exact<std::string>();
    if (!value || value->empty()) {
      refuse(key, node, "a string that is not empty");
    }
    return *value;
  }

  [[nodiscard]] std::string choice(const std::string& key, const std::vector<std::string>& allowed) const {
    const std::string value = text(key);
    if (std::find(allowed.begin(), allowed.end(), value) == allowed.end()) {
      refuse(key, *table_->get(key), "one of " + join_names(allowed));
    }
    return value;
  }

  [[nodiscard]] double positive(const std::string& key) const {
    const toml::node& node = required(key, "a number > 0");
    return number(key, node, true);
  }

  [[nodiscard]] std::vector<double> numbers(const std::string& key, bool positive_only) const {
    const char* allowed = positive_only ? "an array of numbers > 0" : "an array of finite numbers";
    const toml::node& node = required(key, allowed);
    if (!node.is_array()) {
      refuse(key, node, allowed);
    }
    std::vector<double> values;
    for (const toml::node& element : *node.as_array()) {
      values.push_back(number(key, element, positive_only));
    }
    return values;
  }

  [[nodiscard]] std::vector<std::string> texts(const std::string& key) const {
    const toml::node& node = required(key, "an array of strings");
    return strings(key, node);
  }

  [[nodiscard]] std::vector<std::array<std::string, 2>> pairs(const std::string& key) const {
    const char* allowed = "an array of [link, link]";
    const toml::node& node = required(key, allowed);
    if (!node.is_array()) {
      refuse(key, node, allowed);
    }
    std::vector<std::array<std::string, 2>> values;
    for (const toml::node& element : *node.as_array()) {
      const std::vector<std::string> two = strings(key, element);
      if (two.size() != 2) {
        refuse(key, element, allowed);
      }
      values.push_back({two[0], two[1]});
    }
    return values;
  }

 private:
  [[nodiscard]] std::string at(const toml::node& node) const {
    return config_.file + ":" + std::to_string(node.source().begin.line) + ": ";
  }

  [[nodiscard]] const toml::node& required(const std::string& key, const std::string& allowed) const {
    const toml::node* node = table_->get(key);
    if (node == nullptr) {
      throw ModelError(at(*table_) + name_ + "." + key + ": missing; allowed: " + allowed);
    }
    return *node;
  }

  [[noreturn]] void refuse(const std::string& key, const toml::node& node, const std::string& allowed) const {
    std::ostringstream value;
    node.visit([&value](const auto& n) { value << n; });
    throw ModelError(at(node) + name_ + "." + key + ": " + value.str() + "; allowed: " + allowed);
  }

  [[nodiscard]] double number(const std::string& key, const toml::node& node, bool positive_only) const {
    const auto value = node.is_number() ? node.value<double>() : std::nullopt;
    if (!value || !std::isfinite(*value) || (positive_only && *value <= 0.0)) {
      refuse(key, node, positive_only ? "a finite number > 0" : "a finite number");
    }
    return *value;
  }

  [[nodiscard]] std::vector<std::string> strings(const std::string& key, const toml::node& node) const {
    const toml::array* array = node.as_array();
    if (array == nullptr) {
      refuse(key, node, "an array of strings");
    }
    std::vector<std::string> values;
    for (const toml::node& element : *array) {
      const auto value = element.value_exact<std::string>();
      if (!value) {
        refuse(key, element, "a string");
      }
      values.push_back(*value);
    }
    return values;
  }

  RobotConfig& config_;
  std::string name_;
  const toml::table* table_ = nullptr;
};

void read_base(RobotConfig& config, const toml::table& root) {
  const Section base(config, root, "base",
                     {"type", "frame", "wheel_radius", "wheel_track", "forward_speed", "reverse_speed", "yaw_rate",
                      "acceleration", "yaw_acceleration", "wheel_speed"});
  config.base_type = base.choice("type", {"differential", "fixed"}) == "fixed" ? BaseType::Fixed : BaseType::Differential;
  config.base_frame = base.text("frame");
  if (config.base_type == BaseType::Fixed) {
    return;
  }
  config.wheel_radius = base.positive("wheel_radius");
  config.wheel_track = base.positive("wheel_track");
  config.limits.base_forward = base.positive("forward_speed");
  config.limits.base_reverse = base.positive("reverse_speed");
  config.limits.base_yaw_rate = base.positive("yaw_rate");
  config.limits.base_acceleration = base.positive("acceleration");
  config.limits.base_yaw_acceleration = base.positive("yaw_acceleration");
  config.limits.wheel_speed = base.positive("wheel_speed");
}

void check_length(const RobotConfig& config, const std::string& key, std::size_t length) {
  if (length != config.joints.size()) {
    throw ModelError(config.where(key) + ": " + std::to_string(length) + " values; allowed: one per joint of arm.joints (" +
                     std::to_string(config.joints.size()) + ")");
  }
}

void read_arm(RobotConfig& config, const toml::table& root) {
  const Section arm(config, root, "arm", {"joints", "velocity", "acceleration", "home"});
  config.joints = arm.texts("joints");
  if (config.joints.empty() || config.joints.size() > static_cast<std::size_t>(kMaxJoints)) {
    throw ModelError(config.where("arm.joints") + ": " + std::to_string(config.joints.size()) + " joints; allowed: 1 to " +
                     std::to_string(kMaxJoints));
  }
  config.acceleration = arm.numbers("acceleration", true);
  check_length(config, "arm.acceleration", config.acceleration.size());
  config.home = arm.numbers("home", false);
  check_length(config, "arm.home", config.home.size());
  if (arm.has("velocity")) {
    config.velocity = arm.numbers("velocity", true);
    check_length(config, "arm.velocity", config.velocity.size());
  }
}

void read_rest(RobotConfig& config, const toml::table& root) {
  const Section hand(config, root, "hand", {"frame", "sensor_frame", "gripper_stroke"});
  config.hand_frame = hand.text("frame");
  config.sensor_frame = hand.text("sensor_frame");
  config.gripper_stroke = hand.positive("gripper_stroke");
  if (!root.contains("collision")) {
    return;
  }
  const Section collision(config, root, "collision", {"meshes", "never_checked"});
  if (collision.has("meshes")) {
    config.ignore_meshes = collision.choice("meshes", {"refuse", "ignore"}) == "ignore";
  }
  if (collision.has("never_checked")) {
    config.never_checked = collision.pairs("never_checked");
  }
}

}  // namespace

std::string RobotConfig::where(const std::string& key) const {
  std::string text = file;
  if (const auto line = lines.find(key); line != lines.end()) {
    text.append(":").append(std::to_string(line->second));
  }
  return text.append(": ").append(key);
}

RobotConfig read_robot_config(const std::filesystem::path& path) {
  const std::string text = read_text(path);
  RobotConfig config;
  config.file = path.string();
  toml::table root;
  try {
    root = toml::parse(text, path.string());
  } catch (const toml::parse_error& error) {
    throw ModelError(config.file + ":" + std::to_string(error.source().begin.line) +
                     ": not TOML: " + std::string(error.description()));
  }
  const std::vector<std::string> tables{"robot", "base", "arm", "hand", "collision"};
  for (const auto& [key, value] : root) {
    if (std::find(tables.begin(), tables.end(), std::string(key.str())) == tables.end()) {
      throw ModelError(config.file + ":" + std::to_string(value.source().begin.line) + ": " + std::string(key.str()) +
                       ": unknown key; allowed: " + join_names(tables));
    }
  }
  config.name = Section(config, root, "robot", {"name"}).text("name");
  read_base(config, root);
  read_arm(config, root);
  read_rest(config, root);
  return config;
}

std::string read_text(const std::filesystem::path& path) {
  std::error_code ignored;
  if (!std::filesystem::exists(path, ignored)) {
    throw IoError(path.string() + ": no such file");
  }
  if (std::filesystem::is_directory(path, ignored)) {
    throw IoError(path.string() + ": is a directory; allowed: a file");
  }
  std::ifstream stream(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
  if (!stream.is_open() || stream.bad()) {
    throw IoError(path.string() + ": cannot be read");
  }
  return text;
}

std::string join_names(const std::vector<std::string>& names, std::size_t most) {
  std::string all;
  for (std::size_t i = 0; i < names.size() && i <= most; ++i) {
    all.append(i == 0 ? "" : ", ").append(i == most ? "…" : names[i]);
  }
  return all;
}

}  // namespace ajar
