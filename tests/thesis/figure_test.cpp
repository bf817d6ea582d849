// Strategy: the drawing is read back as text: every panel, label and legend entry is there once, values land where the axes
// say, what is not finite interrupts a curve, and what XML reserves is written out.
#include "ajar/thesis/figure.hpp"

#include <gtest/gtest.h>

#include <limits>

namespace ajar {
namespace {

int count(const std::string& text, const std::string& part) {
  int n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + part.size())) ++n;
  return n;
}

Figure two_panels() {
  Figure figure{"figure_x", "A & B", "caption", {}, 2};
  for (const char* title : {"left", "right"}) {
    FigurePanel panel;
    panel.title = title;
    panel.x_label = "time in s";
    panel.y_label = "d in m";
    panel.curves.push_back({"law", {{0.0, 0.0}, {1.0, 2.0}, {2.0, 1.0}}, 0, false});
    figure.panels.push_back(panel);
  }
  return figure;
}

TEST(Figure, ShowsEveryPanelAndEachLegendEntryOnce) {
  const std::string svg = to_svg(two_panels());
  EXPECT_EQ(count(svg, ">left<"), 1);
  EXPECT_EQ(count(svg, ">right<"), 1);
  EXPECT_EQ(count(svg, ">time in s<"), 2);
  EXPECT_EQ(count(svg, ">law<"), 1);
  EXPECT_EQ(count(svg, "A &amp; B"), 2);  // title and heading
  EXPECT_EQ(svg, to_svg(two_panels()));
}

TEST(Figure, InterruptsACurveWhereAValueIsMissing) {
  Figure figure = two_panels();
  figure.panels.resize(1);
  const int whole = count(to_svg(figure), "M");
  figure.panels[0].curves[0].points.insert(figure.panels[0].curves[0].points.begin() + 1,
                                           {0.5, std::numeric_limits<double>::quiet_NaN()});
  EXPECT_EQ(count(to_svg(figure), "M"), whole + 1);
}

TEST(Figure, PutsDecadesAtEqualSteps) {
  Figure figure = two_panels();
  figure.panels.resize(1);
  figure.panels[0].log_y = true;
  figure.panels[0].curves[0].points = {{0.0, 0.1}, {1.0, 100.0}};
  const std::string svg = to_svg(figure);
  for (const char* label : {">0.1<", ">1<", ">10<", ">100<"}) EXPECT_GE(count(svg, label), 1) << label;
}

}  // namespace
}  // namespace ajar
