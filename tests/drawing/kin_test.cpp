// SPDX-License-Identifier: Apache-2.0
#include "drawing/kin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <opencv2/imgproc.hpp>
#include <set>

#include "tests/support/fails_with.h"

namespace posespace {
namespace {

constexpr int kSide = 160;
const cv::Scalar kSkin(0.9, 0.7, 0.5), kHair(0.2, 0.15, 0.2), kWhite(1.0, 1.0, 1.0);

cv::Mat3f Face(int eye_x) {
  cv::Mat3f picture(kSide, kSide, cv::Vec3f(0.9f, 0.7f, 0.5f));
  cv::circle(picture, {eye_x, 80}, 20, kWhite, cv::FILLED);
  cv::circle(picture, {eye_x, 80}, 10, kHair, cv::FILLED);
  return picture;
}

cv::Mat3f BackOfHead(int ornament_x) {
  cv::Mat3f picture = Face(80);
  cv::rectangle(picture, cv::Rect(0, 0, kSide, 120), kHair, cv::FILLED);
  cv::circle(picture, {ornament_x, 60}, 16, kWhite, cv::FILLED);
  return picture;
}

const cv::Mat1b kEverywhere(kSide, kSide, 255);

// The groups as sets of what `names` calls the pictures.
std::set<std::set<int>> GroupsOf(const std::vector<cv::Mat3f>& pictures,
                                 const std::vector<int>& names) {
  const auto kin = KinOf(pictures, kEverywhere);
  EXPECT_THAT(kin, Succeeds());
  std::set<std::set<int>> groups;
  for (const std::vector<int>& group : *kin) {
    std::set<int> named;
    for (const int i : group) named.insert(names[i]);
    groups.insert(named);
  }
  return groups;
}

TEST(KinOf, TellsFacesFromBacksWhateverTheirOrder) {
  const std::set<std::set<int>> expected = {{0, 1, 2}, {3, 4}};
  const std::vector<cv::Mat3f> pictures = {Face(70), Face(80), Face(88), BackOfHead(75),
                                           BackOfHead(85)};
  std::vector<int> order = {0, 1, 2, 3, 4};
  for (int turn = 0; turn < 5; ++turn) {
    std::vector<cv::Mat3f> ordered;
    for (const int i : order) ordered.push_back(pictures[i]);
    EXPECT_EQ(GroupsOf(ordered, order), expected);
    std::rotate(order.begin(), order.begin() + 2, order.end());
    std::swap(order[0], order[3]);
  }
}

TEST(KinOf, BeginsAGroupWithThePictureThatDiffersLeast) {
  const auto kin = KinOf(std::vector<cv::Mat3f>{Face(68), Face(90), Face(80)}, kEverywhere);
  ASSERT_THAT(kin, Succeeds());
  ASSERT_EQ(kin->size(), 1u);
  EXPECT_EQ(kin->front().front(), 2);
}

TEST(KinOf, LeavesWhatLooksLikeNoOtherByItself) {
  EXPECT_EQ(GroupsOf({Face(75), BackOfHead(80), Face(85)}, {0, 1, 2}),
            (std::set<std::set<int>>{{0, 2}, {1}}));
}

TEST(KinOf, LooksOnlyWhereTheMaskIs) {
  cv::Mat1b neck = cv::Mat1b::zeros(kSide, kSide);
  neck(cv::Rect(0, 130, kSide, 30)) = 255;
  const auto kin = KinOf(std::vector<cv::Mat3f>{Face(80), BackOfHead(80)}, neck);
  ASSERT_THAT(kin, Succeeds());
  EXPECT_EQ(kin->size(), 1u);
}

TEST(KinOf, HasNoGroupsOfNoPictures) {
  const auto kin = KinOf({}, kEverywhere);
  ASSERT_THAT(kin, Succeeds());
  EXPECT_TRUE(kin->empty());
}

TEST(KinOf, StopsWhenItIsCancelled) {
  Progress progress;
  progress.Cancel();
  EXPECT_THAT(KinOf(std::vector<cv::Mat3f>{Face(75), Face(80)}, kEverywhere, &progress),
              FailsWith(ErrorCode::kCancelled));
}

}  // namespace
}  // namespace posespace
