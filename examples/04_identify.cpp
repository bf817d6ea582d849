// What mechanism is behind a recorded path? A drawer front drawn out over 30 cm, seen with 1 mm of noise and one glitch.
#include <cstdio>

#include "ajar/core/random.hpp"
#include "ajar/estimation/identify.hpp"

using namespace ajar;

int main() {
  Random random(1);
  Track track;  // or load_track("drawer.csv")
  for (double s = 0.0; s < 0.3; s += 0.002) {
    track.samples.push_back({.position = Vector3d(0.5 - s, 0.1, 0.8) + random.normal3(0.001)});
  }
  track.samples[60].position.y() += 0.08;
  const Identification found = identify(track);
  const Vector3d& x = found.direction;
  std::printf("%s, direction (%.3f, %.3f, %.3f) ± %.1f°, radius more than %.1f m, %d outlier\n",
              found.type == MechanismType::Slide ? "slide" : "not a slide", x.x(), x.y(), x.z(),
              57.3 * found.direction_sigma, found.radius_min, found.outliers);
  return found.type == MechanismType::Slide && found.outliers == 1 ? 0 : 1;
}
