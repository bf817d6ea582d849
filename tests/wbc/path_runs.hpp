#pragma once

// A hand that follows a straight line or an arc by the whole-body controller, integrated exactly: any robot, base by its
// law.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "ajar/core/so3.hpp"
#include "ajar/wbc/base_law.hpp"
#include "ajar/wbc/input_limits.hpp"
#include "ajar/wbc/whole_body_controller.hpp"

namespace ajar::test {

struct HandPath {
  Vector3d direction = Vector3d::UnitX();  // at the start, unit
  Vector3d curvature = Vector3d::Zero();   // axis over radius, at a right angle to the direction
  double length = 0.5;                     // [m]

  // The start pose carried along by the mechanism.
  [[nodiscard]] Pose at(const Pose& start, double s) const {
    const Matrix3d turned = exp_so3(s * curvature);
    Pose X = Pose::Identity();
    X.linear() = turned * start.linear();
    if (curvature.norm() < 1e-9) {
      X.translation() = start.translation() + s * direction;
    } else {
      const Vector3d axis = start.translation() + curvature.cross(direction) / curvature.squaredNorm();
      X.translation() = axis + turned * (start.translation() - axis);
    }
    return X;
  }
};

struct PathRun {
  double path_error = 0.0;    // largest distance from the path [m]
  double turn_error = 0.0;    // largest rotation from the wanted one [rad]
  double least_factor = 1.0;  // of the speed, once it has been reached
  double least_sigma = 1e9;
  double limit_excess = 0.0;  // of any rate or acceleration
  double late = 0.0;          // duration over that of a run that no limit slows [-]
  double arc = 0.0;           // way made [m]
  double distance = 0.0;      // largest difference from the wanted distance after the first 20 cm [m]
  double heading = 0.0;       // largest heading error in the second half [rad]
  bool invalid = false;
};

// Exact priorities: nothing but limits slows the hand, nothing moves it off its path.
inline WbcConfig exact_config() {
  WbcConfig config;
  config.hand_weight = 1e8;
  config.speed_weight = 1e4;
  config.slack_weight = 1e10;
  config.base_acceleration = config.base_yaw_acceleration = 10.0;  // as hard as the robot itself allows
  return config;
}

// Hand level, z ahead, at a height and as far ahead of the base as the arm allows between 0.5 and 0.8 m.
inline bool find_posture(const RobotModel& model, double height, JointVector& q) {
  std::mt19937_64 rng(17);
  Pose X = Pose::Identity();
  X.linear() << 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, -1.0, 0.0, 0.0;
  double best = 0.05;  // a start nearer to singular is no start
  for (const double ahead : {0.8, 0.7, 0.6, 0.5}) {
    X.translation() = Vector3d(ahead, 0.0, height);
    for (int attempt = 0; attempt < 30; ++attempt) {
      JointVector trial = model.home();
      for (int i = 0; i < trial.size(); ++i) trial[i] += attempt == 0 ? 0.0 : std::uniform_real_distribution(-1.5, 1.5)(rng);
      if (!model.solve_ik({}, X, trial)) continue;
      Kinematics k;
      model.compute({}, trial, k);
      if (const double sigma = arm_sigma_min(k); sigma > best) {
        best = sigma;
        q = trial;
      }
    }
    if (best > 0.05) return true;
  }
  return false;
}

inline PathRun follow(const RobotModel& model, BasePose base, JointVector q, const HandPath& path, double speed,
                      const BaseLawConfig& law = {}, const WbcConfig& config = exact_config()) {
  constexpr double kDt = 0.002;
  const int n = model.joints();
  const InputLimits limits = make_input_limits(model, config, kDt);
  WholeBodyController wbc(model, config, kDt);
  BaseLaw base_law(law);
  Kinematics kinematics;
  model.compute(base, q, kinematics);
  const Pose start = kinematics.X_WE;
  base_law.reset(base, start.translation());
  PathRun run;
  WbcSolution out;
  InputVector last = InputVector::Zero(n + 2);
  const int ticks = static_cast<int>(4.0 * path.length / (speed * kDt));
  for (int tick = 0; tick < ticks && run.arc < path.length; ++tick) {
    const Matrix3d turned = exp_so3(run.arc * path.curvature);
    const Pose wanted = path.at(start, run.arc);
    const double ramp = std::min(speed, 0.1 * tick * kDt);
    WbcProblem p;
    p.kinematics = &kinematics;
    p.q = &q;
    p.tangential << ramp * (turned * path.direction), ramp * path.curvature;
    p.correction << 2.0 * (wanted.translation() - kinematics.X_WE.translation()),
        2.0 * log_so3(wanted.linear() * kinematics.X_WE.linear().transpose());
    BaseLawInput in;
    in.dt = kDt;
    in.base = base;
    in.hand = kinematics.X_WE.translation();
    in.direction = turned * path.direction;
    in.curvature = path.curvature;
    in.wanted_speed = ramp;
    in.measured_speed = out.speed_factor * ramp;
    in.confidence = 1.0;
    const BaseLawOutput wanted_base = base_law.step(in);
    p.base = wanted_base.twist;
    if (run.arc > 0.2) run.distance = std::max(run.distance, std::abs(kinematics.distance - law.distance));
    if (run.arc > 0.5 * path.length) run.heading = std::max(run.heading, std::abs(wanted_base.heading_error));
    run.invalid = run.invalid || wbc.solve(p, out) == WbcStatus::Invalid;
    const double over = std::max((out.u - limits.speed_upper).maxCoeff(), (limits.speed_lower - out.u).maxCoeff());
    const double jump = ((out.u - last).cwiseAbs() - kDt * limits.acceleration).head(n).maxCoeff();
    run.limit_excess = std::max({run.limit_excess, over, jump});
    last = out.u;
    q += kDt * out.u.head(n);
    base = integrate_base(base, out.u[n + 1], out.u[n], kDt);
    run.arc += kDt * out.speed_factor * ramp;
    model.compute(base, q, kinematics);
    const Pose on_path = path.at(start, run.arc);
    run.path_error = std::max(run.path_error, (kinematics.X_WE.translation() - on_path.translation()).norm());
    run.turn_error = std::max(run.turn_error, log_so3(on_path.linear() * kinematics.X_WE.linear().transpose()).norm());
    if (tick * kDt > 1.5) run.least_factor = std::min(run.least_factor, out.speed_factor);
    run.least_sigma = std::min(run.least_sigma, out.sigma_min);
    run.late = (tick + 1) * kDt / (path.length / speed + 0.5 * speed / 0.1);
  }
  return run;
}

}  // namespace ajar::test
