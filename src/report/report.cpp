#include "ajar/report/report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>

#include "ajar/core/error.hpp"
#include "page.hpp"
#include "run_series.hpp"

namespace ajar {
namespace {

using Json = nlohmann::ordered_json;

/// Content of a file, empty if there is none.
std::string read_text(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

/// A file of ours that a run which broke off may have left out or half written: then null.
Json read_json(const std::filesystem::path& file) {
  Json json = Json::parse(read_text(file), nullptr, false);
  return json.is_discarded() ? Json(nullptr) : json;
}

/// Numbers as short as a plot needs them.
std::string number_list(const std::vector<double>& values) {
  std::string text = "[";
  for (const double value : values) {
    if (text.size() > 1) text += ',';
    text += std::isfinite(value) ? fmt::format("{:.6g}", value) : "null";
  }
  return text + "]";
}

std::string dump(const Json& json) { return json.dump(-1, ' ', false, Json::error_handler_t::replace); }

/// JSON inside of an HTML script element: nothing in it may look like a tag.
std::string for_script(const std::string& json) {
  std::string out;
  out.reserve(json.size());
  for (const char c : json) {
    if (c == '<') {
      out += "\\u003c";
    } else if (c == '>') {
      out += "\\u003e";
    } else if (c == '&') {
      out += "\\u0026";
    } else {
      out += c;
    }
  }
  return out;
}

std::string escape_html(const std::string& text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '<': out += "&lt;"; break;
      case '>': out += "&gt;"; break;
      case '&': out += "&amp;"; break;
      case '"': out += "&quot;"; break;
      default: out += c;
    }
  }
  return out;
}

Json get(const Json& json, const char* outer, const char* inner) {
  if (!json.is_object() || !json.contains(outer) || !json[outer].is_object() || !json[outer].contains(inner)) return nullptr;
  return json[outer][inner];
}

Json base_limits(const Json& scene) {
  Json limits = Json::array();
  for (const char* name : {"base_forward", "base_reverse", "base_yaw_rate"}) limits.push_back(get(scene, "robot", name));
  for (const Json& limit : limits) {
    if (!limit.is_number()) return Json::array();
  }
  return limits;
}

Json array_or_empty(const Json& json) { return json.is_array() ? json : Json::array(); }

std::string data_json(const std::filesystem::path& folder, const ReportConfig& config) {
  const Json result = read_json(folder / "result.json");
  const Json scene = read_json(folder / "scene.json");
  const Json type = get(scene, "mechanism", "type");
  const bool slide = type == "slide" || (result.is_object() && result.value("mechanism_type_true", Json()) == "slide");
  const RunSeries run = read_run_series(folder / "log.csv", slide, config.points);
  std::string text = "{\"result\":" + dump(result) + ",\"scene\":" + dump(scene);
  text += ",\"scenario\":" + dump(read_text(folder / "scenario.toml"));
  text += fmt::format(",\"slide\":{},\"cut_off\":{},\"joints\":{}", slide, run.cut_off, run.joints);
  text += ",\"joint_names\":" + dump(array_or_empty(get(scene, "robot", "joint_names")));
  text += ",\"joint_limits\":" + dump(array_or_empty(get(scene, "robot", "joint_rate_limit")));
  text += ",\"base_limits\":" + dump(base_limits(scene));
  text += ",\"phase_names\":" + dump(Json(run.phase_names));
  text += ",\"phase\":" + dump(Json(run.phase)) + ",\"time\":" + number_list(run.time) + ",\"series\":{";
  bool first = true;
  for (const auto& [name, values] : run.series) {
    if (!first) text += ',';
    text += dump(name);
    text += ':';
    text += number_list(values);
    first = false;
  }
  return text + "}}";
}

}  // namespace

std::string make_report(const std::filesystem::path& run_folder, const ReportConfig& config) {
  if (config.points < 10) throw ConfigError(fmt::format("report.points = {}: allowed: at least 10", config.points));
  const std::string data = for_script(data_json(run_folder, config));
  const std::string name = escape_html(std::filesystem::absolute(run_folder).lexically_normal().filename().string());
  std::string page = "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">";
  page += "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">";
  page +=
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; style-src 'unsafe-inline'; script-src "
      "'unsafe-inline'\">";
  page += "<title>Ajar run " + name + "</title>\n<style>";
  page += page::kStyle;
  page += "</style></head>\n<body>";
  page += page::kBody;
  page += "<script type=\"application/json\" id=\"data\">" + data + "</script>\n<script>";
  page += page::kPlotScript;
  page += page::kViewScript;
  return page + "</script></body></html>\n";
}

void write_report(const std::filesystem::path& run_folder, const ReportConfig& config) {
  const std::string page = make_report(run_folder, config);
  const std::filesystem::path file = run_folder / "report.html";
  std::ofstream stream(file, std::ios::binary);
  stream << page;
  stream.close();
  if (!stream) throw IoError("cannot write '" + file.string() + "'");
}

}  // namespace ajar
