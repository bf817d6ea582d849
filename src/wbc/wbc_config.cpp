#include <cmath>

#include "ajar/core/config_range.hpp"
#include "ajar/core/error.hpp"
#include "ajar/wbc/base_law.hpp"
#include "ajar/wbc/thesis_controller.hpp"
#include "ajar/wbc/whole_body_controller.hpp"

namespace ajar {
namespace {

// Smallest positive value where zero would divide or make the QP singular.
constexpr double kTiny = 1e-6;
constexpr double kHuge = 1e12;

}  // namespace

void WbcConfig::validate() const {
  check_ranges("wbc", {{"hand_weight", hand_weight, kTiny, kHuge},
                       {"speed_weight", speed_weight, kTiny, kHuge},
                       {"base_speed_weight", base_speed_weight, kTiny, kHuge},
                       {"base_turn_weight", base_turn_weight, kTiny, kHuge},
                       {"rate_weight", rate_weight, kTiny, kHuge},
                       {"slack_weight", slack_weight, kTiny, kHuge},
                       {"length", length, 0.01, 10.0},
                       {"singular_onset", singular_onset, kTiny, 10.0},
                       {"singular_damping", singular_damping, 0.0, kHuge},
                       {"free_axis_weight", free_axis_weight, 0.0, kHuge},
                       {"rate_scale", rate_scale, kTiny, 1.0},
                       {"joint_acceleration", joint_acceleration, kTiny, 1e3},
                       {"base_forward", base_forward, 0.0, 10.0},
                       {"base_reverse", base_reverse, 0.0, 10.0},
                       {"base_yaw_rate", base_yaw_rate, 0.0, 10.0},
                       {"base_acceleration", base_acceleration, kTiny, 100.0},
                       {"base_yaw_acceleration", base_yaw_acceleration, kTiny, 100.0},
                       {"base_braking", base_braking, 1.0, 100.0},
                       {"position_margin", position_margin, 0.0, 1.0}});
}

void ThesisConfig::validate() const {
  check_ranges("thesis", {{"w_base", w_base, kTiny, kHuge},
                          {"lambda_max", lambda_max, 0.0, 10.0},
                          {"epsilon", epsilon, kTiny, 10.0},
                          {"alpha1", alpha1, 0.0, 1e3},
                          {"alpha2", alpha2, 0.0, 1e3},
                          {"alpha3", alpha3, 0.0, 1e3},
                          {"distance", distance, 0.1, 5.0},
                          {"integral_max", integral_max, 0.0, 100.0},
                          {"constant_damping", constant_damping, 0.0, 10.0}});
  if (heading != "signed" && heading != "folded") {
    throw ConfigError("thesis.heading = \"" + heading + "\": must be signed or folded");
  }
  if (limits != "common" && limits != "each") {
    throw ConfigError("thesis.limits = \"" + limits + "\": must be common or each");
  }
}

void BaseLawConfig::validate() const {
  if (kind != "corotating" && kind != "distance" && kind != "line") {
    throw ConfigError("base_law.kind = \"" + kind + "\": must be corotating, distance or line");
  }
  check_ranges("base_law", {{"gain_along", gain_along, 0.0, 20.0},
                            {"gain_across", gain_across, 0.0, 200.0},
                            {"gain_heading", gain_heading, 0.0, 20.0},
                            {"full_curvature", full_curvature, kTiny, 100.0},
                            {"least_share", least_share, 0.0, 1.0},
                            {"distance", distance, 0.1, 5.0},
                            {"gain_distance", gain_distance, 0.0, 20.0},
                            {"gain_heading_distance", gain_heading_distance, 0.0, 20.0}});
}

}  // namespace ajar
