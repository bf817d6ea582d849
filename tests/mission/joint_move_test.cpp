// Strategy: a perfect servo and one with a lag follow polylines; rates, accelerations and the end posture are checked on the
// way.
#include "ajar/mission/joint_move.hpp"

#include <gtest/gtest.h>

namespace ajar {
namespace {

constexpr double kDt = 0.002;

JointVector posture(double a, double b) {
  JointVector q(2);
  q << a, b;
  return q;
}

TEST(JointMove, ReachesEveryCornerAndStops) {
  for (const double lag : {0.0, 0.03}) {
    JointMove move(0.8, 2.0);
    move.start({posture(0.0, 0.0), posture(1.0, -0.5), posture(1.2, 1.0)});
    JointVector q = posture(0.0, 0.0);
    JointVector rate = posture(0.0, 0.0);
    double nearest_corner = 1e9;
    for (int i = 0; i < 10000 && !move.done(); ++i) {
      const JointVector wanted = move.step(q, kDt);
      EXPECT_LE(wanted.cwiseAbs().maxCoeff(), 0.8 * 1.2 + 1e-9);
      rate += (lag > 0.0 ? kDt / lag : 1.0) * (wanted - rate);
      q += kDt * rate;
      nearest_corner = std::min(nearest_corner, (q - posture(1.0, -0.5)).norm());
    }
    EXPECT_TRUE(move.done());
    EXPECT_LT(nearest_corner, 4e-3);
    EXPECT_LT((q - posture(1.2, 1.0)).cwiseAbs().maxCoeff(), 4e-3);
    EXPECT_EQ(move.step(q, kDt).norm(), 0.0);
  }
}

TEST(JointMove, AccelerationStaysInsideItsLimitOnAPerfectServo) {
  JointMove move(0.8, 2.0);
  move.start({posture(0.0, 0.0), posture(1.0, 0.0)});
  JointVector q = posture(0.0, 0.0);
  JointVector last = posture(0.0, 0.0);
  while (!move.done()) {
    const JointVector rate = move.step(q, kDt);
    // Half of the feedback gain acts on the sampling error of the profile.
    if (!move.done()) {
      EXPECT_LE((rate - last).cwiseAbs().maxCoeff() / kDt, 2.0 * 1.05);
    }
    last = rate;
    q += kDt * rate;
  }
}

TEST(JointMove, WithoutAPathItIsDone) {
  JointMove move(0.8, 2.0);
  EXPECT_TRUE(move.done());
  move.start({posture(0.0, 0.0)});
  EXPECT_TRUE(move.done());
}

}  // namespace
}  // namespace ajar
