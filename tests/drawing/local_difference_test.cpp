// SPDX-License-Identifier: Apache-2.0
#include "drawing/local_difference.h"

#include <gtest/gtest.h>

namespace posespace {
namespace {

constexpr int kSide = 64;
const cv::Mat1b kEverywhere(kSide, kSide, 255);

cv::Mat3f Plain(float value) { return cv::Mat3f(kSide, kSide, cv::Vec3f::all(value)); }

TEST(LocalDifferences, AreTheMeanOverTheOthers) {
  const auto found = LocalDifferences(std::vector<cv::Mat3f>{Plain(0.5f), Plain(0.5f), Plain(0.6f)},
                                      kEverywhere, 3.0);
  ASSERT_EQ(found.size(), 3u);
  EXPECT_NEAR(found[0](32, 32), 0.5 * 0.03, 1e-5);
  EXPECT_NEAR(found[1](32, 32), 0.5 * 0.03, 1e-5);
  EXPECT_NEAR(found[2](32, 32), 0.03, 1e-5);
}

TEST(LocalDifferences, CountColoursWithNothingInCommonAllTheSame) {
  const auto far =
      LocalDifferences(std::vector<cv::Mat3f>{Plain(0.0f), Plain(0.5f)}, kEverywhere, 3.0);
  const auto farther =
      LocalDifferences(std::vector<cv::Mat3f>{Plain(0.0f), Plain(1.0f)}, kEverywhere, 3.0);
  EXPECT_FLOAT_EQ(far[0](10, 10), farther[0](10, 10));
}

TEST(LocalDifferences, AreFeltAroundAPlaceAndNotFarFromIt) {
  cv::Mat3f dotted = Plain(0.5f);
  dotted(32, 32) = cv::Vec3f::all(0.0f);
  const auto found =
      LocalDifferences(std::vector<cv::Mat3f>{Plain(0.5f), dotted}, kEverywhere, 3.0);
  EXPECT_GT(found[0](32, 32), found[0](32, 36));
  EXPECT_GT(found[0](32, 36), 0.0f);
  EXPECT_LT(found[0](32, 52), 1e-3f * found[0](32, 32));
}

TEST(LocalDifferences, AreNothingBesideTheMask) {
  const auto found = LocalDifferences(std::vector<cv::Mat3f>{Plain(0.0f), Plain(1.0f)},
                                      cv::Mat1b(kSide, kSide, static_cast<unsigned char>(0)), 3.0);
  EXPECT_EQ(found[0](20, 20), 0.0f);
}

// Of one place.
float Share(float before, float after) {
  return ShareToKeep(cv::Mat1f(1, 1, before), cv::Mat1f(1, 1, after))(0, 0);
}

TEST(ShareToKeep, IsAllWhereThePictureDiffersClearlyLess) {
  EXPECT_EQ(Share(0.05f, 0.0f), 1.0f);
  EXPECT_EQ(Share(0.05f, 0.04f), 1.0f);
}

TEST(ShareToKeep, IsNoneWhereThePictureDiffersMore) {
  EXPECT_EQ(Share(0.05f, 0.06f), 0.0f);
  EXPECT_EQ(Share(0.0f, 0.01f), 0.0f);
  EXPECT_LT(Share(0.05f, 0.05f), 0.05f);
}

TEST(ShareToKeep, IsAllWhereThereWasNothingToGain) { EXPECT_EQ(Share(0.0f, 0.0f), 1.0f); }

TEST(ShareToKeep, GrowsSmoothlyWithTheGain) {
  float last = 0.0f;
  for (float after = 0.06f; after > 0.04f; after -= 5e-4f) {
    const float share = Share(0.05f, after);
    EXPECT_GE(share, last);
    EXPECT_LT(share - last, 0.2f);
    last = share;
  }
}

}  // namespace
}  // namespace posespace
