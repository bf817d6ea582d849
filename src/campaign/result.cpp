#include "ajar/campaign/result.hpp"

#include <cmath>
#include <nlohmann/json.hpp>

#include "ajar/log/csv_log.hpp"
#include "ajar/log/csv_table.hpp"

namespace ajar {
namespace {

using Json = nlohmann::ordered_json;
using Fields = std::vector<ResultField>;

void add(Fields& fields, const char* name, const std::optional<double>& value) {
  if (value && std::isfinite(*value)) {
    fields.push_back({name, *value});
  } else {
    fields.push_back({name, std::monostate{}});
  }
}
void add(Fields& fields, const char* name, std::int64_t value) { fields.push_back({name, value}); }
void add(Fields& fields, const char* name, const std::string& value) {
  if (value.empty()) {
    fields.push_back({name, std::monostate{}});
  } else {
    fields.push_back({name, value});
  }
}

void add_forces(Fields& fields, const RunResult& r) {
  add(fields, "peak_normal_force_N", r.peak_normal_force);
  add(fields, "peak_normal_force_free_N", r.peak_normal_force_free);
  add(fields, "mean_normal_force_N", r.mean_normal_force);
  add(fields, "late_normal_force_N", r.late_normal_force);
  add(fields, "late_normal_force_peak_N", r.late_normal_force_peak);
  add(fields, "peak_pull_force_N", r.peak_pull_force);
  add(fields, "stop_force_N", r.stop_force);
  add(fields, "peak_torque_Nm", r.peak_torque);
  add(fields, "peak_probe_force_N", r.peak_probe_force);
  add(fields, "probe_force_over_need_N", r.probe_force_over_need);
  add(fields, "unwanted_contact_count", static_cast<std::int64_t>(r.unwanted_contacts.size()));
}

void add_motion(Fields& fields, const RunResult& r) {
  add(fields, "min_clearance_m", r.min_clearance);
  add(fields, "path_error_max_m", r.path_error_max);
  add(fields, "distance_min_m", r.distance_min);
  add(fields, "distance_max_m", r.distance_max);
  add(fields, "heading_error_rms_rad", r.heading_error_rms);
  add(fields, "heading_error_max_rad", r.heading_error_max);
  add(fields, "min_singular_value", r.min_singular_value);
}

void add_estimate(Fields& fields, const RunResult& r) {
  add(fields, "probe_direction_error_rad", r.probe_direction_error);
  add(fields, "direction_error_start_rad", r.direction_error_start);
  add(fields, "direction_error_10cm_rad", r.direction_error_10cm);
  add(fields, "direction_error_20cm_rad", r.direction_error_20cm);
  add(fields, "direction_error_final_rad", r.direction_error_final);
  add(fields, "direction_sigma_final_rad", r.direction_sigma_final);
  add(fields, "curvature_error_20cm_per_m", r.curvature_error_20cm);
  add(fields, "curvature_error_40cm_per_m", r.curvature_error_40cm);
  add(fields, "curvature_error_final_per_m", r.curvature_error_final);
  add(fields, "curvature_sigma_final_per_m", r.curvature_sigma_final);
  add(fields, "angle_error_final_rad", r.angle_error_final);
  add(fields, "odometry_error_final_m", r.odometry_error_final);
  add(fields, "odometry_yaw_error_final_rad", r.odometry_yaw_error_final);
}

Json json_of(const ResultField& field) {
  if (const auto* number = std::get_if<double>(&field.value)) return std::isfinite(*number) ? Json(*number) : Json(nullptr);
  if (const auto* integer = std::get_if<std::int64_t>(&field.value)) return *integer;
  if (const auto* text = std::get_if<std::string>(&field.value)) return *text;
  return nullptr;
}

}  // namespace

std::vector<ResultField> result_fields(const RunResult& r) {
  Fields fields;
  add(fields, "outcome", r.outcome);
  add(fields, "phase", r.phase);
  add(fields, "reason", r.reason);
  add(fields, "explanation", r.explanation);
  add(fields, "mechanism_type_true", r.mechanism_type_true);
  add(fields, "mechanism_type_estimated", r.mechanism_type_estimated);
  add(fields, "opening", r.opening);
  add(fields, "opening_fraction", r.opening_fraction);
  add(fields, "duration_s", std::optional<double>(r.duration));
  add(fields, "open_duration_s", r.open_duration);
  add(fields, "probe_duration_s", r.probe_duration);
  add(fields, "handle_travel_m", r.handle_travel);
  add_forces(fields, r);
  add_motion(fields, r);
  add_estimate(fields, r);
  add(fields, "limit_violations", r.limit_violations);
  add(fields, "limit_violation_first", r.limit_violation_first);
  add(fields, "nonfinite_commands", r.nonfinite_commands);
  add(fields, "seed", static_cast<std::int64_t>(r.seed));
  add(fields, "version", r.version);
  add(fields, "missed_ticks", r.missed_ticks);
  add(fields, "tick_us_p50", std::optional<double>(r.tick_us.p50));
  add(fields, "tick_us_p99", std::optional<double>(r.tick_us.p99));
  add(fields, "tick_us_p999", std::optional<double>(r.tick_us.p999));
  add(fields, "tick_us_max", std::optional<double>(r.tick_us.max));
  add(fields, "real_time_factor", r.real_time_factor);
  return fields;
}

std::string csv_cell(const ResultField& field) {
  if (const auto* number = std::get_if<double>(&field.value)) return format_number(*number);
  if (const auto* integer = std::get_if<std::int64_t>(&field.value)) return std::to_string(*integer);
  if (const auto* text = std::get_if<std::string>(&field.value)) return csv_cell(std::string_view(*text));
  return "";
}

std::string to_json(const RunResult& result) {
  Json json;
  for (const ResultField& field : result_fields(result)) {
    if (field.name == "unwanted_contact_count") {
      json[field.name] = json_of(field);
      Json contacts = Json::array();
      for (const Contact& contact : result.unwanted_contacts) {
        contacts.push_back({{"time", contact.time}, {"bodies", contact.bodies}, {"force_N", contact.force}});
      }
      json["unwanted_contacts"] = contacts;
    } else if (field.name == "tick_us_p50") {
      const TickTimes& t = result.tick_us;
      json["tick_us"] = {{"p50", t.p50}, {"p99", t.p99}, {"p999", t.p999}, {"max", t.max}};
    } else if (field.name.rfind("tick_us_", 0) != 0) {
      json[field.name] = json_of(field);
    }
    if (field.name == "version") json["notes"] = result.notes;
  }
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace ajar
