#pragma once

// Heron at a regular posture, and problems built on it.

#include <gtest/gtest.h>

#include "ajar/wbc/whole_body_controller.hpp"

namespace ajar::test {

inline constexpr double kPeriod = 0.002;
inline constexpr int kSpeed = 7;  // index of v with six joints
inline constexpr int kTurn = 6;

class HeronWbc : public ::testing::Test {
 protected:
  HeronWbc() { place({}, posture()); }

  // Hand 0.8 m above the floor ahead of the base, elbow up: regular (σ_min > 0.1).
  static JointVector posture() {
    JointVector q(6);
    q << 1.54, -1.6, 2.0, -2.0, -1.57, 0.3;
    return q;
  }

  void place(const BasePose& base, const JointVector& joints) {
    base_pose = base;
    q = joints;
    model.compute(base, q, kinematics);
  }

  WbcProblem problem() {
    WbcProblem p;
    p.kinematics = &kinematics;
    p.q = &q;
    return p;
  }

  // Command at the standstill of a constant problem: all acceleration limits have been left behind.
  WbcSolution settle(WholeBodyController& wbc, const WbcProblem& p, int ticks = 1500) {
    WbcSolution out;
    for (int tick = 0; tick < ticks; ++tick) {
      (void)wbc.solve(p, out);
    }
    return out;
  }

  RobotModel model = load_robot("heron");
  WbcConfig config;
  BasePose base_pose;
  JointVector q;
  Kinematics kinematics;
};

// One row that the base's forward motion closes at 1 m per m.
inline ClearanceResult wall_ahead(double distance, ClearanceKind kind, int obstacle) {
  ClearanceResult clearance;
  clearance.count = 1;
  clearance.rows[0].row = InputRow::Zero(1, 8);
  clearance.rows[0].row[kSpeed] = -1.0;
  clearance.rows[0].distance = distance;
  clearance.rows[0].kind = kind;
  clearance.rows[0].obstacle = obstacle;
  clearance.rows[0].normal = -Vector3d::UnitX();
  return clearance;
}

}  // namespace ajar::test
