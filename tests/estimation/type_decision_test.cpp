// Strategy: the two distances have closed forms for a round covariance; cases are placed on either side of the threshold.
#include "ajar/estimation/type_decision.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace ajar {
namespace {

const Eigen::Matrix2d kUnit = Eigen::Matrix2d::Identity();

TEST(TypeDecision, SureCurvatureIsAHinge) {
  EXPECT_EQ(decide_type({0.0, 1.2}, 0.01 * kUnit, {}), MechanismType::Hinge);  // D_s = 1.44/0.0125
  EXPECT_EQ(decide_type({-0.9, 0.8}, 0.01 * kUnit, {}), MechanismType::Hinge);
}

TEST(TypeDecision, SureStraightnessIsASlide) {
  EXPECT_EQ(decide_type({0.0, 0.0}, 0.01 * kUnit, {}), MechanismType::Slide);  // D_h = 0.36/0.01 = 36
  EXPECT_EQ(decide_type({0.02, -0.03}, 0.001 * kUnit, {}), MechanismType::Slide);
}

TEST(TypeDecision, SaysUnknownUntilTheDataDecide) {
  EXPECT_EQ(decide_type({0.0, 1.2}, 1.0 * kUnit, {}), MechanismType::Unknown);
  EXPECT_EQ(decide_type({0.0, 0.0}, 0.03 * kUnit, {}), MechanismType::Unknown);  // D_h = 12
  EXPECT_EQ(decide_type({0.2, 0.1}, 0.01 * kUnit, {}), MechanismType::Unknown);
}

TEST(TypeDecision, ThresholdIsWhereTheFormulaPutsIt) {
  // kap = 0: D_h - D_s = k_min²/σ²; equal to T = 15 at σ² = 0.36/15.
  EXPECT_EQ(decide_type({0.0, 0.0}, (0.36 / 15.0 * 0.999) * kUnit, {}), MechanismType::Slide);
  EXPECT_EQ(decide_type({0.0, 0.0}, (0.36 / 15.0 * 1.001) * kUnit, {}), MechanismType::Unknown);
}

TEST(TypeDecision, BadNumbersDecideNothing) {
  EXPECT_EQ(decide_type({std::nan(""), 0.0}, kUnit, {}), MechanismType::Unknown);
  EXPECT_EQ(decide_type({1.0, 0.0}, -kUnit, {}), MechanismType::Unknown);
  EXPECT_EQ(decide_type({1.0, 0.0}, std::nan("") * kUnit, {}), MechanismType::Unknown);
}

}  // namespace
}  // namespace ajar
