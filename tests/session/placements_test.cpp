// SPDX-License-Identifier: Apache-2.0
#include "session/placements.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "interpolation/pose_weights.h"
#include "session/ids.h"
#include "tests/support/fails_with.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

const std::vector<std::string> kIds = {"stand", "walk", "jump"};

TEST(DefaultPlacements, PutOneDrawingAtTheOriginAndMoreOnTheUnitCircle) {
  EXPECT_EQ(DefaultPlacements(1), PointsOf("0 0"));
  EXPECT_TRUE(DefaultPlacements(4).isApprox(PointsOf("1 0, 0 1, -1 0, 0 -1")));
  for (int count = 2; count <= 64; ++count) {
    EXPECT_TRUE(DefaultPlacements(count).rowwise().norm().isApproxToConstant(1.0));
    EXPECT_THAT(CheckPlacements(std::vector<std::string>(count, "x"), DefaultPlacements(count)),
                Succeeds());
  }
}

TEST(CheckPlacements, NamesEveryPlaceThatIsNotFinite) {
  Points places = PointsOf("0 0, 1 0, 0 1");
  places(0, 1) = std::numeric_limits<double>::quiet_NaN();
  places(2, 0) = std::numeric_limits<double>::infinity();
  const auto result = CheckPlacements(kIds, places);
  EXPECT_THAT(result, FailsWith(ErrorCode::kPlacementNotFinite, "placements['stand'].at"));
  EXPECT_THAT(result, FailsWith(ErrorCode::kPlacementNotFinite, "placements['jump'].at"));
  EXPECT_EQ(result.error().where.size(), 2u);
}

TEST(CheckPlacements, RefusesPlacesTooFarApartForNumbers) {
  EXPECT_THAT(CheckPlacements(kIds, PointsOf("-1.7e308 0, 1.7e308 0, 0 0")),
              FailsWith(ErrorCode::kPlacementNotFinite));
}

TEST(CheckPlacements, NamesPlacesThatCoincide) {
  const auto result = CheckPlacements(kIds, PointsOf("0 0, 5 5, 0 0"));
  EXPECT_THAT(result, FailsWith(ErrorCode::kPlacementsCoincide, "placements['jump'].at"));
  EXPECT_NE(result.error().message.find("'stand' and 'jump'"), std::string::npos);
  EXPECT_THAT(CheckPlacements(kIds, PointsOf("7 7, 7 7, 7 7")),
              FailsWith(ErrorCode::kPlacementsCoincide));
}

TEST(CheckPlacements, DrawsTheLineWhereTheWeightFieldDoes) {
  for (const double gap : {0.9e-3, 1.1e-3}) {
    const Points places = PointsOf("0 0, 1 0, " + std::to_string(gap) + " 0");
    EXPECT_EQ(CheckPlacements(kIds, places).has_value(), PoseWeights::Fit(places).has_value())
        << gap;
  }
}

TEST(CheckPlacements, TakesAnyUnit) {
  EXPECT_THAT(CheckPlacements(kIds, PointsOf("0 0, 1e-200 0, 0 1e-200")), Succeeds());
  EXPECT_THAT(CheckPlacements(kIds, PointsOf("0 0, 1e200 0, 0 1e200")), Succeeds());
}

TEST(CheckPlaced, NamesWhatIsUnknownAndWhatIsMissing) {
  const Point origin(0, 0);
  EXPECT_THAT(CheckPlaced(kIds, {{"stand", origin}, {"walk", origin}, {"jump", origin}}),
              Succeeds());
  EXPECT_THAT(CheckPlaced(kIds, {{"stand", origin}, {"walk", origin}, {"run", origin}}),
              FailsWith(ErrorCode::kShapeNotFound, "placements['run']"));
  EXPECT_THAT(CheckPlaced(kIds, {{"stand", origin}, {"jump", origin}}),
              FailsWith(ErrorCode::kInvalidOption, "placements['walk']"));
}

TEST(CheckId, TakesTheIdsThatItSays) {
  for (const char* id : {"a", "7", "tux", "Tux-2.b_c", "0..."}) {
    EXPECT_THAT(CheckId("session", id), Succeeds());
  }
  EXPECT_THAT(CheckId("session", std::string(63, 'a')), Succeeds());
  for (const char* id : {"", ".a", "-a", "_a", "a b", "a/b", "\xC3\xA4", "a\n"}) {
    EXPECT_THAT(CheckId("session", id), FailsWith(ErrorCode::kInvalidId, "session_id")) << id;
  }
  EXPECT_THAT(CheckId("session", std::string(64, 'a')), FailsWith(ErrorCode::kInvalidId));
  EXPECT_THAT(CheckId("session", std::string("a\0b", 3)), FailsWith(ErrorCode::kInvalidId));
}

TEST(Quoted, CutsLongTextBetweenCharacters) {
  EXPECT_EQ(Quoted("walk"), "'walk'");
  EXPECT_EQ(Quoted(std::string(1000, 'a')), "'" + std::string(63, 'a') + "...'");
  EXPECT_EQ(Quoted(std::string(62, 'a') + "\xC3\xA4\xC3\xA4"), "'" + std::string(62, 'a') + "...'");
}

}  // namespace
}  // namespace posespace
