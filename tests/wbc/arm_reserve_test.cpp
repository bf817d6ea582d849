// Strategy: a hand that must stay where it is while the base wants to turn on and on. The arm can take that back until its
// first joint ends; from there only a base that stands keeps the hand. Left out: paths (whole_body_paths_test).
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "ajar/wbc/input_limits.hpp"
#include "heron_wbc.hpp"

namespace ajar {
namespace {

using test::kPeriod;
using test::kSpeed;
using test::kTurn;

constexpr double kTurning = 0.6;       // wanted of the base [rad/s]
constexpr double kDeceleration = 0.3;  // of its turning [rad/s^2]

struct Hold {
  double path_error = 0.0;  // of the hand [m]
  double slowing = 0.0;     // largest deceleration of the turning [rad/s^2]
  double turned = 0.0;      // by the base in the end [rad]
  double rate = 0.0;        // of the base in the end [rad/s]
  double spare = 0.0;       // what is left to the shoulder's limit in the end [rad]
};

class ArmReserve : public test::HeronWbc {
 protected:
  // Six seconds of a base that wants to turn to the left under a hand that stays.
  Hold turn_away() {
    config.hand_weight = 1e8;
    config.speed_weight = 1e4;
    config.base_yaw_acceleration = kDeceleration;
    config.base_braking = 1.0;
    WholeBodyController wbc(model, config, kPeriod);
    const InputLimits limits = make_input_limits(model, config, kPeriod);
    const Vector3d start = kinematics.X_WE.translation();
    BasePose base;
    WbcSolution out;
    Hold hold;
    for (int tick = 0; tick < 3000; ++tick) {
      WbcProblem p = problem();
      p.base.w = kTurning;
      p.correction.head<3>() = 2.0 * (start - kinematics.X_WE.translation());
      EXPECT_NE(wbc.solve(p, out), WbcStatus::Invalid);
      q += kPeriod * out.u.head(6);
      base = integrate_base(base, out.u[kSpeed], out.u[kTurn], kPeriod);
      place(base, q);
      hold.slowing = std::max(hold.slowing, (hold.rate - out.u[kTurn]) / kPeriod);
      hold.rate = out.u[kTurn];
      hold.path_error = std::max(hold.path_error, (kinematics.X_WE.translation() - start).norm());
    }
    hold.turned = base.yaw;
    hold.spare = q[0] - limits.position_lower[0];
    return hold;
  }
};

// Braking from the limit on takes two seconds and 28 mm of the hand; the posture that changes on the way leaves 5 mm.
TEST_F(ArmReserve, TurningBaseBrakesBeforeTheShoulderIsAtItsLimit) {
  JointVector joints = posture();
  joints[0] -= 2.0 * std::numbers::pi;  // the same hand, 1.5 rad from the limit
  place({}, joints);
  const Hold hold = turn_away();
  EXPECT_LT(hold.path_error, 6e-3);
  EXPECT_LE(hold.slowing, kDeceleration + 1e-9);
  EXPECT_GT(hold.turned, 1.5);  // what the shoulder has is used
  EXPECT_LT(hold.spare, 0.01);
}

TEST_F(ArmReserve, BaseWithRoomTurnsAsWanted) {
  const Hold hold = turn_away();
  EXPECT_NEAR(hold.rate, kTurning, 0.01);  // the rates of the arm cost a little of it
  EXPECT_LT(hold.path_error, 1e-4);
}

}  // namespace
}  // namespace ajar
