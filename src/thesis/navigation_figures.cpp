// Figures 6.2-6.4: how the base drives to its parking pose.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "ajar/core/so3.hpp"
#include "run_set.hpp"

namespace ajar::thesis {
namespace {

// Arrived: nearer than a thousandth of the way and straighter than one sees.
constexpr double kNear = 0.01;        // [m]
constexpr double kStraight = 0.0175;  // 1° [rad]
// Slower than this the base turns on the spot: a tenth of its speed limit.
constexpr double kOnTheSpot = 0.025;  // [m/s]
constexpr double kTurning = 0.1;      // [rad/s]

struct Goal {
  const char* name;
  double x, y, yaw;  // [m, m, °]
};
/// Goals of Figure 6.4: all around the start, with headings that do not point the way.
constexpr std::array<Goal, 6> kGoals{{{"a", 1.5, 1.0, 0.0},
                                      {"b", -1.5, 1.0, 90.0},
                                      {"c", 0.2, 1.5, 180.0},
                                      {"d", 1.5, -1.0, -90.0},
                                      {"e", -2.0, 0.2, 135.0},
                                      {"f", 0.1, -1.6, 45.0}}};

/// What an approach came to.
struct Approach {
  double duration = 0.0;   // until it stays near and straight [s]
  double position = 0.0;   // left at the end [mm]
  double reversed = 0.0;   // first stage with v < 0 [s]
  double turn_peak = 0.0;  // largest |yaw - goal| [°]
  double turn_peak_time = 0.0;
  double spot_start = 0.0;  // last turn on the spot [s]
  int cusps = 0;            // changes of the driving direction
  double curvature = 0.0;   // largest |ω/v| while driving [1/m]
};

BasePose goal_of(const ExperimentRun& run) {
  const FollowConfig& follow = plan_scenario(run.plan).mission.follow;
  return {follow.parking.x(), follow.parking.y(), follow.parking_yaw};
}

Approach judge(const ExperimentRun& run) {
  const BasePose goal = goal_of(run);
  Approach out;
  int sense = 0;
  bool on_spot = false;
  bool forward_seen = false;
  for (const ExperimentSample& s : run.approach) {
    const double off = std::hypot(s.base.x - goal.x, s.base.y - goal.y);
    const double turn = std::abs(wrap_angle(s.base.yaw - goal.yaw));
    if (off > kNear || turn > kStraight) out.duration = s.time;
    if (turn * kDegree > out.turn_peak) {
      out.turn_peak = turn * kDegree;
      out.turn_peak_time = s.time;
    }
    const int now = s.v > kOnTheSpot ? 1 : s.v < -kOnTheSpot ? -1 : 0;
    if (now != 0) {
      out.cusps += sense != 0 && now != sense ? 1 : 0;
      sense = now;
      out.curvature = std::max(out.curvature, std::abs(s.w / s.v));
    }
    forward_seen = forward_seen || s.v > 0.0;
    if (!forward_seen) out.reversed = s.time;
    const bool spot = std::abs(s.v) < kOnTheSpot && std::abs(s.w) > kTurning && off < 0.2;
    if (spot && !on_spot) out.spot_start = s.time;
    on_spot = spot;
    out.position = 1e3 * off;
  }
  return out;
}

std::string goal_run(const Goal& goal, Contestant contestant) {
  return fmt::format("navigation_goal_{}_{}", goal.name, contestant == Contestant::Thesis ? "thesis" : "ours");
}

double x_of(const ExperimentSample& s) { return s.base.x; }
double y_of(const ExperimentSample& s) { return s.base.y; }

/// Short strokes that show where the nose points, one per second.
void add_noses(const Samples& samples, int style, FigurePanel& panel) {
  double next = 0.0;
  for (const ExperimentSample& s : samples) {
    if (s.time < next) continue;
    next = s.time + 1.0;
    panel.strokes.push_back(
        {{s.base.x, s.base.y}, {s.base.x + 0.12 * std::cos(s.base.yaw), s.base.y + 0.12 * std::sin(s.base.yaw)}, style});
  }
}

struct Driver {
  const char* run;
  const char* label;
  int style;
};
constexpr std::array<Driver, 3> kDrivers{{{"navigation_thesis", kThesisLabel, kThesisStyle},
                                          {"navigation_corrected", "polar law, gains inside the rule", kCorrectedStyle},
                                          {"navigation_ours", kOursLabel, kOursStyle}}};

Figure path_figure(const RunSet& runs) {
  Figure figure{"figure_6_2",
                "Figure 6.2: driving to the parking pose (-1.5 m, -1.15 m, 0°)",
                "Path of the axle's middle; the short strokes show the nose once a second.",
                {},
                2};
  FigurePanel path = make_panel("Path", "x in m", "y in m");
  path.marks = {{{0.0, 0.0}, "start", 7}, {{-1.5, -1.15}, "goal", 7}};
  path.equal = true;
  FigurePanel speed = make_panel("Forward speed", "time in s", "v in m/s", {0.0});
  for (const Driver& driver : kDrivers) {
    const Samples& samples = runs[driver.run].approach;
    path.curves.push_back(in_plane(samples, x_of, y_of, driver.label, driver.style));
    add_noses(samples, driver.style, path);
    speed.curves.push_back(over_time(samples, [](const ExperimentSample& s) { return s.v; }, driver.label, driver.style));
  }
  figure.panels = {path, speed};
  return figure;
}

Figure error_figure(const RunSet& runs) {
  Figure figure{"figure_6_3",
                "Figure 6.3: distance and heading left on the way to the parking pose",
                "The solid line of each colour has exact drives; dots: the same law in rigid-body physics.",
                {},
                2};
  FigurePanel distance = make_panel("Distance to the goal", "time in s", "ρ in m");
  FigurePanel heading = make_panel("Heading error", "time in s", "|θ - θ goal| in °", {180.0});
  const auto add = [&](const std::string& name, const std::string& label, int style) {
    const ExperimentRun& run = runs[name];
    const BasePose goal = goal_of(run);
    distance.curves.push_back(over_time(
        run.approach, [goal](const ExperimentSample& s) { return std::hypot(s.base.x - goal.x, s.base.y - goal.y); }, label,
        style));
    heading.curves.push_back(over_time(
        run.approach, [goal](const ExperimentSample& s) { return kDegree * std::abs(wrap_angle(s.base.yaw - goal.yaw)); },
        label, style));
  };
  for (const Driver& driver : kDrivers) add(driver.run, driver.label, driver.style);
  add("navigation_physics_thesis", "thesis's law in physics", kVariantStyle);
  add("navigation_physics_ours", "ours in physics", kReferenceStyle);
  figure.panels = {distance, heading};
  return figure;
}

Figure goals_figure(const RunSet& runs) {
  Figure figure{"figure_6_4", "Figure 6.4: other goals from the same start", "Goals with their headings.", {}, 2};
  FigurePanel thesis = make_panel("Thesis's law", "x in m", "y in m");
  thesis.equal = true;
  FigurePanel ours = make_panel("Ours", "x in m", "y in m");
  ours.equal = true;
  for (const Goal& goal : kGoals) {
    for (FigurePanel* panel : {&thesis, &ours}) {
      const double yaw = goal.yaw / kDegree;
      panel->marks.push_back({{goal.x, goal.y}, goal.name, 7});
      panel->strokes.push_back({{goal.x, goal.y}, {goal.x + 0.3 * std::cos(yaw), goal.y + 0.3 * std::sin(yaw)}, 7});
    }
    const bool first = goal.name[0] == 'a';
    thesis.curves.push_back(
        in_plane(runs[goal_run(goal, Contestant::Thesis)].approach, x_of, y_of, first ? kThesisLabel : "", kThesisStyle));
    ours.curves.push_back(
        in_plane(runs[goal_run(goal, Contestant::Ours)].approach, x_of, y_of, first ? kOursLabel : "", kOursStyle));
  }
  figure.panels = {thesis, ours};
  share_axes(figure);
  return figure;
}

/// Goals reached within 1 cm and 1° whose last heading change does not swing back by more than a tenth.
int goals_reached(const RunSet& runs, Contestant contestant) {
  int reached = 0;
  for (const Goal& goal : kGoals) {
    const ExperimentRun& run = runs[goal_run(goal, contestant)];
    const BasePose target = goal_of(run);
    if (run.approach.empty()) continue;
    const BasePose& end = run.approach.back().base;
    const bool near = std::hypot(end.x - target.x, end.y - target.y) < kNear;
    reached += near && std::abs(wrap_angle(end.yaw - target.yaw)) < kStraight ? 1 : 0;
  }
  return reached;
}

/// Reversals of the turning direction in the second half of the journeys, all goals together.
int swings(const RunSet& runs, Contestant contestant) {
  int count = 0;
  for (const Goal& goal : kGoals) {
    const Samples& samples = runs[goal_run(goal, contestant)].approach;
    int sense = 0;
    int changes = 0;
    for (const ExperimentSample& s : samples) {
      const int now = s.w > kTurning ? 1 : s.w < -kTurning ? -1 : 0;
      changes += now != 0 && sense != 0 && now != sense ? 1 : 0;
      if (now != 0) sense = now;
    }
    count = std::max(count, changes);
  }
  return count;
}

}  // namespace

std::vector<ExperimentPlan> navigation_plans() {
  // Only the drive matters here: the hand then moves a centimetre.
  const std::string short_path = "goal.opening_m=0.01";
  std::vector<ExperimentPlan> plans{
      {"navigation_thesis", "type_4.toml", Contestant::Thesis, {short_path}, true},
      {"navigation_corrected", "type_4.toml", Contestant::Corrected, {short_path}, true},
      {"navigation_ours",
       "type_4.toml",
       Contestant::Ours,
       {short_path, "control.navigation.acceleration=100", "control.navigation.yaw_acceleration=100",
        // With exact drives nothing speaks for slowing in curves or long before the goal.
        "control.navigation.beta=0", "control.navigation.slow_radius=0.03", "control.navigation.k_phi=1",
        "control.navigation.k_turn=2"},
       true}};
  for (const Contestant contestant : {Contestant::Thesis, Contestant::Ours}) {
    plans.push_back({contestant == Contestant::Thesis ? "navigation_physics_thesis" : "navigation_physics_ours",
                     "navigation_physics.toml",
                     contestant,
                     {},
                     true});
    for (const Goal& goal : kGoals) {
      plans.push_back(
          {goal_run(goal, contestant),
           "type_4.toml",
           contestant,
           {short_path, fmt::format("follow.parking_m=[{},{}]", goal.x, goal.y),
            fmt::format("follow.parking_yaw_deg={}", goal.yaw), fmt::format("mechanism.at_m=[{},{}]", goal.x - 0.8, goal.y)},
           false});
    }
  }
  return plans;
}

void add_navigation(const RunSet& runs, Reproduction& out) {
  out.figures.push_back(path_figure(runs));
  out.figures.push_back(error_figure(runs));
  out.figures.push_back(goals_figure(runs));
  const Approach thesis = judge(runs["navigation_thesis"]);
  const Approach corrected = judge(runs["navigation_corrected"]);
  const Approach ours = judge(runs["navigation_ours"]);
  const Approach physics = judge(runs["navigation_physics_thesis"]);
  auto& rows = out.statements;
  rows.push_back(
      {"6.2", "The drive to the parking pose takes 13 s", 13.0, thesis.duration, ours.duration, "s",
       std::abs(thesis.duration - 13.0) < 1.5,
       fmt::format("Speed limits 0.25 m/s and 0.6 rad/s, which the thesis does not state, give its times. Gains inside "
                   "the rule of the polar law need {:.1f} s; ours drives backward in one go.",
                   corrected.duration)});
  rows.push_back({"6.2", "At first it reverses, until 2 s", 2.0, thesis.reversed, std::nullopt, "s", thesis.reversed > 0.5,
                  fmt::format("The law reverses by itself while the goal is behind: changes of direction {}; ours {}.",
                              thesis.cusps, ours.cusps)});
  rows.push_back(
      {"6.3", "The heading error peaks at about 180°", 180.0, thesis.turn_peak, ours.turn_peak, "°",
       thesis.turn_peak > 170.0,
       "With the bearing as printed (3.3) the base drives away from the goal: this peak is the sign that the thesis's "
       "code had it right. Ours never turns its back on the heading that it must end with."});
  rows.push_back({"6.3", "The peak comes near 6.5 s", 6.5, thesis.turn_peak_time, std::nullopt, "s",
                  std::abs(thesis.turn_peak_time - 6.5) < 1.0, "Same limits as above."});
  rows.push_back(
      {"6.2", "From 11 s on it turns on the spot", 11.0, thesis.spot_start, std::nullopt, "s",
       std::abs(thesis.spot_start - 11.0) < 2.0,
       fmt::format("No stage of the law: with k = (1, 2, 1) the curvature of the path grows without bound, up to {:.0f} "
                   "1/m here. Gains inside the rule: {:.0f} 1/m; ours: {:.1f} 1/m.",
                   thesis.curvature, corrected.curvature, ours.curvature)});
  rows.push_back({"6.3", "It ends accurately", std::nullopt, thesis.position, ours.position, "mm", thesis.position < 10.0,
                  fmt::format("In physics, with lag and delay of the wheels: {:.0f} mm.", physics.position)});
  const int reached = goals_reached(runs, Contestant::Thesis);
  rows.push_back({"6.4", "All of the other goals are reached", static_cast<double>(kGoals.size()),
                  static_cast<double>(reached), static_cast<double>(goals_reached(runs, Contestant::Ours)), "goals",
                  reached == static_cast<int>(kGoals.size()), "Within 1 cm and 1°."});
  const int changes = swings(runs, Contestant::Thesis);
  rows.push_back({"6.4", "The heading does not oscillate", std::nullopt, static_cast<double>(changes),
                  static_cast<double>(swings(runs, Contestant::Ours)), "turns", changes <= 3,
                  "Most changes of the turning direction on one journey; an S has two, a cusp adds one."});
}

}  // namespace ajar::thesis
