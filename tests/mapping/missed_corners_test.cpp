// SPDX-License-Identifier: Apache-2.0
#include "mapping/missed_corners.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "geometry/polygon.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

// The point `position` turns around a square of side 100 from its corner at the origin.
Point OnSquare(double position) {
  const double way = 400.0 * (position - std::floor(position));
  const int side = static_cast<int>(way / 100.0);
  const double along = way - 100.0 * side;
  const std::vector<Point> from = {{0, 0}, {100, 0}, {100, 100}, {0, 100}};
  const std::vector<Point> ahead = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
  return from[side] + along * ahead[side];
}

// Two squares in correspondence: rows at the corners of both, where corner k of the second lies
// `offsets[k]` turns after that of the first.
std::vector<Points> Squares(const std::vector<double>& offsets) {
  std::vector<Points> squares(2, Points(8, 2));
  for (int k = 0; k < 4; ++k) {
    const double corner = 0.25 * k;
    squares[0].row(2 * k) = OnSquare(corner).transpose();
    squares[1].row(2 * k) = OnSquare(corner - offsets[k]).transpose();
    squares[0].row(2 * k + 1) = OnSquare(corner + offsets[k]).transpose();
    squares[1].row(2 * k + 1) = OnSquare(corner).transpose();
  }
  return squares;
}

TEST(FindMissedCorners, NamesDrawingsWhoseCornersLieBesideEachOther) {
  const std::vector<Points> squares = Squares({0.04, 0.04, 0.04, 0.04});
  const auto missed = FindMissedCorners(std::vector<Points>{squares[0], squares[1]});
  ASSERT_TRUE(missed.has_value());
  EXPECT_EQ(missed->first, 0);
  EXPECT_EQ(missed->second, 1);
  EXPECT_EQ(missed->count, 4);
  EXPECT_LT((missed->on_first - missed->on_second).norm(), 1.0);
}

TEST(FindMissedCorners, FindsNoneWhereCornersLieTogetherOrHaveNoLikeNearby) {
  EXPECT_FALSE(FindMissedCorners(Squares({0.002, 0.002, 0.002, 0.002})).has_value());
  EXPECT_FALSE(FindMissedCorners(Squares({0.08, 0.08, 0.08, 0.08})).has_value());
}

TEST(FindMissedCorners, CallsMoreThanAThirdMany) {
  EXPECT_FALSE(FindMissedCorners(Squares({0.04, 0.002, 0.002, 0.002})).has_value());
  const auto two = FindMissedCorners(Squares({0.04, 0.002, 0.04, 0.002}));
  ASSERT_TRUE(two.has_value());
  EXPECT_EQ(two->count, 2);
}

TEST(FindMissedCorners, FindsNoneInOneDrawing) {
  EXPECT_FALSE(FindMissedCorners(std::vector<Points>{Squares({0.04, 0.04, 0.04, 0.04})[0]}));
}

}  // namespace
}  // namespace posespace
