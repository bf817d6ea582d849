#include "ajar/report/report.hpp"

#include <fmt/format.h>

#include <fstream>
#include <set>

#include "ajar/core/error.hpp"
#include "pack.hpp"
#include "page.hpp"
#include "run_files.hpp"
#include "run_series.hpp"

namespace ajar {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// Member of a member, null where there is none.
Json get(const Json& json, const char* outer, const char* inner) {
  if (!json.is_object() || !json.contains(outer) || !json[outer].is_object() || !json[outer].contains(inner)) return nullptr;
  return json[outer][inner];
}

Json run_json(const fs::path& folder, const std::string& name, const ReportConfig& config) {
  const Json result = page::read_json(folder / "result.json");
  const Json scene = page::read_json(folder / "scene.json");
  const bool slide = get(scene, "mechanism", "type") == "slide" ||
                     (result.is_object() && result.value("mechanism_type_true", Json()) == "slide");
  const RunSeries run = read_run_series(folder, slide, config.period);
  Json json = {{"name", name},         {"result", result},
               {"scene", scene},       {"scenario", page::read_text(folder / "scenario.toml")},
               {"slide", slide},       {"cut_off", run.cut_off},
               {"joints", run.joints}, {"rows", run.time.size()},
               {"log_rows", run.rows}, {"phase_names", run.phase_names}};
  std::vector<const std::vector<double>*> columns{&run.time};
  Json names = Json::array({"time"});
  for (const auto& [column, values] : run.series) {
    names.push_back(column);
    columns.push_back(&values);
  }
  json["columns"] = names;
  json["data"] = pack_columns(columns);
  return json;
}

/// The last part of each path, or as much of the path as tells them apart.
std::vector<std::string> short_names(const std::vector<fs::path>& folders) {
  std::vector<std::string> names;
  std::set<std::string> different;
  for (const fs::path& folder : folders) {
    names.push_back(folder_name(folder));
    different.insert(names.back());
  }
  if (different.size() == names.size()) return names;
  names.clear();
  for (const fs::path& folder : folders) names.push_back(folder.string());
  return names;
}

}  // namespace

std::string folder_name(const fs::path& folder) {
  const fs::path path = fs::absolute(folder).lexically_normal();
  return (path.has_filename() ? path : path.parent_path()).filename().string();
}

std::string make_report(const std::vector<fs::path>& run_folders, const ReportConfig& config) {
  if (!(config.period > 0.0)) throw ConfigError(fmt::format("report.period = {}: allowed: above 0", config.period));
  const std::vector<std::string> names = short_names(run_folders);
  Json runs = Json::array();
  for (std::size_t i = 0; i < run_folders.size(); ++i) runs.push_back(run_json(run_folders[i], names[i], config));
  return page::fill(fmt::format("{}", fmt::join(names, ", ")), page::dump({{"kind", "runs"}, {"runs", runs}}));
}

void write_page(const fs::path& file, const std::string& page) {
  std::ofstream stream(file, std::ios::binary);
  stream << page;
  stream.close();
  if (!stream) throw IoError("cannot write '" + file.string() + "'");
}

void write_report(const fs::path& run_folder) { write_page(run_folder / "report.html", make_report({run_folder})); }

}  // namespace ajar
