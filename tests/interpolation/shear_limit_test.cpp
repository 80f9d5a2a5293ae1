// SPDX-License-Identifier: Apache-2.0
#include "interpolation/shear_limit.h"

#include <gtest/gtest.h>

#include "tests/interpolation/sample_meshes.h"

namespace posespace {
namespace {

TEST(LimitWeight, RunsFromZeroToOneWithZeroSlopeAtBothEnds) {
  for (const auto limit : {ShearLimit::kBand, ShearLimit::kHermite}) {
    EXPECT_EQ(LimitWeight(0.0, limit), 0.0);
    EXPECT_EQ(LimitWeight(1.0, limit), 1.0);
    EXPECT_EQ(LimitWeight(-3.0, limit), 0.0);
    EXPECT_EQ(LimitWeight(4.0, limit), 1.0);
    EXPECT_LT(LimitWeight(1e-6, limit), 1e-10);
    EXPECT_GT(LimitWeight(1.0 - 1e-6, limit), 1.0 - 1e-10);
  }
}

TEST(LimitWeight, RisesWithoutJumpsInItsSlope) {
  constexpr double kStep = 1e-4;
  for (const auto limit : {ShearLimit::kBand, ShearLimit::kHermite}) {
    double slope = 0.0;
    for (int k = -1000; k < 11000; ++k) {
      const double t = k * kStep;
      const double next = (LimitWeight(t + kStep, limit) - LimitWeight(t, limit)) / kStep;
      ASSERT_GE(next, 0.0) << t;
      ASSERT_NEAR(next, slope, 0.01) << t;
      slope = next;
    }
    EXPECT_EQ(slope, 0.0);
  }
}

TEST(LimitWeight, BandLeavesOrdinaryInBetweensAlone) {
  for (const double t : {0.1, 0.11, 0.25, 0.5, 0.77, 0.9}) {
    EXPECT_NEAR(LimitWeight(t, ShearLimit::kBand), t, 1e-16);
  }
  EXPECT_NEAR(LimitWeight(0.05, ShearLimit::kBand), 0.1 * (2.0 / 4.0 - 1.0 / 8.0), 1e-16);
  EXPECT_NEAR(LimitWeight(0.95, ShearLimit::kBand), 1.0 - 0.0375, 1e-15);
}

TEST(LimitWeight, HermiteIsThePapersCubic) {
  for (const double t : {0.1, 0.25, 0.5, 0.9}) {
    EXPECT_NEAR(LimitWeight(t, ShearLimit::kHermite), 3 * t * t - 2 * t * t * t, 1e-15);
  }
}

TEST(LimitedWeights, AreConvexForAnyWeightsThatSumToOne) {
  std::mt19937 random(1);
  for (int count = 1; count <= 40; ++count) {
    Eigen::VectorXd weights(count);
    for (double& w : weights) w = Uniform(-2.0, 2.0, &random);
    weights.array() += (1.0 - weights.sum()) / count;
    for (const auto limit : {ShearLimit::kBand, ShearLimit::kHermite}) {
      const Eigen::VectorXd limited = LimitedWeights(weights, limit);
      EXPECT_NEAR(limited.sum(), 1.0, 1e-14);
      EXPECT_GE(limited.minCoeff(), 0.0);
    }
    EXPECT_EQ(LimitedWeights(weights, ShearLimit::kOff), weights);
  }
}

TEST(LimitedWeights, StayWeightsOfOnePoseAlone) {
  const Eigen::VectorXd one = Eigen::VectorXd::Unit(5, 3);
  for (const auto limit : {ShearLimit::kBand, ShearLimit::kHermite, ShearLimit::kOff}) {
    EXPECT_EQ(LimitedWeights(one, limit), one);
  }
}

TEST(LimitedWeights, OfManyEqualWeightsAreEqual) {
  const Eigen::VectorXd equal = Eigen::VectorXd::Constant(1000, 1e-3);
  EXPECT_LT((LimitedWeights(equal, ShearLimit::kBand) - equal).cwiseAbs().maxCoeff(), 1e-15);
}

}  // namespace
}  // namespace posespace
