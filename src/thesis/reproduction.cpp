#include "ajar/thesis/reproduction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <system_error>

#include "ajar/core/error.hpp"
#include "run_set.hpp"

namespace ajar {
namespace {

using thesis::RunSet;

/// Figures that share their runs.
struct Chapter {
  const char* title;
  std::vector<std::string> figures;
  std::vector<ExperimentPlan> (*plans)();
  void (*add)(const RunSet&, Reproduction&);
};

const std::vector<Chapter>& chapters() {
  static const std::vector<Chapter> all{
      {"navigation", {"6.2", "6.3", "6.4"}, thesis::navigation_plans, thesis::add_navigation},
      {"hinges", {"6.6", "6.7", "6.8", "6.9", "6.10"}, thesis::hinge_plans, thesis::add_hinges},
      {"slides", {"6.11", "6.12", "6.13"}, thesis::line_plans, thesis::add_lines},
      {"physics", {"6.14", "6.15", "6.16"}, thesis::physics_plans, thesis::add_physics},
      {"estimator", {"6.17"}, thesis::estimator_plans, thesis::add_estimator}};
  return all;
}

bool contains(const std::vector<std::string>& list, const std::string& name) {
  return std::find(list.begin(), list.end(), name) != list.end();
}

bool wanted(const Chapter& chapter, const std::vector<std::string>& figures) {
  return figures.empty() ||
         std::any_of(figures.begin(), figures.end(), [&](const std::string& f) { return contains(chapter.figures, f); });
}

/// "figure_6_6" of "6.6".
std::string stem_of(std::string figure) {
  std::replace(figure.begin(), figure.end(), '.', '_');
  return fmt::format("figure_{}", figure);
}

void write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream stream(file, std::ios::binary);
  stream << text;
  stream.close();
  if (!stream) throw IoError(fmt::format("cannot write '{}'", file.string()));
}

void check_names(const std::vector<std::string>& figures) {
  for (const std::string& figure : figures) {
    if (contains(thesis_figures(), figure)) continue;
    throw ConfigError(fmt::format("figure '{}': allowed: {}", figure, fmt::join(thesis_figures(), ", ")));
  }
}

/// Makes the folder and proves that it takes files, before anything is computed.
void prepare(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder / "figures", error);
  if (!error) std::filesystem::create_directories(folder / "runs", error);
  const std::filesystem::path probe = folder / "figures" / ".probe";
  std::ofstream stream(probe);
  stream << "probe";
  stream.close();
  if (error || !stream) throw IoError(fmt::format("cannot write into the folder '{}'", folder.string()));
  std::filesystem::remove(probe, error);
}

/// A number with four digits: what differs beyond that differs between compilers.
nlohmann::ordered_json number(const std::optional<double>& value) {
  if (!value || !std::isfinite(*value)) return nullptr;
  return std::stod(fmt::format("{:.4g}", *value));
}

}  // namespace

const std::vector<std::string>& thesis_figures() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> out;
    for (const Chapter& chapter : chapters()) out.insert(out.end(), chapter.figures.begin(), chapter.figures.end());
    return out;
  }();
  return names;
}

std::string to_json(const std::vector<ThesisStatement>& statements) {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  for (const ThesisStatement& s : statements) {
    list.push_back({{"figure", s.figure},
                    {"statement", s.statement},
                    {"thesis", number(s.thesis)},
                    {"corrected", number(s.corrected)},
                    {"ours", number(s.ours)},
                    {"unit", s.unit},
                    {"holds", s.holds},
                    {"reason", s.reason}});
  }
  return list.dump(1, ' ') + "\n";
}

Reproduction reproduce_thesis(const PlantFactory& factory, const std::filesystem::path& folder,
                              const ReproduceOptions& options) {
  check_names(options.figures);
  prepare(folder);
  Reproduction out;
  for (const Chapter& chapter : chapters()) {
    if (!wanted(chapter, options.figures)) continue;
    if (options.progress) options.progress(chapter.title);
    const RunSet runs(run_experiments(chapter.plans(), factory, folder / "runs", options.threads));
    chapter.add(runs, out);
  }
  if (!options.figures.empty()) {
    const auto unwanted = [&](const std::string& name) {
      return std::none_of(options.figures.begin(), options.figures.end(),
                          [&](const std::string& f) { return stem_of(f) == name; });
    };
    std::erase_if(out.figures, [&](const Figure& f) { return unwanted(f.name); });
    std::erase_if(out.statements, [&](const ThesisStatement& s) { return unwanted(stem_of(s.figure)); });
  }
  for (const Figure& figure : out.figures)
    write_text(folder / "figures" / fmt::format("{}.svg", figure.name), to_svg(figure));
  write_text(folder / "thesis.json", to_json(out.statements));
  write_text(folder / "thesis.html", to_html(out));
  return out;
}

}  // namespace ajar
