#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "tracks.hpp"

namespace ajar::bench {

/// Runs per cell and the seed of all draws.
struct Effort {
  int runs = 400;
  std::uint64_t seed = 1;
};

inline constexpr std::array kLengths{0.05, 0.1, 0.2, 0.4, 0.8};  // of path at which estimates are judged [m]
inline constexpr double kSpacing = 0.002;                        // 0.1 m/s seen 50 times a second [m]
inline constexpr double kPrior = 3.0;                            // of each component of k, of filter and bound [1/m]
inline constexpr double kMostTurn = 2.05;                        // no door turns further [rad]

/// 0.3 mm + 0.5 mm over 5 cm, 0.1° + 0.2°: the arm with a rigid grasp.
[[nodiscard]] inline PoseNoise robot_noise() {
  PoseNoise noise;
  noise.rotation_white = 0.1 * test::kDegree;
  noise.rotation_correlated = 0.2 * test::kDegree;
  noise.position_walk = noise.rotation_walk = 0.0;
  return noise;
}

/// 1 mm and 0.3°, every sample for itself.
[[nodiscard]] inline PoseNoise white_noise() {
  return {.position_white = 1e-3,
          .position_correlated = 0.0,
          .rotation_white = 0.3 * test::kDegree,
          .rotation_correlated = 0.0,
          .correlation_length = 0.05,
          .position_walk = 0.0,
          .rotation_walk = 0.0};
}

[[nodiscard]] inline PoseNoise scaled(PoseNoise noise, double factor) {
  noise.position_white *= factor;
  noise.position_correlated *= factor;
  noise.rotation_white *= factor;
  noise.rotation_correlated *= factor;
  return noise;
}

/// Sums over the runs of one cell.
struct Tally {
  double direction2 = 0.0;  ///< Squared direction errors [rad²]
  double curvature2 = 0.0;  ///< Squared curvature errors [1/m²]
  double nees = 0.0;        ///< Errors squared over their covariance, four components [-]
  int inside = 0;           ///< Components within 2 σ
  int runs = 0;
  int alarms = 0;

  void add(const Vector4d& error, const Eigen::Matrix4d& C) {
    direction2 += error.head<2>().squaredNorm();
    curvature2 += error.tail<2>().squaredNorm();
    nees += error.dot(C.llt().solve(error));
    for (int i = 0; i < 4; ++i) inside += std::abs(error[i]) < 2.0 * std::sqrt(C(i, i)) ? 1 : 0;
    ++runs;
  }
  [[nodiscard]] double direction() const { return std::sqrt(direction2 / runs); }
  [[nodiscard]] double curvature() const { return std::sqrt(curvature2 / runs); }
  [[nodiscard]] double coverage() const { return inside / (4.0 * runs); }
  [[nodiscard]] double nees_mean() const { return nees / (4.0 * runs); }
};

/// One figure against what it must reach.
struct Row {
  std::string problem;
  std::string contestant;
  double value;
  std::string unit;
  std::string bar;  ///< What is asked, in words; empty: only shown
  bool holds = true;
};

[[nodiscard]] inline double quantile(std::vector<double> values, double p) {
  if (values.empty()) return NAN;
  std::sort(values.begin(), values.end());
  return values[static_cast<std::size_t>(p * static_cast<double>(values.size() - 1) + 0.5)];
}

using Table = std::vector<Row>;

void judge_bound(const Effort& effort, Table& table);     // Monte Carlo against the Cramér-Rao bound
void judge_honesty(const Effort& effort, Table& table);   // wrong noise level, odometry that drifts
void judge_peers(const Effort& effort, Table& table);     // other estimators on the same tracks
void judge_types(const Effort& effort, Table& table);     // arc needed for the type, wrong types
void judge_failures(const Effort& effort, Table& table);  // slips, handles that turn first, grips that pivot
void judge_recordings(Table& table);                      // tracks of real furniture, where they are at hand
void judge_cost(Table& table);                            // time, heap and size of one tick

}  // namespace ajar::bench
