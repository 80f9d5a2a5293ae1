// SPDX-License-Identifier: Apache-2.0
#include "rpc/placement_fade.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "tests/support/points.h"

namespace posespace {
namespace {

using namespace std::chrono_literals;
using Clock = PlacementFade::Clock;

constexpr auto kLength = 150ms;
const Point kPlace(0.3, 0.6);

PoseWeights FieldOf(const char* placements) {
  return PoseWeights::Fit(PointsOf(placements)).value();
}

// Fields of the same four poses, placed in different ways.
const PoseWeights& First() {
  static const PoseWeights field = FieldOf("0 0, 1 0, 0 1, 1 1");
  return field;
}
const PoseWeights& Second() {
  static const PoseWeights field = FieldOf("1 1, 0 0, 1 0, 0 2");
  return field;
}
const PoseWeights& Third() {
  static const PoseWeights field = FieldOf("0 1, 3 0, 0.2 0.4, 1 0");
  return field;
}

std::vector<double> At(const PoseWeights& field, const Point& place = kPlace) {
  std::vector<double> weights(static_cast<std::size_t>(field.num_poses()));
  field.At(place, weights);
  return weights;
}

// What a slot that has come to `field` shows.
std::vector<double> Shown(const PlacementFade& fade, const PoseWeights& field,
                          const Point& place = kPlace) {
  std::vector<double> weights = At(field, place), memory(weights.size());
  if (fade.running()) fade.Mix(place, weights, memory);
  return weights;
}

double Distance(const std::vector<double>& a, const std::vector<double>& b) {
  double distance = 0.0;
  for (std::size_t i = 0; i < a.size(); ++i) distance = std::max(distance, std::abs(a[i] - b[i]));
  return distance;
}

class PlacementFadeTest : public ::testing::Test {
 protected:
  void Advance(Clock::duration time) { fade_.Advance(now_ += time); }

  Clock::time_point now_ = Clock::now();
  PlacementFade fade_{kLength};
};

TEST_F(PlacementFadeTest, BeginsExactlyWithWhatWasSeen) {
  EXPECT_FALSE(fade_.running());
  fade_.Leave(First(), now_);
  EXPECT_TRUE(fade_.running());
  Advance(0ms);
  EXPECT_EQ(Shown(fade_, Second()), At(First()));
}

TEST_F(PlacementFadeTest, BeginsWithTheFirstFrameHoweverLate) {
  fade_.Leave(First(), now_);
  fade_.Settle(now_ + 1s);
  Advance(1s);
  EXPECT_EQ(Shown(fade_, Second()), At(First()));
  Advance(kLength - 1ms);
  EXPECT_TRUE(fade_.running());
}

TEST_F(PlacementFadeTest, EndsExactlyWithTheNewField) {
  fade_.Leave(First(), now_);
  Advance(0ms);
  Advance(kLength - 1us);
  EXPECT_TRUE(fade_.running());
  EXPECT_LT(Distance(Shown(fade_, Second()), At(Second())), 1e-8) << "comes to rest";
  Advance(1us);
  EXPECT_FALSE(fade_.running());
}

TEST_F(PlacementFadeTest, EndsByTimeAloneOnceBegun) {
  fade_.Leave(First(), now_);
  Advance(0ms);
  fade_.Settle(now_ + kLength - 1us);
  EXPECT_TRUE(fade_.running());
  fade_.Settle(now_ + kLength);
  EXPECT_FALSE(fade_.running());
}

TEST_F(PlacementFadeTest, LetsGoOfAFieldThatNobodyAsksFor) {
  fade_.Leave(First(), now_);
  fade_.Settle(now_ + PlacementFade::kPatience - 1ms);
  EXPECT_TRUE(fade_.running());
  fade_.Settle(now_ + PlacementFade::kPatience);
  EXPECT_FALSE(fade_.running());
}

TEST_F(PlacementFadeTest, IsHalfwayAtHalfTheTime) {
  fade_.Leave(First(), now_);
  Advance(0ms);
  Advance(kLength / 2);
  const auto first = At(First()), second = At(Second()), shown = Shown(fade_, Second());
  for (std::size_t i = 0; i < shown.size(); ++i) {
    EXPECT_NEAR(shown[i], 0.5 * first[i] + 0.5 * second[i], 1e-9);
  }
}

TEST_F(PlacementFadeTest, MovesNoFasterThanHalfAsFastAgainAsSteadily) {
  for (const Point& place : {kPlace, Point(0, 0), Point(-3, 8)}) {
    const double way = Distance(At(First(), place), At(Second(), place));
    fade_.Leave(First(), now_);
    Advance(0ms);
    auto before = Shown(fade_, Second(), place);
    while (fade_.running()) {
      Advance(1ms);
      const auto after = Shown(fade_, Second(), place);
      EXPECT_LE(Distance(before, after), 1.501 * way / 150.0 + 1e-12);
      before = after;
    }
    EXPECT_EQ(before, At(Second(), place));
  }
}

TEST_F(PlacementFadeTest, KeepsTheSumOfWeights) {
  fade_.Leave(First(), now_);
  Advance(0ms);
  Advance(60ms);
  fade_.Leave(Second(), now_);
  for (int k = 0; k < 30; ++k) {
    Advance(k == 0 ? 0ms : 5ms);
    for (const Point& place : {kPlace, Point(0.9, 0.1), Point(50, -70)}) {
      const auto shown = Shown(fade_, Third(), place);
      EXPECT_NEAR(std::accumulate(shown.begin(), shown.end(), 0.0), 1.0, 1e-9);
    }
  }
}

TEST_F(PlacementFadeTest, GoesOnFromWhatWasSeenWhenPlacementsChangeMeanwhile) {
  fade_.Leave(First(), now_);
  Advance(0ms);
  Advance(60ms);
  const auto seen = Shown(fade_, Second());
  EXPECT_GT(Distance(seen, At(First())), 1e-2);
  EXPECT_GT(Distance(seen, At(Second())), 1e-2);
  now_ += 20ms;  // in which no frame is asked for
  fade_.Leave(Second(), now_);
  Advance(0ms);
  EXPECT_LT(Distance(Shown(fade_, Third()), seen), 1e-14);
  Advance(kLength - 1us);
  EXPECT_LT(Distance(Shown(fade_, Third()), At(Third())), 1e-8);
  Advance(1us);
  EXPECT_FALSE(fade_.running());
}

TEST_F(PlacementFadeTest, PassesOverAFieldThatNobodyHasSeenAnythingOf) {
  fade_.Leave(First(), now_);
  for (int k = 0; k < 20; ++k) {
    fade_.Leave(k % 2 == 0 ? Second() : Third(), now_);
    EXPECT_FALSE(fade_.full());
    Advance(0ms);
    EXPECT_EQ(Shown(fade_, Third()), At(First()));
  }
}

TEST_F(PlacementFadeTest, IsFullOfAsManyFieldsAsAreMixedAndEmptyAfterItsTime) {
  for (std::size_t k = 0; k < PlacementFade::kMostLeft; ++k) {
    EXPECT_FALSE(fade_.full()) << k;
    fade_.Leave(k % 2 == 0 ? First() : Second(), now_);
    Advance(0ms);
    Advance(40ms);
  }
  EXPECT_TRUE(fade_.full());
  Advance(kLength);
  EXPECT_FALSE(fade_.full());
  EXPECT_FALSE(fade_.running());
}

TEST_F(PlacementFadeTest, ArrivesAtOnceWhenStoppedAndBeginsCleanAfterThat) {
  fade_.Leave(First(), now_);
  Advance(0ms);
  Advance(70ms);
  fade_.Stop();
  EXPECT_FALSE(fade_.running());
  fade_.Leave(Second(), now_);
  Advance(0ms);
  EXPECT_EQ(Shown(fade_, Third()), At(Second()));
}

TEST_F(PlacementFadeTest, TakesAClockThatStandsStill) {
  fade_.Leave(First(), now_);
  for (int k = 0; k < 3; ++k) Advance(0ms);
  EXPECT_EQ(Shown(fade_, Second()), At(First()));
}

TEST(PlacementFadeWithoutLength, IsAtOnce) {
  PlacementFade fade(0ms);
  fade.Leave(First(), Clock::now());
  EXPECT_FALSE(fade.running());
}

}  // namespace
}  // namespace posespace
