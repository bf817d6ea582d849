#include "ajar/thesis/figure.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "ajar/core/markup.hpp"

namespace ajar {
namespace {

// Sizes in pixels of the drawing.
constexpr double kWidth = 420.0;
constexpr double kHeight = 280.0;
constexpr double kTallHeight = 340.0;  // of panels whose axes have one scale
constexpr double kLeft = 58.0;
constexpr double kRight = 14.0;
constexpr double kTop = 30.0;
constexpr double kBottom = 44.0;
constexpr double kTitle = 30.0;
constexpr double kLegendRow = 20.0;
constexpr std::size_t kMostPoints = 500;

struct Style {
  const char* colour;
  const char* dashes;
};
// Okabe and Ito's palette, in pairs that also differ in brightness or dashes.
constexpr std::array<Style, 8> kStyles{{{"#d55e00", ""},
                                        {"#0072b2", "7 3"},
                                        {"#009e73", ""},
                                        {"#cc79a7", "2 3"},
                                        {"#000000", "1 4"},
                                        {"#e69f00", "9 3 2 3"},
                                        {"#56b4e9", "5 2"},
                                        {"#777777", ""}}};

const Style& style_of(int index) { return kStyles[static_cast<std::size_t>(index) % kStyles.size()]; }

std::string dash_of(int index) {
  const Style& style = style_of(index);
  return *style.dashes == '\0' ? std::string() : fmt::format(" stroke-dasharray=\"{}\"", style.dashes);
}

bool drawable(const FigurePoint& p, bool log_y) { return std::isfinite(p.x) && std::isfinite(p.y) && (!log_y || p.y > 0.0); }

struct Range {
  double lower = std::numeric_limits<double>::infinity();
  double upper = -std::numeric_limits<double>::infinity();
  void add(double value) {
    lower = std::min(lower, value);
    upper = std::max(upper, value);
  }
  [[nodiscard]] double size() const { return upper - lower; }
  void widen(double share) {
    if (!(upper >= lower)) *this = {0.0, 1.0};
    const double pad = std::max(share * size(), 1e-9 + 1e-3 * std::max(std::abs(lower), std::abs(upper)));
    lower -= pad;
    upper += pad;
  }
};

/// A step of 1, 2 or 5 times a power of ten that makes about `count` ticks.
double tick_step(double size, int count) {
  const double raw = size / count;
  const double power = std::pow(10.0, std::floor(std::log10(raw)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (raw <= factor * power) return factor * power;
  }
  return 10.0 * power;
}

std::string tick_text(double value, double step) {
  const int digits = std::max(0, static_cast<int>(std::ceil(-std::log10(step) - 1e-9)));
  const std::string text = fmt::format("{:.{}f}", value, digits);
  return text.front() == '-' && text.find_first_not_of("-0.") == std::string::npos ? text.substr(1) : text;
}

/// One pair of axes on the page.
class Axes {
 public:
  Axes(const FigurePanel& panel, double left, double top, double height) : panel_(panel), left_(left), top_(top) {
    width_ = kWidth - kLeft - kRight;
    height_ = height - kTop - kBottom;
    for (const FigureCurve& curve : panel.curves) {
      for (const FigurePoint& p : curve.points) include(p);
    }
    for (const FigureStroke& stroke : panel.strokes) {
      include(stroke.from);
      include(stroke.to);
    }
    for (const FigureMark& mark : panel.marks) include(mark.at);
    for (const FigurePoint& p : panel.extent) include(p);
    for (const double level : panel.levels) y_.add(scaled(level));
    x_.widen(panel.equal ? 0.05 : 0.0);
    y_.widen(0.06);
    if (panel.y_range) y_ = {scaled(panel.y_range->first), scaled(panel.y_range->second)};
    if (panel.equal) equalise();
  }

  [[nodiscard]] double x(double value) const { return left_ + kLeft + width_ * (value - x_.lower) / x_.size(); }
  [[nodiscard]] double y(double value) const { return top_ + kTop + height_ * (y_.upper - scaled(value)) / y_.size(); }
  [[nodiscard]] std::string frame(const std::string& id) const;
  [[nodiscard]] std::string curve(const FigureCurve& curve) const;

 private:
  [[nodiscard]] double scaled(double y) const { return panel_.log_y ? std::log10(y) : y; }
  void include(const FigurePoint& p) {
    if (!drawable(p, panel_.log_y)) return;
    x_.add(p.x);
    y_.add(scaled(p.y));
  }
  void equalise() {
    const double unit = std::max(x_.size() / width_, y_.size() / height_);
    const double x_pad = 0.5 * (unit * width_ - x_.size());
    const double y_pad = 0.5 * (unit * height_ - y_.size());
    x_ = {x_.lower - x_pad, x_.upper + x_pad};
    y_ = {y_.lower - y_pad, y_.upper + y_pad};
  }
  [[nodiscard]] std::string ticks_x() const;
  [[nodiscard]] std::string ticks_y() const;

  const FigurePanel& panel_;
  double left_, top_, width_, height_;
  Range x_, y_;
};

std::string Axes::ticks_x() const {
  std::string out;
  const double step = tick_step(x_.size(), 6);
  for (double value = std::ceil(x_.lower / step - 1e-9) * step; value <= x_.upper + 1e-9 * step; value += step) {
    out +=
        fmt::format("<path class=\"g\" d=\"M{:.1f} {:.1f}v{:.1f}\"/><text x=\"{:.1f}\" y=\"{:.1f}\" class=\"m\">{}</text>\n",
                    x(value), top_ + kTop, height_, x(value), top_ + kTop + height_ + 15.0, tick_text(value, step));
  }
  return out;
}

std::string Axes::ticks_y() const {
  std::string out;
  const double step = panel_.log_y ? 1.0 : tick_step(y_.size(), 5);
  for (double value = std::ceil(y_.lower / step - 1e-9) * step; value <= y_.upper + 1e-9 * step; value += step) {
    const double at = top_ + kTop + height_ * (y_.upper - value) / y_.size();
    const std::string text = panel_.log_y ? fmt::format("{:g}", std::pow(10.0, value)) : tick_text(value, step);
    out +=
        fmt::format("<path class=\"g\" d=\"M{:.1f} {:.1f}h{:.1f}\"/><text x=\"{:.1f}\" y=\"{:.1f}\" class=\"e\">{}</text>\n",
                    left_ + kLeft, at, width_, left_ + kLeft - 6.0, at + 4.0, text);
  }
  return out;
}

std::string Axes::frame(const std::string& id) const {
  const double x0 = left_ + kLeft;
  const double y0 = top_ + kTop;
  std::string out =
      fmt::format("<clipPath id=\"{}\"><rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/></clipPath>\n",
                  id, x0, y0, width_, height_);
  out += ticks_x() + ticks_y();
  out += fmt::format("<rect class=\"f\" x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\"/>\n", x0, y0, width_,
                     height_);
  out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"t\">{}</text>\n", x0, y0 - 9.0, escape_markup(panel_.title));
  out += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" class=\"m\">{}</text>\n", x0 + 0.5 * width_, y0 + height_ + 34.0,
                     escape_markup(panel_.x_label));
  const double label_x = left_ + 13.0;
  const double label_y = y0 + 0.5 * height_;
  out += fmt::format("<text x=\"{0:.1f}\" y=\"{1:.1f}\" class=\"m\" transform=\"rotate(-90 {0:.1f} {1:.1f})\">{2}</text>\n",
                     label_x, label_y, escape_markup(panel_.y_label));
  return out;
}

std::string Axes::curve(const FigureCurve& curve) const {
  const Style& style = style_of(curve.style);
  const std::size_t stride = std::max<std::size_t>(1, (curve.points.size() + kMostPoints - 1) / kMostPoints);
  std::string path;
  std::string dots;
  bool pen = false;
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const FigurePoint& p = curve.points[i];
    const bool broken = !drawable(p, panel_.log_y);
    if (!broken && i % stride != 0 && i + 1 != curve.points.size()) continue;
    if (broken) {
      pen = false;
      continue;
    }
    path += fmt::format("{}{:.1f} {:.1f}", pen ? "L" : "M", x(p.x), y(p.y));
    if (curve.markers)
      dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>", x(p.x), y(p.y), style.colour);
    pen = true;
  }
  return fmt::format("<path class=\"l\" stroke=\"{}\"{} d=\"{}\"/>{}\n", style.colour, dash_of(curve.style), path, dots);
}

std::string draw_panel(const FigurePanel& panel, double left, double top, double height, const std::string& id) {
  const Axes axes(panel, left, top, height);
  std::string out = axes.frame(id) + fmt::format("<g clip-path=\"url(#{})\">\n", id);
  for (const double level : panel.levels) {
    out += fmt::format("<path class=\"r\" d=\"M{:.1f} {:.1f}h{:.1f}\"/>\n", left + kLeft, axes.y(level),
                       kWidth - kLeft - kRight);
  }
  for (const FigureStroke& s : panel.strokes) {
    out += fmt::format("<path class=\"s\" stroke=\"{}\" d=\"M{:.1f} {:.1f}L{:.1f} {:.1f}\"/>\n", style_of(s.style).colour,
                       axes.x(s.from.x), axes.y(s.from.y), axes.x(s.to.x), axes.y(s.to.y));
  }
  for (const FigureCurve& curve : panel.curves) out += axes.curve(curve);
  for (const FigureMark& mark : panel.marks) {
    out += fmt::format(
        "<circle cx=\"{0:.1f}\" cy=\"{1:.1f}\" r=\"4\" fill=\"{2}\" stroke=\"#fff\"/><text x=\"{3:.1f}\" y=\"{4:.1f}\" "
        "class=\"k\">{5}</text>\n",
        axes.x(mark.at.x), axes.y(mark.at.y), style_of(mark.style).colour, axes.x(mark.at.x) + 6.0, axes.y(mark.at.y) - 6.0,
        escape_markup(mark.text));
  }
  return out + "</g>\n";
}

/// Labels of all panels, each once, in the order in which they come.
std::vector<std::pair<std::string, int>> legend_of(const Figure& figure) {
  std::vector<std::pair<std::string, int>> out;
  for (const FigurePanel& panel : figure.panels) {
    for (const FigureCurve& curve : panel.curves) {
      const std::pair<std::string, int> entry{curve.label, curve.style};
      if (!curve.label.empty() && std::find(out.begin(), out.end(), entry) == out.end()) out.push_back(entry);
    }
  }
  return out;
}

constexpr const char* kCss =
    "text{font:12px 'DejaVu Sans','Helvetica Neue',Arial,sans-serif;fill:#222}.h{font-weight:600;font-size:15px}"
    ".t{font-weight:600}.m{text-anchor:middle}.e{text-anchor:end}.k{font-size:11px}"
    ".f{fill:none;stroke:#555}.g{stroke:#e3e3e3;fill:none}.l{fill:none;stroke-width:1.8;stroke-linejoin:round}"
    ".r{fill:none;stroke:#888;stroke-dasharray:3 3}.s{fill:none;stroke-width:1;opacity:.45}";

}  // namespace

std::string to_svg(const Figure& figure) {
  const int columns = std::max(1, std::min(figure.columns, static_cast<int>(figure.panels.size())));
  const int rows = (static_cast<int>(figure.panels.size()) + columns - 1) / columns;
  const bool tall = std::any_of(figure.panels.begin(), figure.panels.end(), [](const FigurePanel& p) { return p.equal; });
  const double row_height = tall ? kTallHeight : kHeight;
  const double width = columns * kWidth;
  std::string legend;
  double at_x = kLeft;
  double at_y = kTitle + 14.0;
  for (const auto& [label, style] : legend_of(figure)) {
    const double length = 44.0 + 7.0 * static_cast<double>(label.size());
    if (at_x > kLeft && at_x + length > width) {
      at_x = kLeft;
      at_y += kLegendRow;
    }
    legend +=
        fmt::format("<path class=\"l\" stroke=\"{}\"{} d=\"M{:.1f} {:.1f}h26\"/><text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>\n",
                    style_of(style).colour, dash_of(style), at_x, at_y - 4.0, at_x + 32.0, at_y, escape_markup(label));
    at_x += length;
  }
  const double head = at_y + 8.0;
  const double height = head + rows * row_height;
  std::string out = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" "
      "role=\"img\">\n"
      "<title>{2}</title>\n<style>{3}</style>\n<rect width=\"{0:.0f}\" height=\"{1:.0f}\" fill=\"#fff\"/>\n"
      "<text x=\"{4:.0f}\" y=\"20\" class=\"h\">{2}</text>\n",
      width, height, escape_markup(figure.title), kCss, kLeft);
  out += legend;
  for (std::size_t i = 0; i < figure.panels.size(); ++i) {
    const int column = static_cast<int>(i) % columns;
    const int row = static_cast<int>(i) / columns;
    out += draw_panel(figure.panels[i], column * kWidth, head + row * row_height, row_height,
                      fmt::format("{}_{}", figure.name, i));
  }
  return out + "</svg>\n";
}

}  // namespace ajar
