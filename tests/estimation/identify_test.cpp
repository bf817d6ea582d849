// Strategy: tracks made from circles and lines that are known exactly, with white and correlated noise, outliers, rest at
// the ends and a way back; type, axis, point, radius and direction against that truth, and the stated errors against the
// errors made. Recordings of real furniture are judged by `./dev bench estimation`; here they are only read where they are
// at hand.
#include "ajar/estimation/identify.hpp"

#include <gtest/gtest.h>

#include <array>

#include "ajar/core/error.hpp"
#include "tracks.hpp"

namespace ajar {
namespace {

using test::kDegree;

struct Recording {
  double radius = 0.4;  // 0: slide
  double length = 0.5;  // of path [m]
  double spacing = 2e-3;
  int rest = 0;           // samples at either end
  double outliers = 0.0;  // share of samples that are 3-8 cm off
  bool back = false;      // and the same way back
  double follow = -1.0;   // share of the turning that the hand follows; below 0: no orientation
};

PoseNoise camera_noise() {
  PoseNoise noise;
  noise.position_white = 0.5e-3;
  noise.position_correlated = 1e-3;
  noise.correlation_length = 0.05;
  return noise;
}

Track record(const Recording& recording, const test::TruePath& path, const PoseNoise& noise, Random& rng) {
  test::Measured measured(path, noise, rng);
  Track track;
  track.has_rotation = recording.follow >= 0.0;
  const auto add = [&](double s) {
    const PathSample sample = measured.at(s, std::max(recording.follow, 0.0));
    TrackSample taken;
    taken.position = sample.position;
    if (track.has_rotation) taken.rotation = sample.rotation;
    if (rng.chance(recording.outliers)) taken.position += rng.uniform(0.03, 0.08) * rng.direction();
    track.samples.push_back(taken);
  };
  for (int i = 0; i < recording.rest; ++i) add(0.0);
  for (double s = 0.0; s < recording.length; s += recording.spacing) add(s);
  for (int i = 0; i < recording.rest; ++i) add(recording.length);
  for (double s = recording.length; recording.back && s > 0.0; s -= recording.spacing) add(s);
  return track;
}

double angle_between(const Vector3d& a, const Vector3d& b) { return std::atan2(a.cross(b).norm(), a.dot(b)); }

TEST(Identify, FindsHingesAndSlidesAndStatesHowWell) {
  Random rng(31);
  int inside = 0;
  int figures = 0;
  for (int run = 0; run < 60; ++run) {
    Recording recording;
    recording.radius = std::array{0.3, 0.8, 0.0}[static_cast<std::size_t>(run % 3)];
    recording.rest = run % 2 == 0 ? 150 : 0;
    recording.outliers = run % 4 < 2 ? 0.0 : 0.1;
    recording.back = run % 5 == 0;
    const test::TruePath path = test::random_path(recording.radius, rng);
    const Identification found = identify(record(recording, path, camera_noise(), rng));
    SCOPED_TRACE(::testing::Message() << "run " << run << ", radius " << recording.radius << ", halves "
                                      << found.half_curvature[0] << " " << found.half_curvature[1] << ", evidence "
                                      << found.against_slide << " " << found.against_hinge << " " << found.against_one_curve
                                      << " " << found.explained);
    EXPECT_EQ(found.type, recording.radius > 0.0 ? MechanismType::Hinge : MechanismType::Slide);
    const auto count = [&](double error, double sigma) {
      inside += error < 2.0 * sigma ? 1 : 0;
      ++figures;
    };
    count((found.curvature - path.k()).norm(), found.curvature_noise_sigma);
    count(angle_between(found.direction, path.direction(0.0)), found.direction_sigma);
    EXPECT_LT(found.radius_min, recording.radius > 0.0 ? recording.radius : 1e9);
    if (recording.radius > 0.0) {
      EXPECT_NEAR(found.radius, recording.radius, 0.1 * recording.radius);
      const Vector3d k = path.k();
      const Vector3d centre = path.origin + k.cross(path.F.col(0)) / k.squaredNorm();
      count(angle_between(found.axis, k), found.axis_sigma);
      count((found.point - centre).norm(), found.point_sigma);
    }
    if (recording.outliers > 0.0) {
      EXPECT_NEAR(found.outliers, recording.outliers * found.samples, 0.06 * found.samples);
    }
    EXPECT_LT(found.rms, 3e-3);
  }
  EXPECT_GE(inside, static_cast<int>(0.85 * figures));
}

TEST(Identify, UsesAHandThatTurnsWithTheMechanismAndDropsOneThatDoesNot) {
  Random rng(32);
  for (int run = 0; run < 8; ++run) {
    Recording recording{.radius = 0.5, .length = 0.3, .follow = run % 2 == 0 ? 1.0 : 0.0};
    const test::TruePath path = test::random_path(recording.radius, rng);
    const Track track = record(recording, path, PoseNoise(), rng);
    const Identification found = identify(track, {.sensor = SensorKind::Robot});
    EXPECT_EQ(found.uses_rotation, recording.follow > 0.5);
    EXPECT_EQ(found.type, MechanismType::Hinge);
    EXPECT_LT((found.curvature - path.k()).norm(), 4.0 * found.curvature_noise_sigma);
  }
}

TEST(Identify, TakesTheStretchOfTheGraspOffWhereForcesAreRecorded) {
  // A drawer pulled with a force that grows to 40 N across its motion: the hand drifts 4 mm, the handle does not.
  Random rng(33);
  Track track;
  track.has_force = true;
  for (double s = 0.0; s < 0.4; s += 0.002) {
    TrackSample sample;
    sample.force = Vector3d(0.0, 250.0 * s * s, 0.0);
    sample.position = Vector3d(s, 0.0, 0.0) + sample.force / 1e4 + rng.normal3(2e-4);
    track.samples.push_back(sample);
  }
  EXPECT_EQ(identify(track, {.sensor = SensorKind::Robot}).type, MechanismType::Slide);
  for (TrackSample& sample : track.samples) sample.force.setZero();
  EXPECT_GT(identify(track, {.sensor = SensorKind::Robot}).curvature.norm(), 0.04);
}

TEST(Identify, KeepsAWayBackBesideTheWayOutAndDropsSingleGlitches) {
  // A slide out by 30 cm and back by 10 cm, 4 mm beside it; on the way out six samples are 6 mm off.
  Track track;
  for (int i = 0; i < 400; ++i) {
    const bool back = i >= 300;
    const double s = 0.001 * (back ? 599 - i : i);
    const double wiggle = 0.2e-3 * std::sin(0.7 * i);
    const bool glitch = !back && i % 50 == 20;
    track.samples.push_back({.position = Vector3d(s, back ? 0.004 : 0.0, wiggle + (glitch ? 0.006 : 0.0))});
  }
  const Identification found = identify(track);
  EXPECT_EQ(found.outliers, 6);
  EXPECT_FALSE(found.inlier[120]);
  EXPECT_TRUE(found.inlier[350]);
}

TEST(Identify, CallsAPathOfTwoMechanismsUnknown) {
  // 20 cm straight on; then round a corner for as much, or along an arc of 20 cm radius.
  for (const bool corner : {true, false}) {
    Random rng(34);
    Track track;
    for (double s = 0.0; s < 0.4; s += 0.002) {
      const double on = std::max(0.0, s - 0.2);
      const Vector3d turned = 0.2 * Vector3d(std::sin(on / 0.2), 1.0 - std::cos(on / 0.2), 0.0);
      TrackSample sample;
      sample.position = Vector3d(std::min(s, 0.2), 0.0, 0.0) + (corner ? Vector3d(on * Vector3d::UnitY()) : turned);
      sample.position += rng.normal3(3e-4);
      track.samples.push_back(sample);
    }
    const Identification found = identify(track);
    EXPECT_EQ(found.type, MechanismType::Unknown) << found.against_one_curve << ", " << found.explained;
  }
}

TEST(Identify, ReturnsAPathThatPassesThroughItsStart) {
  Random rng(35);
  const test::TruePath path = test::random_path(0.4, rng);
  const Identification found = identify(record({}, path, camera_noise(), rng));
  EXPECT_LT((found.at(0.0) - found.start).norm(), 1e-12);
  EXPECT_LT((found.at(0.3) - path.position(0.3)).norm(), 6e-3);
  EXPECT_NEAR((found.at(0.3) - found.point).norm(), found.radius, 1e-9);
}

TEST(Identify, RefusesTracksThatHoldNothing) {
  Track track;
  track.samples.resize(5);
  EXPECT_THROW((void)identify(track), ConfigError);
  track.samples.resize(50);
  EXPECT_THROW((void)identify(track), ConfigError);  // all at one point
  for (std::size_t i = 0; i < track.samples.size(); ++i) track.samples[i].position.x() = 0.01 * static_cast<double>(i);
  EXPECT_EQ(identify(track).type, MechanismType::Slide);  // exact data, no noise at all
  track.samples[7].position.y() = std::nan("");
  EXPECT_THROW((void)identify(track), ConfigError);
  EXPECT_THROW((void)identify(Track{}), ConfigError);
  track.samples[7].position.y() = 0.0;
  EXPECT_THROW((void)identify(track, {.grasp_stiffness = 0.0}), ConfigError);
}

}  // namespace
}  // namespace ajar
