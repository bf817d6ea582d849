// Learns a hinge from noisy hand poses: no robot, no force, 40 cm of arc.
#include <cmath>
#include <cstdio>

#include "ajar/core/random.hpp"
#include "ajar/core/so3.hpp"
#include "ajar/estimation/mechanism_estimator.hpp"

using namespace ajar;

int main() {
  const double radius = 0.8;  // of the door, upright axis at the origin [m]
  const double speed = 0.1;   // of the handle [m/s]
  Random random(1);
  EstimatorInput input;

  const auto look = [&](double time) {
    const double angle = speed * time / radius;
    input.hand.linear() = exp_so3({0.0, 0.0, angle}) * exp_so3(random.normal3(0.002));
    input.hand.translation() = Vector3d(radius * std::cos(angle), radius * std::sin(angle), 1.0) + random.normal3(0.0005);
    input.velocity = speed * Vector3d(-std::sin(angle), std::cos(angle), 0.0);
  };

  MechanismEstimator estimator{EstimatorConfig{}};
  look(0.0);
  estimator.reset(input.hand, Vector3d(0.4, 0.9, 0.0).normalized());  // a guess that is 24° wrong
  for (int tick = 1; tick <= 2000; ++tick) {
    look(tick * input.dt);
    if (estimator.update(input) == EstimatorStatus::Invalid) return 1;
    if (tick % 250 != 0) continue;
    const MechanismEstimate& e = estimator.estimate();
    const char* const type = e.type == MechanismType::Hinge ? "hinge" : e.type == MechanismType::Slide ? "slide" : "unknown";
    std::printf("%4.0f mm: curvature %6.3f ± %5.3f 1/m, direction ± %5.2f°, %s\n", 1e3 * e.arc, e.curvature.z(),
                e.curvature_sigma, 57.3 * e.direction_sigma, type);
  }
  const MechanismEstimate& e = estimator.estimate();
  const bool learnt = e.type == MechanismType::Hinge && std::abs(e.curvature.z() - 1.0 / radius) < 0.1;
  return learnt ? 0 : 1;
}
