// SPDX-License-Identifier: Apache-2.0
#include "interpolation/texture_weights.h"

#include <gtest/gtest.h>

#include "tests/interpolation/sample_meshes.h"

namespace posespace {
namespace {

TEST(TextureWeights, WithoutSharpnessAreTheWeightsThemselves) {
  const Eigen::Vector4d weights(0.1, 0.2, 0.3, 0.4);
  EXPECT_LT((TextureWeights(weights, 0.0) - weights).norm(), 1e-15);
}

TEST(TextureWeights, OfFullSharpnessPickTheLargest) {
  EXPECT_EQ(TextureWeights(Eigen::Vector3d(0.4, 0.35, 0.25), 1.0), Eigen::Vector3d(1, 0, 0));
  EXPECT_EQ(TextureWeights(Eigen::Vector4d(0.25, 0.24, 0.25, 0.26), 1.0),
            Eigen::Vector4d(0, 0, 0, 1));
}

TEST(TextureWeights, OfFullSharpnessShareATie) {
  EXPECT_EQ(TextureWeights(Eigen::Vector2d(0.5, 0.5), 1.0), Eigen::Vector2d(0.5, 0.5));
  EXPECT_LT((TextureWeights(Eigen::Vector3d::Constant(1.0 / 3.0), 1.0) -
             Eigen::Vector3d::Constant(1.0 / 3.0))
                .norm(),
            1e-15);
}

TEST(TextureWeights, SharpenAlsoWhereNoneOfManyIsLarge) {
  // The paper's formula would leave these linear: all lie below sigma / 2.
  const Eigen::VectorXd sharp =
      TextureWeights((Eigen::VectorXd(5) << 0.3, 0.2, 0.2, 0.15, 0.15).finished(), 0.8);
  EXPECT_GT(sharp[0], 0.5);
}

TEST(TextureWeights, OfTwoPosesAreThePapersFormula) {
  for (const double sigma : {0.0, 0.3, 0.6, 0.95}) {
    for (const double w : {0.0, 0.2, 0.45, 0.5, 0.7, 1.0}) {
      const auto raw = [&](double t) {
        const double x = std::clamp((t - sigma / 2) / (1 - sigma), 0.0, 1.0);
        return sigma * x * x * (3 - 2 * x) + (1 - sigma) * t;
      };
      const double expected = raw(w) / (raw(w) + raw(1 - w));
      EXPECT_NEAR(TextureWeights(Eigen::Vector2d(w, 1 - w), sigma)[0], expected, 1e-14);
    }
  }
}

TEST(TextureWeights, AreConvexKeepTheOrderAndSinglePoses) {
  std::mt19937 random(2);
  for (int count = 1; count <= 20; ++count) {
    for (const double sigma : {0.0, 0.4, 0.9, 1.0 - 1e-12, 1.0}) {
      const Eigen::VectorXd weights = RandomWeights(count, &random);
      const Eigen::VectorXd sharp = TextureWeights(weights, sigma);
      EXPECT_NEAR(sharp.sum(), 1.0, 1e-14);
      EXPECT_GE(sharp.minCoeff(), 0.0);
      for (int i = 0; i < count; ++i) {
        for (int j = 0; j < count; ++j) {
          if (weights[i] < weights[j]) {
            EXPECT_LE(sharp[i], sharp[j]);
          }
        }
      }
      EXPECT_EQ(TextureWeights(Eigen::VectorXd::Unit(count, 0), sigma),
                Eigen::VectorXd::Unit(count, 0));
    }
  }
}

}  // namespace
}  // namespace posespace
