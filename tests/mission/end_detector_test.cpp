// Strategy: each verdict is produced by the force and speed history that defines it, with a control period of 2 ms;
// neighbours (a closer, a blocked start, a clearance) must not be taken for one another.
#include "ajar/mission/end_detector.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace ajar {
namespace {

using Verdict = EndDetector::Verdict;

MechanismEstimate travelled(double arc, MechanismType type = MechanismType::Unknown) {
  MechanismEstimate estimate;
  estimate.arc = arc;
  estimate.type = type;
  estimate.fitted = true;
  return estimate;
}

// Feeds the same input until a verdict falls; returns it and the time that it took.
std::pair<Verdict, double> hold(EndDetector& ends, const EndInput& input, const MechanismEstimate& estimate,
                                double longest) {
  for (double t = 0.0; t < longest; t += input.dt) {
    const Verdict verdict = ends.step(input, estimate);
    if (verdict != Verdict::Going) return {verdict, t};
  }
  return {Verdict::Going, longest};
}

TEST(EndDetector, FeelsAStopWhenForceRisesOverTheRunningForce) {
  EndDetector ends(EndConfig{}, GoalConfig{.to_the_stop = true}, 45.0);
  const auto [verdict, time] = hold(ends, {.speed = 0.0, .pull_force = 25.0, .running_force = 5.0}, travelled(0.3), 5.0);
  EXPECT_EQ(verdict, Verdict::Stop);
  EXPECT_NEAR(time, EndConfig{}.stop_time, 0.01);
}

TEST(EndDetector, AHandThatIsHeldBackMustLeanOnAStopForLonger) {
  EndDetector ends(EndConfig{}, GoalConfig{.to_the_stop = true}, 45.0);
  const EndInput leaning{.speed = 0.0, .wanted_speed = 0.05, .pull_force = 25.0, .running_force = 5.0, .speed_factor = 0.2};
  const auto [verdict, time] = hold(ends, leaning, travelled(0.3), 5.0);
  EXPECT_EQ(verdict, Verdict::Stop);
  EXPECT_NEAR(time, EndConfig{}.leaning_time + 1.1, 0.2);  // 12 of 20 N risen: ln(25/8) of the 1 s mean
}

TEST(EndDetector, AShareOfNextToNothingIsNotBeingHeldBack) {
  EndDetector ends(EndConfig{}, GoalConfig{.to_the_stop = true}, 45.0);
  const EndInput balanced{
      .speed = 0.0, .wanted_speed = -0.002, .pull_force = 25.0, .running_force = 5.0, .speed_factor = 0.2};
  const auto [verdict, time] = hold(ends, balanced, travelled(0.3), 5.0);
  EXPECT_EQ(verdict, Verdict::Stop);
  EXPECT_NEAR(time, EndConfig{}.stop_time, 0.01);
}

TEST(EndDetector, AHandThatCameFastIsFeltToLeanBeforeItCountsAsStalled) {
  EndDetector ends(EndConfig{}, GoalConfig{.to_the_stop = true}, 45.0);
  EndInput in{.speed = 0.3, .wanted_speed = 0.3, .running_force = 5.0};
  for (double t = 0.0; t < 5.0; t += in.dt) {
    ASSERT_EQ(ends.step(in, travelled(0.3)), Verdict::Going);
  }
  in.speed = 0.0;
  in.pull_force = 25.0;
  in.speed_factor = 0.2;
  EXPECT_EQ(hold(ends, in, travelled(0.3), 10.0).first, Verdict::Stop);
}

TEST(EndDetector, AHandThatSwingsOnAStopFeelsIt) {
  EndDetector ends(EndConfig{}, GoalConfig{.to_the_stop = true}, 45.0);
  EndInput in{.pull_force = 25.0, .running_force = 5.0};
  EndDetector::Verdict verdict = Verdict::Going;
  double time = 0.0;
  for (; time < 10.0 && verdict == Verdict::Going; time += in.dt) {
    in.speed = std::fmod(time, 0.8) < 0.4 ? 0.015 : -0.015;  // never below 6 mm/s for long, and nothing gained
    verdict = ends.step(in, travelled(0.3));
  }
  EXPECT_EQ(verdict, Verdict::Stop);
  EXPECT_NEAR(time, EndConfig{}.leaning_time + 1.1, 0.5);
}

TEST(EndDetector, DoesNotTakeAHeavyCloserForAStop) {
  EndDetector ends(EndConfig{}, GoalConfig{.to_the_stop = true}, 45.0);
  EXPECT_EQ(hold(ends, {.speed = 0.0, .pull_force = 43.0, .running_force = 40.0}, travelled(0.3), 10.0).first,
            Verdict::TooHeavy);
}

TEST(EndDetector, AStandstillNearTheStartIsBlocked) {
  EndDetector ends(EndConfig{}, GoalConfig{}, 45.0);
  EXPECT_EQ(hold(ends, {.speed = 0.0, .pull_force = 44.0}, travelled(0.0), 10.0).first, Verdict::Blocked);
}

// Jerks faster than any standstill, and nothing gained: 3 mm on, 3 mm back, the limit changing from tick to tick.
TEST(EndDetector, JerkingAtAClearanceIsBeingHeldByIt) {
  EndDetector ends(EndConfig{}, GoalConfig{}, 45.0);
  EndInput in{.pull_force = 2.0, .running_force = 2.0};
  EndDetector::Verdict verdict = Verdict::Going;
  double time = 0.0;
  for (int tick = 0; time < 30.0 && verdict == Verdict::Going; ++tick, time += in.dt) {
    in.speed = std::fmod(time, 0.4) < 0.2 ? 0.015 : -0.015;
    in.speed_factor = std::fmod(time, 0.4) < 0.2 ? 0.3 : 0.0;
    in.binding = tick % 4 == 0 ? BindingLimit::JointAcceleration : BindingLimit::Clearance;
    verdict = ends.step(in, travelled(0.3));
  }
  EXPECT_EQ(verdict, Verdict::ClearanceStop);
  EXPECT_NEAR(time, EndConfig{}.stalled_time, 1.0);
}

TEST(EndDetector, AStandstillWithoutForceIsStalledOrHeldByAClearance) {
  EndDetector ends(EndConfig{}, GoalConfig{}, 45.0);
  EXPECT_EQ(hold(ends, {.speed = 0.0, .pull_force = 2.0, .running_force = 2.0}, travelled(0.2), 20.0).first,
            Verdict::Stalled);
  ends.reset();
  const EndInput held{
      .speed = 0.0, .pull_force = 2.0, .running_force = 2.0, .speed_factor = 0.0, .binding = BindingLimit::Clearance};
  EXPECT_EQ(hold(ends, held, travelled(0.2), 20.0).first, Verdict::ClearanceStop);
}

// A grasp that swings on its spring is slow in the mean only: it has not moved the handle either.
TEST(EndDetector, AStandstillBeforeItHasMovedIsBlocked) {
  EndDetector ends(EndConfig{}, GoalConfig{}, 45.0);
  EndInput in{.pull_force = 10.0, .force_cap = 16.0};
  EndDetector::Verdict verdict = Verdict::Going;
  for (double time = 0.0; time < 30.0 && verdict == Verdict::Going; time += in.dt) {
    in.speed = std::fmod(time, 0.4) < 0.2 ? 0.015 : -0.015;
    verdict = ends.step(in, travelled(0.0));
  }
  EXPECT_EQ(verdict, Verdict::Blocked);
}

TEST(EndDetector, TheGoalNeedsAKnownTypeAndWaitsForDoubt) {
  EndDetector ends(EndConfig{}, GoalConfig{.opening_angle = 1.0}, 45.0);
  MechanismEstimate estimate = travelled(0.8);
  estimate.angle = 1.05;
  EXPECT_EQ(hold(ends, {.speed = 0.1}, estimate, 1.0).first, Verdict::Going);
  estimate.type = MechanismType::Hinge;
  estimate.angle_sigma = 0.03;
  EXPECT_EQ(hold(ends, {.speed = 0.1}, estimate, 1.0).first, Verdict::Going);
  estimate.angle = 1.08;
  EXPECT_EQ(hold(ends, {.speed = 0.1}, estimate, 1.0).first, Verdict::Goal);
}

TEST(EndDetector, ASlideReachesItsLength) {
  EndDetector ends(EndConfig{}, GoalConfig{.opening_length = 0.4}, 45.0);
  EXPECT_EQ(hold(ends, {.speed = 0.1}, travelled(0.39, MechanismType::Slide), 1.0).first, Verdict::Going);
  EXPECT_EQ(hold(ends, {.speed = 0.1}, travelled(0.41, MechanismType::Slide), 1.0).first, Verdict::Goal);
}

TEST(EndDetector, MotionIsNeverAnEnd) {
  EndDetector ends(EndConfig{}, GoalConfig{.to_the_stop = true}, 45.0);
  EXPECT_EQ(hold(ends, {.speed = 0.05, .pull_force = 44.0, .running_force = 5.0}, travelled(0.3), 20.0).first,
            Verdict::Going);
}

}  // namespace
}  // namespace ajar
