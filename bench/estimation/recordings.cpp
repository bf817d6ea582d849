// Recordings of real furniture: type, curvature against a robust fit that shares no code with ours, honesty.
#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "ajar/estimation/identify.hpp"
#include "cells.hpp"
#include "circle_fits.hpp"

namespace ajar::bench {
namespace {

namespace fs = std::filesystem;

constexpr double kHuber = 2e-3;        // of the robust reference [m]
constexpr double kStraightRms = 2e-3;  // unlabelled tracks with less about a line are drawers [m]
constexpr double kReached = 0.98;      // of the farthest point: the opening is over

// By the folder's name; the kitchen's are not labelled by their source.
MechanismType label_of(const std::string& folder, const std::vector<Vector3d>& points) {
  static const std::map<std::string, MechanismType> labels{
      {"cabinet_one", MechanismType::Hinge},    {"cabinet_two", MechanismType::Hinge},
      {"dishwasher", MechanismType::Hinge},     {"left_door", MechanismType::Hinge},
      {"right_door", MechanismType::Hinge},     {"microwave", MechanismType::Hinge},
      {"drawer", MechanismType::Slide},         {"drawer_one", MechanismType::Slide},
      {"sliding_cabinet", MechanismType::Slide}};
  const auto found = labels.find(folder);
  if (found != labels.end()) return found->second;
  return line_rms(points) < kStraightRms ? MechanismType::Slide : MechanismType::Hinge;
}

struct Score {
  int right = 0, unknown = 0, wrong = 0;
  int inside = 0, hinges = 0;
  std::vector<double> errors;  // of the curvature, relative

  void add(const Identification& found, MechanismType truth, double reference, bool hook) {
    right += found.type == truth ? 1 : 0;
    unknown += found.type == MechanismType::Unknown ? 1 : 0;
    wrong += found.type != truth && found.type != MechanismType::Unknown ? 1 : 0;
    if (truth != MechanismType::Hinge || hook) return;
    const double error = found.curvature.norm() - reference;
    errors.push_back(100.0 * std::abs(error) / reference);
    inside += std::abs(error) < 2.0 * found.curvature_sigma ? 1 : 0;
    ++hinges;
  }
};

Track first_part(const Track& track, double share) {
  double far = 0.0;
  const auto distance = [&](const TrackSample& sample) { return (sample.position - track.samples.front().position).norm(); };
  for (const TrackSample& sample : track.samples) far = std::max(far, distance(sample));
  Track part = track;
  const auto end = std::find_if(part.samples.begin(), part.samples.end(),
                                [&](const TrackSample& sample) { return distance(sample) > kReached * share * far; });
  part.samples.erase(end, part.samples.end());
  return part;
}

}  // namespace

void judge_recordings(Table& table) {
  const char* const named = std::getenv("AJAR_TRACKS");
  const fs::path root = named != nullptr ? fs::path(named) : fs::path(AJAR_SOURCE_DIR) / "../shared/tracks";
  if (!fs::is_directory(root)) {
    fmt::print(stderr, "recordings: skipped, no folder {} (AJAR_TRACKS names one)\n", root.string());
    return;
  }
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(root)) {
    if (entry.path().extension() == ".log") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const bool learnt : {true, false}) {
    Score half, full;
    for (const fs::path& file : files) {
      const std::string folder = file.parent_path().filename().string();
      const Track track = load_track(file.string());
      std::vector<Vector3d> points;
      for (const TrackSample& sample : track.samples) points.push_back(sample.position);
      const MechanismType truth = label_of(folder, points);
      const double reference = fit_circle_geometric(points, kHuber).curvature.norm();
      const bool hook = folder == "cabinet_one" || folder == "cabinet_two" || folder == "drawer_one";
      IdentifyConfig config;
      if (!learnt) config.sensor = folder == "kitchen" ? SensorKind::MotionCapture : SensorKind::Vision;
      half.add(identify(first_part(track, 0.5), config), truth, reference, hook);
      full.add(identify(track, config), truth, reference, hook);
    }
    const std::string name = learnt ? "recordings, noise learnt" : "recordings, sensor stated";
    const std::string of_all = fmt::format("of {}", files.size());
    table.push_back({name + ", half travel: wrong types", "ajar", half.wrong / 1.0, of_all, "0", half.wrong == 0});
    table.push_back({name + ", full travel: wrong types", "ajar", full.wrong / 1.0, of_all, "0", full.wrong == 0});
    table.push_back({name + ", half travel: right types", "ajar", half.right / 1.0, of_all, ""});
    table.push_back({name + ", full travel: right types", "ajar", full.right / 1.0, of_all, ">= 39", full.right >= 39});
    const double median = quantile(full.errors, 0.5), p90 = quantile(full.errors, 0.9);
    table.push_back(
        {name + ", full travel: curvature against a robust fit, median", "ajar", median, "%", "<= 0.5", median <= 0.5});
    table.push_back({name + ", full travel: curvature against a robust fit, p90", "ajar", p90, "%", "<= 5", p90 <= 5.0});
    table.push_back({name + ", half travel: curvature against that fit of the whole, median", "ajar",
                     quantile(half.errors, 0.5), "%", ""});
    const double coverage[2] = {double(half.inside) / half.hinges, double(full.inside) / full.hinges};
    table.push_back({name + ", half travel: within 2 sigma", "ajar", coverage[0], "-", ">= 0.9", coverage[0] >= 0.9});
    table.push_back({name + ", full travel: within 2 sigma", "ajar", coverage[1], "-", ">= 0.9", coverage[1] >= 0.9});
  }
  int wrong = 0;
  for (const fs::path& file : files) {
    const Track track = load_track(file.string());
    std::vector<Vector3d> points;
    for (const TrackSample& sample : track.samples) points.push_back(sample.position);
    wrong += fit_by_bic(points).type != label_of(file.parent_path().filename().string(), points) ? 1 : 0;
  }
  table.push_back({"recordings, full travel: wrong types", "line or circle by BIC", wrong / 1.0,
                   fmt::format("of {}", files.size()), ""});
}

}  // namespace ajar::bench
