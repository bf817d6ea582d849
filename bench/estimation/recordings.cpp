// Recordings of real furniture: type, curvature against a robust fit that shares no code with ours, honesty.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
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
constexpr int kTwins = 8;              // of each recording
constexpr std::uint64_t kTwinSeed = 9007;
constexpr double kApart = 4e-3;    // [m]
constexpr double kReached = 0.98;  // of the farthest point: the opening is over

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

// The same samples as a recording on the exact path that was identified, with the noise that was learnt from it.
std::vector<Vector3d> twin_of(const Identification& found, Random& rng) {
  std::vector<Vector3d> points;
  Vector3d wave = rng.normal3(found.noise.position_correlated);
  double last = 0.0;
  for (std::size_t i = 0; i < found.arc.size(); ++i) {
    if (!found.inlier[i]) continue;
    const double kept = std::exp(-std::abs(found.arc[i] - last) / found.noise.correlation_length);
    wave = kept * wave + rng.normal3(std::sqrt(1.0 - kept * kept) * found.noise.position_correlated);
    last = found.arc[i];
    points.push_back(found.at(found.arc[i]) + wave + rng.normal3(found.noise.position_white));
  }
  return points;
}

/// What a comparison with a robust fit can tell at all.
struct Twins {
  std::vector<double> ours, reference;  // from the exact curvature, relative [%]
  std::vector<double> between;          // from one another on the same twin [%]
  std::vector<double> kept;             // the reference of the samples that we keep, against that of all [%]
  std::vector<double> thinned;          // the reference of each recording from samples apart, against that from all [%]

  void add(const Identification& found, const std::vector<Vector3d>& points, double reference_curvature, Random& rng) {
    const double truth = found.curvature.norm();
    for (int run = 0; run < kTwins; ++run) {
      Track track;
      const std::vector<Vector3d> twin = twin_of(found, rng);
      for (const Vector3d& p : twin) track.samples.push_back({.position = p});
      const double own = identify(track).curvature.norm();
      const double robust = fit_circle_geometric(twin, kHuber).curvature.norm();
      ours.push_back(100.0 * std::abs(own - truth) / truth);
      reference.push_back(100.0 * std::abs(robust - truth) / truth);
      between.push_back(100.0 * std::abs(own - robust) / truth);
    }
    std::vector<Vector3d> apart;
    std::vector<Vector3d> used;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (found.inlier[i]) used.push_back(points[i]);
    }
    const double same = fit_circle_geometric(used, kHuber).curvature.norm();
    kept.push_back(100.0 * std::abs(same - reference_curvature) / reference_curvature);
    for (const Vector3d& p : points) {
      if (apart.empty() || (p - apart.back()).norm() > kApart) apart.push_back(p);
    }
    const double other = fit_circle_geometric(apart, kHuber).curvature.norm();
    thinned.push_back(100.0 * std::abs(other - reference_curvature) / reference_curvature);
  }
  void report(Table& table) const {
    const char* const name = "twins of the recordings, exact circles: curvature from the truth, median";
    table.push_back({name, "ajar", quantile(ours, 0.5), "%", ""});
    table.push_back({name, "robust fit", quantile(reference, 0.5), "%", ""});
    table.push_back({"twins of the recordings, exact circles: curvature against that robust fit, median", "ajar",
                     quantile(between, 0.5), "%", ""});
    table.push_back({"recordings: curvature of the samples that ajar keeps against all, median", "robust fit",
                     quantile(kept, 0.5), "%", ""});
    table.push_back({"recordings: curvature with samples 4 mm apart against all, median", "robust fit",
                     quantile(thinned, 0.5), "%", ""});
  }
};

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
  Twins twins;
  Random rng(kTwinSeed);
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
      const Identification found = identify(track, config);
      full.add(found, truth, reference, hook);
      if (learnt && truth == MechanismType::Hinge && !hook) twins.add(found, points, reference, rng);
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
  twins.report(table);
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
