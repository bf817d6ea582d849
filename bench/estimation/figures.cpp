#include "figures.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <map>

#include "ajar/core/error.hpp"

namespace ajar::bench {
namespace {

constexpr double kWidth = 430.0;  // of one diagram [px]
constexpr double kHeight = 330.0;
constexpr double kMargin = 48.0;
constexpr double kKey = 190.0;  // width of the names beside the diagrams

// One diagram on doubly logarithmic axes: path length in cm against an error.
struct Diagram {
  std::string title;
  double low, high;  // of the error
  [[nodiscard]] double x(double cm) const {
    return kMargin + (kWidth - 2.0 * kMargin) * std::log(cm / 5.0) / std::log(80.0 / 5.0);
  }
  [[nodiscard]] double y(double value) const {
    const double share = std::log(std::clamp(value, low, high) / low) / std::log(high / low);
    return kHeight - kMargin - (kHeight - 2.0 * kMargin) * share;
  }
};

using Lines = std::map<std::string, std::map<double, double>>;  // contestant, path length [cm], error

Lines lines_of(const Table& table, const std::string& start, const std::string& figure) {
  Lines lines;
  for (const Row& row : table) {
    if (row.problem.rfind(start + ", ", 0) != 0 || row.problem.find(figure) == std::string::npos) continue;
    lines[row.contestant][std::stod(row.problem.substr(start.size() + 2))] = row.value;
  }
  return lines;
}

std::string style_of(std::size_t index, const std::string& name) {
  static const std::array colours{"#7a9a3a", "#2f9e9e", "#d9822b", "#c0392b", "#000000",
                                  "#000000", "#8e6bbf", "#1f6fb4", "#a0a0a0"};
  if (name == "bound") return "stroke='#1b2a38' stroke-dasharray='6 3' stroke-width='1.4'";
  if (name == "bound, positions") return "stroke='#8794a0' stroke-dasharray='6 3' stroke-width='1.4'";
  return fmt::format("stroke='{}' stroke-width='{}'", colours[index % colours.size()],
                     name.rfind("ajar", 0) == 0 ? 2.6 : 1.5);
}

std::string draw(const Diagram& diagram, const Lines& lines, double shift) {
  std::string svg =
      fmt::format("<g transform='translate({:.0f},0)'><text x='{}' y='26' font-size='13' fill='#1b2a38'>{}</text>", shift,
                  kMargin, diagram.title);
  for (const double cm : {5.0, 10.0, 20.0, 40.0, 80.0}) {
    svg += fmt::format(
        "<line x1='{0:.1f}' x2='{0:.1f}' y1='{1}' y2='{2}' stroke='#e4e9ee'/><text x='{0:.1f}' y='{3}' "
        "text-anchor='middle'>{4:.0f}</text>",
        diagram.x(cm), kMargin, kHeight - kMargin, kHeight - kMargin + 15.0, cm);
  }
  for (double value = diagram.low; value <= diagram.high * 1.001; value *= 10.0) {
    svg += fmt::format(
        "<line x1='{0}' x2='{1}' y1='{2:.1f}' y2='{2:.1f}' stroke='#e4e9ee'/><text x='{3}' y='{4:.1f}' "
        "text-anchor='end'>{5:g}</text>",
        kMargin, kWidth - kMargin, diagram.y(value), kMargin - 6.0, diagram.y(value) + 4.0, value);
  }
  svg += fmt::format("<text x='{}' y='{}' text-anchor='middle'>path travelled [cm]</text>", 0.5 * kWidth, kHeight - 14.0);
  std::size_t index = 0;
  for (const auto& [name, points] : lines) {
    svg += fmt::format("<polyline fill='none' {} points='", style_of(index++, name));
    for (const auto& [cm, value] : points) svg += fmt::format("{:.1f},{:.1f} ", diagram.x(cm), diagram.y(value));
    svg += "'/>";
  }
  return svg + "</g>";
}

}  // namespace

void write_figures(const std::string& folder, const Table& table) {
  for (const char* const start : {"r 0.8 m", "slide"}) {
    const Lines direction = lines_of(table, start, "direction");
    const Lines curvature = lines_of(table, start, "curvature");
    std::string key;
    std::size_t index = 0;
    for (const auto& [name, points] : direction) {
      const double y = kMargin + 22.0 * static_cast<double>(index) + 8.0;
      key += fmt::format("<line x1='{0}' x2='{1}' y1='{2}' y2='{2}' {3}/><text x='{4}' y='{5}'>{6}</text>", 2.0 * kWidth,
                         2.0 * kWidth + 26.0, y, style_of(index, name), 2.0 * kWidth + 34.0, y + 4.0, name);
      ++index;
    }
    const bool hinge = std::string(start) != "slide";
    const std::string file = folder + (hinge ? "/estimation_hinge.svg" : "/estimation_slide.svg");
    std::ofstream out(file);
    out << fmt::format(
               "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0:.0f} {1:.0f}' width='{0:.0f}' height='{1:.0f}' "
               "font-family='system-ui,sans-serif' font-size='11' fill='#5c6b78'><rect width='100%' height='100%' "
               "fill='#fff'/>",
               2.0 * kWidth + kKey, kHeight)
        << draw({fmt::format("{}: direction, RMS error [deg]", hinge ? "hinge of 0.8 m" : "slide"), 0.1, 100.0}, direction,
                0.0)
        << draw({"curvature, RMS error [1/m]", 0.001, 100.0}, curvature, kWidth) << key << "</svg>\n";
    if (!out.flush()) throw IoError(file + ": cannot be written");
  }
}

}  // namespace ajar::bench
