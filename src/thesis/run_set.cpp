#include "run_set.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ajar::thesis {
namespace {

constexpr double kFoldJump = 90.0;  // [°]

}  // namespace

RunSet::RunSet(std::vector<ExperimentRun> runs) : runs_(std::move(runs)) {
  for (std::size_t i = 0; i < runs_.size(); ++i) index_[runs_[i].plan.name] = i;
}

FigurePanel make_panel(const std::string& title, const std::string& x_label, const std::string& y_label,
                       const std::vector<double>& levels) {
  FigurePanel out;
  out.title = title;
  out.x_label = x_label;
  out.y_label = y_label;
  out.levels = levels;
  return out;
}

FigureCurve over_time(const Samples& samples, const SampleValue& value, const std::string& label, int style) {
  FigureCurve out{label, {}, style, false};
  out.points.reserve(samples.size());
  for (const ExperimentSample& s : samples) {
    const double y = value(s);
    // A folded angle jumps by half a turn: that is no stroke of the curve.
    if (!out.points.empty() && std::abs(y - out.points.back().y) > kFoldJump) {
      out.points.push_back({s.time - samples.front().time, std::numeric_limits<double>::quiet_NaN()});
    }
    out.points.push_back({s.time - samples.front().time, y});
  }
  return out;
}

FigureCurve in_plane(const Samples& samples, const SampleValue& x, const SampleValue& y, const std::string& label,
                     int style) {
  FigureCurve out{label, {}, style, false};
  out.points.reserve(samples.size());
  for (const ExperimentSample& s : samples) out.points.push_back({x(s), y(s)});
  return out;
}

void share_axes(Figure& figure) {
  std::vector<FigurePoint> all;
  for (const FigurePanel& panel : figure.panels) {
    for (const FigureCurve& curve : panel.curves) all.insert(all.end(), curve.points.begin(), curve.points.end());
  }
  for (FigurePanel& panel : figure.panels) panel.extent = all;
}

double largest(const Samples& samples, const SampleValue& value, double from) {
  double out = samples.empty() ? 0.0 : -std::numeric_limits<double>::infinity();
  for (const ExperimentSample& s : samples) {
    if (s.time - samples.front().time >= from) out = std::max(out, value(s));
  }
  return out;
}

double smallest(const Samples& samples, const SampleValue& value, double from) {
  return -largest(samples, [&](const ExperimentSample& s) { return -value(s); }, from);
}

double last(const Samples& samples, const SampleValue& value) { return samples.empty() ? 0.0 : value(samples.back()); }

double base_way(const Samples& samples, double from) {
  double way = 0.0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    if (samples[i].time - samples.front().time < from) continue;
    way += std::hypot(samples[i].base.x - samples[i - 1].base.x, samples[i].base.y - samples[i - 1].base.y);
  }
  return way;
}

double distance_of(const ExperimentSample& s) { return s.distance; }
double heading_of(const ExperimentSample& s) { return kDegree * s.heading_error; }
double heading_size_of(const ExperimentSample& s) { return kDegree * std::abs(s.heading_error); }
double path_error_of(const ExperimentSample& s) { return 1e3 * s.path_error; }

}  // namespace ajar::thesis
