#pragma once

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "ajar/thesis/experiment.hpp"
#include "ajar/thesis/figure.hpp"
#include "ajar/thesis/reproduction.hpp"

namespace ajar::thesis {

inline constexpr double kDegree = 57.295779513082320877;
/// Styles of the curves: the same contestant looks the same in every figure.
inline constexpr int kThesisStyle = 0;
inline constexpr int kCorrectedStyle = 1;
inline constexpr int kOursStyle = 2;
inline constexpr int kVariantStyle = 3;
inline constexpr int kReferenceStyle = 4;
inline constexpr int kSecondStyle = 5;
inline constexpr int kThirdStyle = 6;
inline constexpr const char* kThesisLabel = "thesis's law";
inline constexpr const char* kCorrectedLabel = "with scaling and feedback";
inline constexpr const char* kOursLabel = "ours";
/// Distance hand - base that the experiments ask for [m].
inline constexpr double kWantedDistance = 0.75;

/// Runs by name.
class RunSet {
 public:
  explicit RunSet(std::vector<ExperimentRun> runs);
  /// @throws std::out_of_range  for a name that was not planned
  [[nodiscard]] const ExperimentRun& operator[](const std::string& name) const { return runs_[index_.at(name)]; }

 private:
  std::vector<ExperimentRun> runs_;
  std::map<std::string, std::size_t> index_;
};

using Samples = std::vector<ExperimentSample>;
using SampleValue = std::function<double(const ExperimentSample&)>;

/// Empty axes with horizontal reference lines.
[[nodiscard]] FigurePanel make_panel(const std::string& title, const std::string& x_label, const std::string& y_label,
                                     const std::vector<double>& levels = {});

/// A curve over the time since the first sample.
[[nodiscard]] FigureCurve over_time(const Samples& samples, const SampleValue& value, const std::string& label, int style);
/// A curve in a plane.
[[nodiscard]] FigureCurve in_plane(const Samples& samples, const SampleValue& x, const SampleValue& y,
                                   const std::string& label, int style);

/// Gives all panels of a figure the same axes.
void share_axes(Figure& figure);

/// Largest value from a time on, since the first sample; 0 without samples.
[[nodiscard]] double largest(const Samples& samples, const SampleValue& value, double from = 0.0);
[[nodiscard]] double smallest(const Samples& samples, const SampleValue& value, double from = 0.0);
/// Value at the last sample.
[[nodiscard]] double last(const Samples& samples, const SampleValue& value);
/// Length of the base's path [m].
[[nodiscard]] double base_way(const Samples& samples, double from = 0.0);

// What is looked at again and again.
[[nodiscard]] double distance_of(const ExperimentSample& s);
[[nodiscard]] double heading_of(const ExperimentSample& s);       ///< [°]
[[nodiscard]] double heading_size_of(const ExperimentSample& s);  ///< [°]
[[nodiscard]] double path_error_of(const ExperimentSample& s);    ///< [mm]

// The chapters: what is run, and what is made of it.
[[nodiscard]] std::vector<ExperimentPlan> navigation_plans();
void add_navigation(const RunSet& runs, Reproduction& out);
[[nodiscard]] std::vector<ExperimentPlan> hinge_plans();
void add_hinges(const RunSet& runs, Reproduction& out);
[[nodiscard]] std::vector<ExperimentPlan> line_plans();
void add_lines(const RunSet& runs, Reproduction& out);
[[nodiscard]] std::vector<ExperimentPlan> physics_plans();
void add_physics(const RunSet& runs, Reproduction& out);
[[nodiscard]] std::vector<ExperimentPlan> estimator_plans();
void add_estimator(const RunSet& runs, Reproduction& out);

}  // namespace ajar::thesis
