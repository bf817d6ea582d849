#pragma once

#include <cstdint>
#include <random>

#include "ajar/core/types.hpp"

namespace ajar {

/// The one seeded generator of a run, passed down to whoever draws.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in [lower, upper).
  double uniform(double lower, double upper) { return lower + (upper - lower) * unit_(engine_); }
  /// Normal with mean 0.
  double normal(double sigma) { return sigma * normal_(engine_); }
  /// Three independent normals.
  Vector3d normal3(double sigma) {
    const double x = normal(sigma);
    const double y = normal(sigma);
    const double z = normal(sigma);
    return {x, y, z};
  }
  /// True with the given probability.
  bool chance(double probability) { return unit_(engine_) < probability; }
  /// Uniform integer in [0, count).
  int index(int count) { return static_cast<int>(uniform(0.0, 1.0) * count); }
  /// Uniform direction on the sphere.
  Vector3d direction() {
    Vector3d v = normal3(1.0);
    while (v.norm() < 1e-6) v = normal3(1.0);
    return v.normalized();
  }

 private:
  std::mt19937_64 engine_;
  std::uniform_real_distribution<double> unit_{0.0, 1.0};
  std::normal_distribution<double> normal_{0.0, 1.0};
};

}  // namespace ajar
