#include "run_series.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "ajar/core/error.hpp"
#include "ajar/core/so3.hpp"
#include "ajar/log/csv_table.hpp"

namespace ajar {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegrees = 180.0 / 3.14159265358979323846;
constexpr double kForceWindow = 0.020;  ///< Forces are shown as they are judged: mean over 20 ms [s]
/// Below this curvature the centre lies too far away to be drawn [1/m].
constexpr double kStraight = 0.02;

using Column = std::vector<double>;

/// Columns by name; one that the log does not have reads as nothing.
class Columns {
 public:
  explicit Columns(CsvTable table) : table_(std::move(table)), empty_(table_.rows, kNothing) {}
  const Column& operator[](const std::string& name) const {
    const auto found = table_.numbers.find(name);
    return found == table_.numbers.end() ? empty_ : found->second;
  }
  [[nodiscard]] Vector3d vector(const std::string& name, std::size_t i) const {
    return {(*this)[name + "_x"][i], (*this)[name + "_y"][i], (*this)[name + "_z"][i]};
  }
  /// Orientation by four columns; none at all where they are missing.
  [[nodiscard]] Eigen::Quaterniond turn(const std::string& name, std::size_t i) const {
    const Eigen::Quaterniond turn((*this)[name + "w"][i], (*this)[name + "x"][i], (*this)[name + "y"][i],
                                  (*this)[name + "z"][i]);
    return turn.coeffs().allFinite() ? turn : Eigen::Quaterniond::Identity();
  }
  [[nodiscard]] const CsvTable& table() const { return table_; }

 private:
  CsvTable table_;
  Column empty_;
};

CsvColumns wanted_columns() {
  CsvColumns wanted;
  wanted.texts = {"phase"};
  wanted.numbers = {
      "time",        "base_v",        "base_w",         "cmd_v",        "cmd_w",       "distance",     "heading_error",
      "sigma_min",   "est_dir_sigma", "est_curv_sigma", "est_arc",      "est_angle",   "true_opening", "true_opening_rate",
      "true_base_x", "true_base_y",   "true_base_yaw",  "wanted_speed", "speed_factor"};
  for (const char* vector :
       {"force", "est_dir", "est_curv", "true_hand", "true_handle", "true_dir", "true_curv", "true_force"}) {
    for (const char* axis : {"_x", "_y", "_z"}) wanted.numbers.push_back(std::string(vector) + axis);
  }
  for (const char* quaternion : {"hand_q", "true_hand_q"}) {
    for (const char* part : {"w", "x", "y", "z"}) wanted.numbers.push_back(std::string(quaternion) + part);
  }
  for (int i = 1; i <= kMaxJoints; ++i) wanted.numbers.push_back("cmd_dq" + std::to_string(i));
  return wanted;
}

Column moving_mean(const Column& values, std::size_t samples) {
  Column out(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::size_t from = i + 1 >= samples ? i + 1 - samples : 0;
    double sum = 0.0;
    for (std::size_t k = from; k <= i; ++k) sum += values[k];
    out[i] = sum / static_cast<double>(i - from + 1);
  }
  return out;
}

/// Force across and along a direction.
void split_force(const Vector3d& force, const Vector3d& direction, double& normal, double& pull) {
  pull = direction.dot(force);
  normal = (force - pull * direction).norm();
}

/// Phases in which the estimate means something, and those in which the sensor is zeroed and touches something.
bool has_estimate(const std::string& phase) { return phase == "probe" || phase == "open"; }
bool has_force(const std::string& phase) { return has_estimate(phase) || phase == "grasp" || phase == "release"; }

using Derived = std::map<std::string, Column>;

void derive_forces(const Columns& log, Derived& out) {
  const std::size_t rows = log.table().rows;
  for (const char* name : {"normal_true", "pull_true", "normal_measured", "pull_measured"}) out[name].assign(rows, kNothing);
  for (std::size_t i = 0; i < rows; ++i) {
    split_force(log.vector("true_force", i), log.vector("true_dir", i), out["normal_true"][i], out["pull_true"][i]);
    split_force(log.vector("force", i), log.vector("est_dir", i), out["normal_measured"][i], out["pull_measured"][i]);
  }
  const Column& time = log["time"];
  const double period = rows > 1 ? (time.back() - time.front()) / static_cast<double>(rows - 1) : kForceWindow;
  const auto samples = static_cast<std::size_t>(std::lround(std::clamp(kForceWindow / std::max(period, 1e-6), 1.0, 100.0)));
  for (const char* name : {"normal_true", "pull_true", "normal_measured", "pull_measured"})
    out[name] = moving_mean(out[name], samples);
  const auto& phases = log.table().texts.at("phase");
  for (std::size_t i = 0; i < rows; ++i) {
    if (!has_force(phases[i])) out["normal_measured"][i] = out["pull_measured"][i] = kNothing;
  }
}

void derive_estimate(const Columns& log, bool slide, Derived& out) {
  const std::size_t rows = log.table().rows;
  for (const char* name : {"direction_error", "direction_2sigma", "curvature_estimated", "curvature_2sigma",
                           "curvature_true", "est_x", "est_y", "opening_estimated"}) {
    out[name].assign(rows, kNothing);
  }
  const auto& phases = log.table().texts.at("phase");
  for (std::size_t i = 0; i < rows; ++i) {
    out["curvature_true"][i] = log.vector("true_curv", i).norm();
    if (!has_estimate(phases[i])) continue;
    // As it is judged: turned so that the believed hand lies on the true one, whatever frame the robot believes in.
    const Vector3d direction = log.turn("true_hand_q", i) * log.turn("hand_q", i).conjugate() * log.vector("est_dir", i);
    const Vector3d truth = log.vector("true_dir", i);
    out["direction_error"][i] = kDegrees * std::atan2(direction.cross(truth).norm(), direction.dot(truth));
    out["direction_2sigma"][i] = 2.0 * kDegrees * log["est_dir_sigma"][i];
    out["curvature_estimated"][i] = log.vector("est_curv", i).norm();
    out["curvature_2sigma"][i] = 2.0 * log["est_curv_sigma"][i];
    out["est_x"][i] = direction.x();
    out["est_y"][i] = direction.y();
    out["opening_estimated"][i] = slide ? log["est_arc"][i] : kDegrees * log["est_angle"][i];
  }
}

void derive_motion(const Columns& log, bool slide, Derived& out) {
  const std::size_t rows = log.table().rows;
  for (const char* name : {"centre_x", "centre_y", "true_speed", "opening", "heading_error"})
    out[name].assign(rows, kNothing);
  for (std::size_t i = 0; i < rows; ++i) {
    const Vector3d curvature = log.vector("true_curv", i);
    const double k = curvature.norm();
    const double radius = slide ? 1.0 : 1.0 / k;
    out["true_speed"][i] = log["true_opening_rate"][i] * radius;
    out["opening"][i] = log["true_opening"][i] * (slide ? 1.0 : kDegrees);
    out["heading_error"][i] = kDegrees * log["heading_error"][i];
    if (!(k > kStraight)) continue;
    const Vector3d centre = log.vector("true_handle", i) + curvature.cross(log.vector("true_dir", i)) / (k * k);
    out["centre_x"][i] = centre.x();
    out["centre_y"][i] = centre.y();
  }
}

void copy_columns(const Columns& log, Derived& out) {
  constexpr std::array kCopies{std::array{"base_x", "true_base_x"},
                               std::array{"base_y", "true_base_y"},
                               std::array{"base_yaw", "true_base_yaw"},
                               std::array{"hand_x", "true_hand_x"},
                               std::array{"hand_y", "true_hand_y"},
                               std::array{"handle_x", "true_handle_x"},
                               std::array{"handle_y", "true_handle_y"},
                               std::array{"true_q", "true_opening"},
                               std::array{"distance", "distance"},
                               std::array{"sigma_min", "sigma_min"},
                               std::array{"base_v", "base_v"},
                               std::array{"base_w", "base_w"},
                               std::array{"cmd_v", "cmd_v"},
                               std::array{"cmd_w", "cmd_w"},
                               std::array{"wanted_speed", "wanted_speed"},
                               std::array{"speed_factor", "speed_factor"}};
  for (const auto& [to, from] : kCopies) out[to] = log[from];
}

/// Rows to show: of each bucket the first, the one with the largest force (peaks must not get lost), and every change of
/// phase.
std::vector<std::size_t> choose_rows(const Column& force, const std::vector<std::string>& phases, int points) {
  const std::size_t rows = phases.size();
  std::vector<std::size_t> chosen;
  const auto buckets = static_cast<std::size_t>(std::max(1, points / 2 - 20));
  const std::size_t size = std::max<std::size_t>(1, (rows + buckets - 1) / buckets);
  for (std::size_t begin = 0; begin < rows; begin += size) {
    std::size_t peak = begin;
    for (std::size_t i = begin; i < std::min(rows, begin + size); ++i) {
      if (force[i] > force[peak]) peak = i;
    }
    chosen.push_back(begin);
    if (peak != begin) chosen.push_back(peak);
  }
  std::size_t changes = 0;
  for (std::size_t i = 1; i < rows && changes < 18; ++i) {
    if (phases[i] == phases[i - 1]) continue;
    chosen.push_back(i);
    ++changes;
  }
  if (rows > 0) chosen.push_back(rows - 1);
  std::sort(chosen.begin(), chosen.end());
  chosen.erase(std::unique(chosen.begin(), chosen.end()), chosen.end());
  return chosen;
}

Column pick(const Column& values, const std::vector<std::size_t>& rows) {
  Column out;
  out.reserve(rows.size());
  for (const std::size_t row : rows) out.push_back(values[row]);
  return out;
}

}  // namespace

RunSeries read_run_series(const std::filesystem::path& file, bool slide, int points) {
  const Columns log(read_csv(file, wanted_columns()));
  const CsvTable& table = log.table();
  if (table.texts.count("phase") == 0 || table.numbers.count("time") == 0) {
    throw IoError(file.string() + ":1: not a log of a run: columns time and phase are needed");
  }
  Derived derived;
  copy_columns(log, derived);
  derive_forces(log, derived);
  derive_estimate(log, slide, derived);
  derive_motion(log, slide, derived);
  RunSeries run;
  run.cut_off = table.cut_off;
  while (run.joints < kMaxJoints && table.numbers.count("cmd_dq" + std::to_string(run.joints + 1)) > 0) {
    ++run.joints;
    derived["dq" + std::to_string(run.joints)] = log["cmd_dq" + std::to_string(run.joints)];
  }
  const auto& phases = table.texts.at("phase");
  const std::vector<std::size_t> rows = choose_rows(derived.at("normal_true"), phases, points);
  run.time = pick(log["time"], rows);
  for (const auto& [name, values] : derived) run.series[name] = pick(values, rows);
  for (const std::size_t row : rows) {
    const auto found = std::find(run.phase_names.begin(), run.phase_names.end(), phases[row]);
    run.phase.push_back(static_cast<int>(found - run.phase_names.begin()));
    if (found == run.phase_names.end()) run.phase_names.push_back(phases[row]);
  }
  return run;
}

}  // namespace ajar
