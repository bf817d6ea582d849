#include "run_series.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "ajar/core/error.hpp"
#include "log_columns.hpp"
#include "thinning.hpp"

namespace ajar {
namespace {

constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
constexpr double kDegrees = 180.0 / std::numbers::pi;
constexpr double kForceWindow = 0.020;  ///< Forces are shown as they are judged: mean over 20 ms [s]

using Column = LogColumns::Column;
using Derived = std::map<std::string, Column>;

/// Columns that are shown as the log has them: name on the page, name in the log.
constexpr std::array kCopies{std::array{"base_x", "true_base_x"},
                             std::array{"base_y", "true_base_y"},
                             std::array{"base_yaw", "true_base_yaw"},
                             std::array{"hand_x", "true_hand_x"},
                             std::array{"hand_y", "true_hand_y"},
                             std::array{"hand_z", "true_hand_z"},
                             std::array{"handle_x", "true_handle_x"},
                             std::array{"handle_y", "true_handle_y"},
                             std::array{"handle_z", "true_handle_z"},
                             std::array{"force_x", "true_force_x"},
                             std::array{"force_y", "true_force_y"},
                             std::array{"force_z", "true_force_z"},
                             std::array{"opening_q", "true_opening"},
                             std::array{"grasped", "true_grasped"},
                             std::array{"distance", "distance"},
                             std::array{"sigma_min", "sigma_min"},
                             std::array{"base_v", "base_v"},
                             std::array{"base_w", "base_w"},
                             std::array{"cmd_v", "cmd_v"},
                             std::array{"cmd_w", "cmd_w"},
                             std::array{"wanted_speed", "wanted_speed"},
                             std::array{"speed_factor", "speed_factor"},
                             std::array{"clearance_min", "clearance_min"}};

/// Further columns that curves are derived from.
constexpr std::array kSources{"time",    "heading_error", "est_dir_sigma",   "est_curv_sigma",
                              "est_arc", "est_angle",     "est_angle_sigma", "true_opening_rate"};

CsvColumns wanted_columns() {
  CsvColumns wanted;
  wanted.texts = {"phase"};
  for (const auto& copy : kCopies) wanted.numbers.emplace_back(copy[1]);
  for (const char* name : kSources) wanted.numbers.emplace_back(name);
  for (const char* vector : {"force", "est_dir", "est_curv", "true_dir", "true_curv"}) {
    for (const char* axis : {"_x", "_y", "_z"}) wanted.numbers.push_back(std::string(vector) + axis);
  }
  for (const char* quaternion : {"hand_q", "true_hand_q"}) {
    for (const char* part : {"w", "x", "y", "z"}) wanted.numbers.push_back(std::string(quaternion) + part);
  }
  for (int i = 1; i <= kMaxJoints; ++i) {
    wanted.numbers.push_back(std::string("cmd_dq").append(std::to_string(i)));
    wanted.numbers.push_back(std::string("q").append(std::to_string(i)));
  }
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

/// Phases in which the estimate means something, and those in which the sensor is zeroed and touches something.
bool has_estimate(const std::string& phase) { return phase == "probe" || phase == "open"; }
bool has_force(const std::string& phase) { return has_estimate(phase) || phase == "grasp" || phase == "release"; }

/// Force across and along a direction, as a mean over the window of the judge.
void derive_force(const VectorColumns& force, const VectorColumns& direction, std::size_t samples, Column& normal,
                  Column& pull) {
  for (std::size_t i = 0; i < normal.size(); ++i) {
    pull[i] = direction[i].dot(force[i]);
    normal[i] = (force[i] - pull[i] * direction[i]).norm();
  }
  normal = moving_mean(normal, samples);
  pull = moving_mean(pull, samples);
}

void derive_forces(const LogColumns& log, Derived& out) {
  const std::size_t rows = log.rows();
  const Column& time = log["time"];
  const double period = rows > 1 ? (time.back() - time.front()) / static_cast<double>(rows - 1) : kForceWindow;
  const auto samples = static_cast<std::size_t>(std::lround(std::clamp(kForceWindow / std::max(period, 1e-6), 1.0, 100.0)));
  for (const char* name : {"normal_true", "pull_true", "normal_measured", "pull_measured"}) out[name].assign(rows, kNothing);
  derive_force({log, "true_force"}, {log, "true_dir"}, samples, out["normal_true"], out["pull_true"]);
  Column &normal = out["normal_measured"], &pull = out["pull_measured"];
  derive_force({log, "force"}, {log, "est_dir"}, samples, normal, pull);
  for (std::size_t i = 0; i < rows; ++i) {
    if (!has_force(log.phases()[i])) normal[i] = pull[i] = kNothing;
  }
}

void put(Derived& out, const std::string& name, std::size_t i, const Vector3d& v) {
  out[name + "_x"][i] = v.x();
  out[name + "_y"][i] = v.y();
  out[name + "_z"][i] = v.z();
}

void derive_estimate(const LogColumns& log, bool slide, Derived& out) {
  const std::size_t rows = log.rows();
  for (const char* name :
       {"direction_error", "direction_2sigma", "curvature_estimated", "curvature_2sigma", "opening_estimated",
        "opening_2sigma", "est_dir_x", "est_dir_y", "est_dir_z", "est_curv_x", "est_curv_y", "est_curv_z"}) {
    out[name].assign(rows, kNothing);
  }
  Column& error = out["direction_error"];
  const VectorColumns est_dir(log, "est_dir"), est_curv(log, "est_curv"), true_dir(log, "true_dir");
  const TurnColumns hand(log, "hand_q"), true_hand(log, "true_hand_q");
  for (std::size_t i = 0; i < rows; ++i) {
    if (!has_estimate(log.phases()[i])) continue;
    // As it is judged: turned so that the believed hand lies on the true one, whatever frame the robot believes in.
    const Eigen::Quaterniond turn = true_hand[i] * hand[i].conjugate();
    const Vector3d direction = turn * est_dir[i], truth = true_dir[i];
    error[i] = kDegrees * std::atan2(direction.cross(truth).norm(), direction.dot(truth));
    put(out, "est_dir", i, direction);
    put(out, "est_curv", i, turn * est_curv[i]);
    out["direction_2sigma"][i] = 2.0 * kDegrees * log["est_dir_sigma"][i];
    out["curvature_estimated"][i] = est_curv[i].norm();
    out["curvature_2sigma"][i] = 2.0 * log["est_curv_sigma"][i];
    out["opening_estimated"][i] = slide ? log["est_arc"][i] : kDegrees * log["est_angle"][i];
    if (!slide) out["opening_2sigma"][i] = 2.0 * kDegrees * log["est_angle_sigma"][i];
  }
}

void derive_motion(const LogColumns& log, bool slide, Derived& out) {
  const std::size_t rows = log.rows();
  const VectorColumns curvature(log, "true_curv");
  const Column &rate = log["true_opening_rate"], &opening = log["true_opening"], &heading = log["heading_error"];
  Column k(rows), speed(rows), shown(rows), error(rows);
  for (std::size_t i = 0; i < rows; ++i) {
    k[i] = curvature[i].norm();
    speed[i] = rate[i] * (slide ? 1.0 : 1.0 / k[i]);
    shown[i] = opening[i] * (slide ? 1.0 : kDegrees);
    error[i] = kDegrees * heading[i];
  }
  out["curvature_true"] = std::move(k);
  out["true_speed"] = std::move(speed);
  out["opening"] = std::move(shown);
  out["heading_error"] = std::move(error);
}

void copy_columns(const LogColumns& log, RunSeries& run, Derived& out) {
  for (const auto& [to, from] : kCopies) out[to] = log[from];
  while (run.joints < kMaxJoints && log.has("cmd_dq" + std::to_string(run.joints + 1))) {
    const std::string number = std::to_string(++run.joints);
    out["dq" + number] = log["cmd_dq" + number];
    out["q" + number] = log["q" + number];
  }
}

/// Times of the control ticks, row by row as the log; a run without that file has none.
void read_ticks(const std::filesystem::path& file, std::size_t rows, Derived& out) {
  std::error_code missing;
  if (!std::filesystem::exists(file, missing)) return;
  CsvTable table = read_csv(file, {{"tick_us"}, {}});
  Column ticks = std::move(table.numbers["tick_us"]);
  ticks.resize(rows, kNothing);
  out["tick_us"] = std::move(ticks);
}

void number_phases(const std::vector<std::string>& phases, RunSeries& run, Column& out) {
  for (const std::string& phase : phases) {
    auto found = std::find(run.phase_names.begin(), run.phase_names.end(), phase);
    if (found == run.phase_names.end()) found = run.phase_names.insert(found, phase);
    out.push_back(static_cast<double>(found - run.phase_names.begin()));
  }
}

Column pick(const Column& values, const std::vector<std::size_t>& rows) {
  Column out;
  out.reserve(rows.size());
  for (const std::size_t row : rows) out.push_back(values[row]);
  return out;
}

}  // namespace

RunSeries read_run_series(const std::filesystem::path& folder, bool slide, double period) {
  const std::filesystem::path file = folder / "log.csv";
  const LogColumns log(read_csv(file, wanted_columns()));
  if (log.table().texts.count("phase") == 0 || !log.has("time")) {
    throw IoError(file.string() + ":1: not a log of a run: columns time and phase are needed");
  }
  RunSeries run;
  run.cut_off = log.table().cut_off;
  run.rows = log.rows();
  Derived derived;
  copy_columns(log, run, derived);
  derive_forces(log, derived);
  derive_estimate(log, slide, derived);
  derive_motion(log, slide, derived);
  read_ticks(folder / "ticks.csv", log.rows(), derived);
  number_phases(log.phases(), run, derived["phase"]);
  ThinningInput thinning{log["time"], log.phases(), {&derived["normal_true"], &derived["pull_true"]}, {}};
  if (derived.count("tick_us") > 0) thinning.peaked.push_back(&derived["tick_us"]);
  for (const auto& [name, values] : derived) thinning.ranged.push_back(&values);
  const std::vector<std::size_t> rows = choose_rows(thinning, period);
  run.time = pick(log["time"], rows);
  for (const auto& [name, values] : derived) run.series[name] = pick(values, rows);
  return run;
}

}  // namespace ajar
