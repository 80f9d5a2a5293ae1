// SPDX-License-Identifier: Apache-2.0
#include "geometry/progress.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>
#include <utility>
#include <vector>

#include "geometry/result.h"

namespace posespace {
namespace {

TEST(Progress, MapsEachStageIntoItsPartAndNeverFalls) {
  std::vector<std::pair<std::string, double>> heard;
  Progress progress(
      [&](std::string_view stage, double fraction) { heard.emplace_back(stage, fraction); });
  progress.EnterStage("matching", 0.0, 0.5);
  progress.Report(0.5);
  progress.Report(0.25);
  progress.EnterStage("weights", 0.5, 1.0);
  progress.Report(2.0);
  EXPECT_THAT(heard, testing::ElementsAre(std::pair("matching", 0.0), std::pair("matching", 0.25),
                                          std::pair("matching", 0.25), std::pair("weights", 0.5),
                                          std::pair("weights", 1.0)));
}

TEST(Progress, IsCancelledFromAnotherThread) {
  Progress progress;
  EXPECT_FALSE(IsCancelled(&progress));
  std::thread([&] { progress.Cancel(); }).join();
  EXPECT_TRUE(IsCancelled(&progress));
  EXPECT_FALSE(IsCancelled(nullptr));
}

TEST(Progress, ShowsAPartAsItsShareOfTheWhole) {
  std::vector<std::pair<std::string, double>> heard;
  Progress whole(
      [&](std::string_view stage, double fraction) { heard.emplace_back(stage, fraction); });
  Progress part(&whole, 0.0, 0.5);
  part.EnterStage("matching", 0.0, 0.5);
  part.Report(1.0);
  part.EnterStage("improvement", 0.5, 1.0);
  part.Report(1.0);
  whole.EnterStage("weights", 0.5, 1.0);
  EXPECT_THAT(heard,
              testing::ElementsAre(std::pair("matching", 0.0), std::pair("matching", 0.25),
                                   std::pair("improvement", 0.25), std::pair("improvement", 0.5),
                                   std::pair("weights", 0.5)));
}

TEST(Progress, CancelsItsPartsButNotTheOtherWayRound) {
  Progress whole;
  Progress first(&whole, 0.0, 0.5);
  Progress second(&whole, 0.5, 1.0);
  first.Cancel();
  EXPECT_TRUE(first.cancelled());
  EXPECT_FALSE(whole.cancelled());
  whole.Cancel();
  EXPECT_TRUE(second.cancelled());
}

TEST(Progress, IsAWholeByItselfWhenItsParentIsAbsent) {
  Progress part(nullptr, 0.0, 0.5);
  part.EnterStage("matching", 0.0, 1.0);
  part.Report(1.0);
  EXPECT_FALSE(part.cancelled());
}

Result<int> Half(int value) {
  if (value % 2 != 0) return Error{ErrorCode::kInvalidOption, "odd", {}};
  return value / 2;
}

Result<int> Quarter(int value) {
  const int half = TRY(Half(value));
  return TRY(Half(half));
}

TEST(Result, CarriesAValueOrTheFirstErrorThrough) {
  EXPECT_EQ(*Quarter(12), 3);
  ASSERT_FALSE(Quarter(6));
  EXPECT_EQ(Quarter(6).error().code, ErrorCode::kInvalidOption);
  EXPECT_EQ(Quarter(6).error().message, "odd");
}

TEST(ReasonName, IsDistinctForEveryCode) {
  std::vector<std::string_view> names;
  for (int code = 0; code <= static_cast<int>(ErrorCode::kInternal); ++code) {
    names.push_back(ReasonName(static_cast<ErrorCode>(code)));
  }
  EXPECT_THAT(names, testing::Each(testing::Not(testing::IsEmpty())));
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
}

}  // namespace
}  // namespace posespace
