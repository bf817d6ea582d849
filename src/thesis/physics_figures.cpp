// Figures 6.14-6.16: the three types in rigid-body physics at 50 Hz, in place of the thesis's real robot.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "run_set.hpp"

namespace ajar::thesis {
namespace {

constexpr std::array kDelays{0, 50, 100};                   // [ms]
constexpr std::array kMisalignments{0, 5, 10, 15, 20, 30};  // [°]
// In this time the base has turned by most of its misalignment; the thesis's hand has not met the robot yet.
constexpr double kAlignment = 4.0;     // [s]
constexpr double kSignificant = 20.0;  // about the width of a finger [mm]
constexpr double kEarly = 1.0;         // the first heading peak of a slow loop [s]

struct Type {
  int number;
  const char* file;
  const char* what;
};
constexpr std::array<Type, 3> kTypes{{{1, "type_1_physics.toml", "Type I, a door of 0.8 m"},
                                      {2, "type_2_physics.toml", "Type II, an oven of 0.5 m"},
                                      {3, "type_3_physics.toml", "Type III, a sliding door, λ = 5°"}}};
constexpr std::array<int, 3> kDelayStyles{kThesisStyle, kSecondStyle, kVariantStyle};
constexpr std::array<int, 3> kOurDelayStyles{kOursStyle, kCorrectedStyle, kThirdStyle};

std::string delay_run(const Type& type, bool ours, int delay) {
  return fmt::format("physics_type_{}_{}_{}ms", type.number, ours ? "ours" : "thesis", delay);
}

std::string alignment_run(const Type& type, bool ours, int angle) {
  return fmt::format("physics_type_{}_{}_askew_{}", type.number, ours ? "ours" : "thesis", angle);
}

double error_until(const Samples& samples, double until) {
  double out = 0.0;
  for (const ExperimentSample& s : samples) {
    if (s.time - samples.front().time <= until) out = std::max(out, path_error_of(s));
  }
  return out;
}

FigurePanel alignment_panel(const RunSet& runs, const Type& type) {
  FigurePanel panel = make_panel(fmt::format("Largest error of the first {:.0f} s over the misalignment", kAlignment),
                                 "misalignment in °", "error in mm");
  FigureCurve thesis{"thesis's law, 0 ms", {}, kThesisStyle, true};
  FigureCurve ours{"ours, 0 ms", {}, kOursStyle, true};
  for (const int angle : kMisalignments) {
    thesis.points.push_back(
        {static_cast<double>(angle), error_until(runs[alignment_run(type, false, angle)].following, kAlignment)});
    ours.points.push_back(
        {static_cast<double>(angle), error_until(runs[alignment_run(type, true, angle)].following, kAlignment)});
  }
  panel.curves = {thesis, ours};
  return panel;
}

Figure type_figure(const RunSet& runs, const Type& type) {
  Figure figure{
      fmt::format("figure_6_{}", 13 + type.number),
      fmt::format("Figure 6.{}: {}, in physics at 50 Hz", 13 + type.number, type.what),
      "Base with 0.1 s lag and 50 ms delay, arm with 15 ms lag; the delay in the legend comes on top for everything that "
      "is measured and commanded.",
      {},
      2};
  FigurePanel distance = make_panel("Distance hand - base", "time in s", "d in m", {kWantedDistance});
  FigurePanel heading = make_panel("Heading against the hand's motion", "time in s", "e in °", {0.0});
  FigurePanel error = make_panel("Error of the hand from its path", "time in s", "error in mm", {10.0});
  for (const bool ours : {false, true}) {
    for (std::size_t i = 0; i < kDelays.size(); ++i) {
      const Samples& s = runs[delay_run(type, ours, kDelays[i])].following;
      const std::string label = fmt::format("{}, {} ms", ours ? kOursLabel : kThesisLabel, kDelays[i]);
      const int style = ours ? kOurDelayStyles[i] : kDelayStyles[i];
      distance.curves.push_back(over_time(s, distance_of, label, style));
      heading.curves.push_back(over_time(s, heading_of, label, style));
      error.curves.push_back(over_time(s, path_error_of, label, style));
    }
  }
  figure.panels = {distance, heading, error};
  if (type.number != 1) figure.panels.push_back(alignment_panel(runs, type));
  return figure;
}

double worst_error(const RunSet& runs, const Type& type, bool ours) {
  double out = 0.0;
  for (const int delay : kDelays) out = std::max(out, largest(runs[delay_run(type, ours, delay)].following, path_error_of));
  return out;
}

void add_alignment_statement(const RunSet& runs, const Type& type, int limit, Reproduction& out) {
  const double aligned = error_until(runs[alignment_run(type, false, 0)].following, kAlignment);
  const double below = error_until(runs[alignment_run(type, false, limit - 5)].following, kAlignment);
  const double above = error_until(runs[alignment_run(type, false, limit + 5)].following, kAlignment);
  const double far = error_until(runs[alignment_run(type, false, 30)].following, kAlignment);
  const double ours = error_until(runs[alignment_run(type, true, limit + 5)].following, kAlignment);
  out.statements.push_back(
      {fmt::format("6.{}", 13 + type.number),
       fmt::format("Significant deviations when the base stands askew by more than {}°", limit), std::nullopt, above, ours,
       "mm", above > kSignificant,
       fmt::format(
           "Error of the first {:.0f} s at {}°. It grows steadily, {:.1f} mm aligned, {:.1f} mm at {}°, {:.1f} mm at 30°, "
           "without an "
           "angle at which it sets in: the base turns later than the arm counts on. {:.0f} mm are called significant here.",
           kAlignment, limit + 5, aligned, below, limit - 5, far, kSignificant)});
}

void add_statements(const RunSet& runs, Reproduction& out) {
  auto& rows = out.statements;
  for (const Type& type : kTypes) {
    const double thesis = worst_error(runs, type, false);
    const double ours = worst_error(runs, type, true);
    const std::size_t contacts = runs[delay_run(type, false, 0)].result.unwanted_contacts.size();
    std::size_t our_contacts = 0;
    for (const int delay : kDelays) our_contacts += runs[delay_run(type, true, delay)].result.unwanted_contacts.size();
    const double reached = runs[delay_run(type, false, 0)].result.opening_fraction.value_or(0.0);
    rows.push_back(
        {fmt::format("6.{}", 13 + type.number), "The task is done at 50 Hz, with deviations from the path", std::nullopt,
         thesis, ours, "mm", reached > 0.95,
         fmt::format("Largest error, worst of 0, 50 and 100 ms; {:.0f} % of the path is reached by the thesis's law. The "
                     "base lags, the "
                     "arm counts on it, and nothing leads the hand back. Touches of the robot with itself: {} with the "
                     "thesis's law at 0 ms, {} with ours at all delays.",
                     100.0 * reached, contacts, our_contacts)});
  }
  const Samples& door = runs[delay_run(kTypes[0], false, 0)].following;
  const Samples& our_door = runs[delay_run(kTypes[0], true, 0)].following;
  rows.push_back(
      {"6.14", "The low rate makes a heading peak at the beginning", std::nullopt,
       kDegree * std::abs(smallest(
                     door, [](const ExperimentSample& s) { return s.heading_error; }, kEarly)),
       kDegree * std::abs(std::min(0.0, smallest(
                                            our_door, [](const ExperimentSample& s) { return s.heading_error; }, kEarly))),
       "°", smallest(door, heading_of, kEarly) < -1.0,
       "Overshoot of the heading at 0 ms. With the lag of this base the thesis's loop hardly overshoots at 50 Hz: the real "
       "one "
       "must have been slower. Ours overshoots because it keeps the base within its accelerations."});
  const Samples& oven = runs[delay_run(kTypes[1], false, 0)].following;
  const Samples& our_oven = runs[delay_run(kTypes[1], true, 0)].following;
  rows.push_back(
      {"6.15", "Type II keeps a steady error of the distance", std::nullopt,
       std::abs(last(oven, distance_of) - kWantedDistance), std::abs(last(our_oven, distance_of) - kWantedDistance), "m",
       std::abs(last(oven, distance_of) - kWantedDistance) > 0.02,
       "As in Figure 6.9. The thesis's law drives the arm against the robot's own cabinet here and stays there."});
  const Samples& slide = runs[delay_run(kTypes[2], false, 100)].following;
  const Samples& our_slide = runs[delay_run(kTypes[2], true, 100)].following;
  rows.push_back(
      {"6.16", "Type III overshoots in its heading", std::nullopt, std::max(0.0, -smallest(slide, heading_of)),
       std::max(0.0, -smallest(our_slide, heading_of)), "°", -smallest(slide, heading_of) > 0.3,
       "From 5° at 100 ms: how far the heading passes zero. Ours steers to close the distance, which is part of it."});
  add_alignment_statement(runs, kTypes[1], 15, out);
  add_alignment_statement(runs, kTypes[2], 10, out);
}

}  // namespace

std::vector<ExperimentPlan> physics_plans() {
  std::vector<ExperimentPlan> plans;
  for (const Type& type : kTypes) {
    for (const bool ours : {false, true}) {
      std::vector<std::string> common;
      if (ours && type.number == 2) common.emplace_back("follow.free_about_axis=true");
      const Contestant contestant = ours ? Contestant::Ours : Contestant::Thesis;
      for (const int delay : kDelays) {
        std::vector<std::string> overrides = common;
        overrides.push_back(fmt::format("control.delay_ms={}", delay));
        plans.push_back({delay_run(type, ours, delay), type.file, contestant, overrides, true});
      }
      for (const int angle : kMisalignments) {
        if (type.number == 1) continue;
        const int yaw = type.number == 2 ? angle : angle - 90;
        std::vector<std::string> overrides = common;
        overrides.push_back(fmt::format("follow.parking_yaw_deg={}", yaw));
        overrides.push_back(fmt::format("follow.start_yaw_deg={}", yaw));
        overrides.emplace_back(type.number == 2 ? "follow.start_m=[-1.5,-1.15]" : "follow.start_m=[-1.0,-1.15]");
        plans.push_back({alignment_run(type, ours, angle), type.file, contestant, overrides, false});
      }
    }
  }
  return plans;
}

void add_physics(const RunSet& runs, Reproduction& out) {
  for (const Type& type : kTypes) out.figures.push_back(type_figure(runs, type));
  add_statements(runs, out);
}

}  // namespace ajar::thesis
