#pragma once

#include <string>
#include <vector>

#include "ajar/core/types.hpp"

namespace ajar {

/// One sample of a recorded path of a handle or of the hand on it.
struct TrackSample {
  double time = 0.0;                         ///< 0 without times [s]
  Vector3d position = Vector3d::Zero();      ///< [m]
  Matrix3d rotation = Matrix3d::Identity();  ///< Hand to world, identity without orientations [-]
  Vector3d force = Vector3d::Zero();         ///< Robot on handle, world axes, zero without forces [N]
};

/// A recorded path, in the order of recording; samples need not be equally spaced.
struct Track {
  std::vector<TrackSample> samples;
  bool has_time = false;
  bool has_rotation = false;
  bool has_force = false;
};

/// Reads a track: numbers in columns, separated by blanks, commas or semicolons; lines that begin with # are left out.
///
/// With a header the columns are known by name (time, x y z, qx qy qz qw, fx fy fz, or the names of a run's log.csv, of
/// which the rows of phase `open` are taken), others are ignored. Without one their number tells: 3 position, 4 time and
/// position, 6 position and force, 7 position and quaternion (x y z w), 8 the same with time, 10 pose and force, 11 with
/// time.
///
/// @throws IoError when the file cannot be read, ConfigError with file and line for bad contents: numbers that are not
/// finite, lines of different length, times that go back, quaternions that are not unit Set-up only.
[[nodiscard]] Track load_track(const std::string& path);

}  // namespace ajar
