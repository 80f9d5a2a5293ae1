// SPDX-License-Identifier: Apache-2.0
#include "drawing/ghost_loss.h"

#include <gtest/gtest.h>

#include <vector>

namespace posespace {
namespace {

// A white bar on black.
cv::Mat3f Bar(int column, float brightness = 1.0f) {
  cv::Mat3f picture(20, 40, cv::Vec3f::all(0.0f));
  picture(cv::Rect(column, 4, 5, 12)) = cv::Vec3f::all(brightness);
  return picture;
}

GhostLoss Measure(const std::vector<cv::Mat3f>& pictures) {
  return MeasureGhosts(pictures, cv::Mat1b(20, 40, 255));
}

TEST(MeasureGhosts, FindsNoneInEqualPictures) {
  const GhostLoss loss = Measure({Bar(10), Bar(10), Bar(10)});
  EXPECT_NEAR(loss.all, 0.0, 1e-6);
  for (const double each : loss.each) EXPECT_NEAR(each, 0.0, 1e-6);
}

TEST(MeasureGhosts, CountsAllButOneInNWherePicturesHaveNothingInCommon) {
  EXPECT_NEAR(Measure({Bar(2), Bar(12)}).all, 1.0 / 2.0, 1e-6);
  EXPECT_NEAR(Measure({Bar(2), Bar(12), Bar(22)}).all, 2.0 / 3.0, 1e-6);
}

TEST(MeasureGhosts, FallsWithTheDistanceOfWhatShouldBeOne) {
  const double near = Measure({Bar(10), Bar(10)}).all, far = Measure({Bar(10), Bar(12)}).all;
  EXPECT_LT(near, far);
  EXPECT_LT(far, 0.5);
}

TEST(MeasureGhosts, IsTheMeanOfItsPartsWeightedWithTheirDetail) {
  const GhostLoss loss = Measure({Bar(10), Bar(12, 0.5f)});
  EXPECT_NEAR(loss.all, (loss.each[0] + 0.25 * loss.each[1]) / 1.25, 1e-6);
}

TEST(MeasureGhosts, FindsNoneWhereNothingIsDrawn) {
  const cv::Mat3f empty(20, 40, cv::Vec3f::all(0.3f));
  EXPECT_EQ(Measure({empty, empty}).all, 0.0);
  EXPECT_EQ(MeasureGhosts({}, {}).all, 0.0);
  EXPECT_EQ(Measure({Bar(10), empty}).each[1], 0.0);
}

TEST(MeasureGhosts, LooksOnlyWhereTheMaskIs) {
  cv::Mat1b left(20, 40, static_cast<unsigned char>(0));
  left(cv::Rect(0, 0, 18, 20)) = 255;
  const std::vector<cv::Mat3f> pictures = {Bar(5) + Bar(20), Bar(5) + Bar(30)};
  EXPECT_NEAR(MeasureGhosts(pictures, left).all, 0.0, 1e-6);
  EXPECT_GT(Measure(pictures).all, 0.1);
}

}  // namespace
}  // namespace posespace
