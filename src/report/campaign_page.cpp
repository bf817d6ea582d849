#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>

#include "ajar/core/error.hpp"
#include "ajar/log/csv_table.hpp"
#include "ajar/report/report.hpp"
#include "pack.hpp"
#include "page.hpp"
#include "run_files.hpp"

namespace ajar {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();

/// Numbers of a column; empty if some cell is neither empty nor a number that a 32-bit float shows faithfully.
std::vector<double> numbers_of(const std::vector<std::string>& cells) {
  std::vector<double> values;
  values.reserve(cells.size());
  bool any = false;
  for (const std::string& cell : cells) {
    double value = kNothing;
    const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
    const bool number = error == std::errc() && end == cell.data() + cell.size();
    // Seeds have more digits than a float holds: they stay text.
    if (!cell.empty() && (!number || std::abs(value) > 1e9)) return {};
    any = any || number;
    values.push_back(number ? value : kNothing);
  }
  return any ? values : std::vector<double>{};
}

/// Every different text once, and which of them each row has.
Json dictionary_of(const std::vector<std::string>& cells) {
  std::unordered_map<std::string, std::size_t> numbers;
  Json values = Json::array(), index = Json::array();
  for (const std::string& cell : cells) {
    const auto [found, fresh] = numbers.emplace(cell, numbers.size());
    if (fresh) values.push_back(cell);
    index.push_back(found->second);
  }
  return {{"values", values}, {"index", index}};
}

/// What was drawn stands between exit code and outcome.
Json parameters_of(const std::vector<std::string>& names) {
  Json parameters = Json::array();
  const auto begin = std::find(names.begin(), names.end(), "exit_code");
  const auto end = std::find(names.begin(), names.end(), "outcome");
  if (begin == names.end() || end == names.end() || end < begin) return parameters;
  for (auto name = begin + 1; name != end; ++name) parameters.push_back(*name);
  return parameters;
}

Json stored_runs(const fs::path& folder) {
  Json runs = Json::array();
  std::error_code missing;
  for (const auto& entry : fs::directory_iterator(folder / "runs", missing)) {
    const std::string name = entry.path().filename().string();
    int number = 0;
    const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
    if (error != std::errc() || end != name.data() + name.size()) continue;
    if (fs::exists(entry.path() / "report.html", missing)) runs.push_back(number);
  }
  return runs;
}

}  // namespace

CampaignOrigin read_campaign_origin(const fs::path& folder) {
  const Json json = page::read_json(folder / "origin.json");
  if (!json.is_object() || !json.value("campaign", Json()).is_string() || !json.value("seed", Json()).is_number_unsigned()) {
    throw IoError((folder / "origin.json").string() + ": missing or not written by ajar campaign");
  }
  return {json["campaign"].get<std::string>(), json["seed"].get<std::uint64_t>()};
}

void write_campaign_origin(const fs::path& folder, const CampaignOrigin& origin) {
  const Json json = {{"campaign", fs::absolute(origin.file).lexically_normal().string()}, {"seed", origin.seed}};
  write_page(folder / "origin.json", page::dump(json) + "\n");
}

std::string make_campaign_page(const fs::path& folder) {
  const fs::path file = folder / "runs.csv";
  CsvColumns wanted;
  wanted.texts = read_csv(file, {}).names;
  const CsvTable table = read_csv(file, wanted);
  if (table.texts.count("run") == 0 || table.texts.count("outcome") == 0) {
    throw IoError(file.string() + ":1: not the rows of a campaign: columns run and outcome are needed");
  }
  const CampaignOrigin origin = read_campaign_origin(folder);
  Json numbers = Json::array(), texts = Json::object();
  std::vector<std::vector<double>> columns;
  for (const std::string& name : table.names) {
    std::vector<double> values = numbers_of(table.texts.at(name));
    if (values.empty()) {
      texts[name] = dictionary_of(table.texts.at(name));
    } else {
      numbers.push_back(name);
      columns.push_back(std::move(values));
    }
  }
  std::vector<const std::vector<double>*> packed;
  packed.reserve(columns.size());
  for (const auto& column : columns) packed.push_back(&column);
  const std::string name = folder_name(folder);
  const Json campaign = {{"name", name},
                         {"folder", folder.string()},
                         {"origin", origin.file.string()},
                         {"seed", std::to_string(origin.seed)},
                         {"rows", table.rows},
                         {"numbers", numbers},
                         {"data", pack_columns(packed)},
                         {"texts", texts},
                         {"parameters", parameters_of(table.names)},
                         {"stored", stored_runs(folder)}};
  return page::fill("Campaign " + name, page::dump({{"kind", "campaign"}, {"campaign", campaign}}));
}

}  // namespace ajar
