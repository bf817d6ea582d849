#pragma once

#include <algorithm>
#include <cmath>

#include "ajar/estimation/mechanism_estimator.hpp"
#include "tracks.hpp"

namespace ajar::test {

/// How a handle is pulled.
struct Pull {
  double radius = 0.6;       ///< 0 for a slide [m]
  double guess_error = 0.0;  ///< Of the direction, about a random axis [rad]
  double stiffness = 1e4;    ///< Of the grasp [N/m]
  double resistance = 10.0;  ///< Friction at the handle [N]
  double speed = 0.1;        ///< Cruise [m/s]
  double follow = 1.0;       ///< Share of the turning that the hand follows
  double dt = 0.002;         ///< [s]
  double length = 0.45;      ///< Arc at which the run ends [m]
  double base_gain = 0.0;    ///< Base travel per handle travel [-]
};

/// A handle on a true path behind a grasp spring, quasi-static with friction; the hand is moved by the force/velocity law
/// with the estimator's own direction. Sensors: pose errors of the noise model, 0.4 N force noise and 0.5 N bias.
class PulledHandle {
 public:
  PulledHandle(const Pull& pull, const EstimatorConfig& config, Random& rng)
      : estimator(config),
        path(random_path(pull.radius, rng)),
        pull_(pull),
        rng_(rng),
        measured_(path, config.noise, rng),
        hand_(path.origin),
        bias_(0.5 * rng.direction()) {
    Vector3d axis = rng.direction();
    axis = (axis - path.F.col(0) * path.F.col(0).dot(axis)).normalized();
    Pose pose = Pose::Identity();
    pose.translation() = hand_;
    pose.linear() = path.grasp;
    estimator.reset(pose, exp_so3(pull.guess_error * axis) * path.F.col(0));
  }

  /// One tick; returns the estimator's status.
  EstimatorStatus step() {
    const Vector3d x = estimator.estimate().direction;
    const Vector3d t = path.direction(s);
    const Vector3d e = hand_ - path.position(s);
    s += std::max(0.0, e.dot(t) - pull_.resistance / pull_.stiffness);  // slides on once friction is overcome
    force = pull_.stiffness * (hand_ - path.position(s));
    normal_force = (force - t * t.dot(force)).norm();

    EstimatorInput input;
    input.dt = pull_.dt;
    const PathSample noisy = measured_.at(s, pull_.follow);
    input.hand.translation() = hand_ + (noisy.position - path.position(s));
    input.hand.linear() = noisy.rotation;
    input.velocity = velocity_;
    input.force = force + bias_ + rng_.normal3(0.4);
    input.base_travel = pull_.base_gain * std::abs(x.dot(velocity_)) * pull_.dt;
    Vector3d fp = input.force - x * x.dot(input.force);
    fp *= std::max(0.0, fp.norm() - 0.5) / std::max(fp.norm(), 1e-9);
    Vector3d vf = 2e-3 * fp + 0.7e-3 * integral_;
    if (vf.norm() < 0.06) {
      integral_ += pull_.dt * fp;
    } else {
      vf *= 0.06 / vf.norm();
    }
    integral_ -= x * x.dot(integral_);
    input.normal_correction = vf - x * x.dot(vf);
    const EstimatorStatus status = estimator.update(input);

    const double ramp = std::clamp((estimator.estimate().arc - 0.015) / 0.045, 0.0, 1.0);
    velocity_ = (0.02 + (pull_.speed - 0.02) * ramp) * estimator.estimate().direction - input.normal_correction;
    hand_ += pull_.dt * velocity_;
    return status;
  }

  [[nodiscard]] double direction_error() const {
    const Vector3d& x = estimator.estimate().direction;
    const Vector3d t = path.direction(s);
    return std::atan2(x.cross(t).norm(), x.dot(t));
  }
  [[nodiscard]] double curvature_error() const { return (estimator.estimate().curvature - path.k()).norm(); }

  MechanismEstimator estimator;
  TruePath path;
  double s = 0.0;
  Vector3d force = Vector3d::Zero();
  double normal_force = 0.0;

 private:
  Pull pull_;
  Random& rng_;
  Measured measured_;
  Vector3d hand_;
  Vector3d velocity_ = Vector3d::Zero();
  Vector3d integral_ = Vector3d::Zero();
  Vector3d bias_;
};

}  // namespace ajar::test
