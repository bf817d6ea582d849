#pragma once

// A hand that follows a straight line or an arc by the whole-body controller, integrated exactly: any robot, base by its
// law.

#include <algorithm>
#include <cmath>
#include <numbers>

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
  bool invalid = false;
};

// Exact priorities: nothing but limits slows the hand, nothing moves it off its path.
inline WbcConfig exact_config() {
  WbcConfig config;
  config.hand_weight = 1e8;
  config.speed_weight = 1e4;
  config.slack_weight = 1e10;
  config.base_share = 1.0;                                         // the kinematic base follows at once,
  config.base_acceleration = config.base_yaw_acceleration = 10.0;  // as hard as the robot itself allows
  return config;
}

inline PathRun follow(const RobotModel& model, BasePose base, JointVector q, const HandPath& path, double speed) {
  constexpr double kDt = 0.002;
  const int n = model.joints();
  const WbcConfig config = exact_config();
  const InputLimits limits = make_input_limits(model, config, kDt);
  WholeBodyController wbc(model, config, kDt);
  BaseLaw base_law({});
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
    p.measured = last;
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
    p.base = base_law.step(in).twist;
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
