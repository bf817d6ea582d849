#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ajar {

/// A point of a drawing, in the units of its axes.
struct FigurePoint {
  double x = 0.0;
  double y = 0.0;
};

/// One curve. Points that are not finite interrupt it.
struct FigureCurve {
  std::string label;                ///< In the legend; empty = not in it
  std::vector<FigurePoint> points;  ///< In the units of the axes
  int style = 0;                    ///< Colour and dashes, 0-7; the same style means the same thing in every panel
  bool markers = false;             ///< Dots at the points, for few of them
};

/// A straight stroke between two points, such as base to hand at one instant.
struct FigureStroke {
  FigurePoint from;
  FigurePoint to;
  int style = 0;
};

/// A labelled dot.
struct FigureMark {
  FigurePoint at;
  std::string text;
  int style = 0;
};

/// One pair of axes.
struct FigurePanel {
  std::string title;
  std::string x_label;  ///< With its unit
  std::string y_label;  ///< With its unit
  std::vector<FigureCurve> curves;
  std::vector<FigureStroke> strokes;
  std::vector<FigureMark> marks;
  std::vector<double> levels;  ///< Horizontal reference lines
  bool equal = false;          ///< One unit is as long on both axes: paths
  bool log_y = false;          ///< Values must be > 0
  std::optional<std::pair<double, double>> y_range;
  std::vector<FigurePoint> extent;  ///< Points that the axes must hold besides, not drawn
};

/// A drawing of several panels side by side.
struct Figure {
  std::string name;  ///< File stem, e.g. figure_6_6
  std::string title;
  std::string caption;
  std::vector<FigurePanel> panels;
  int columns = 2;
};

/// The figure as SVG: colour-blind safe (Okabe and Ito), text as text, the same bytes for the same numbers.
[[nodiscard]] std::string to_svg(const Figure& figure);

}  // namespace ajar
