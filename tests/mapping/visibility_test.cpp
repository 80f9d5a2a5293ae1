// SPDX-License-Identifier: Apache-2.0
#include "mapping/visibility.h"

#include <gtest/gtest.h>

#include "geometry/polygon.h"
#include "tests/mapping/outline_families.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

// A comb of two teeth: 0 and 1 the back, 2 3 4 and 4 5 6 the teeth's rows.
const Points kComb = PointsOf("0 0, 8 0, 8 6, 6 2, 4 6, 2 2, 0 6");

TEST(Visibility, RowsSeeEachOtherAcrossTheInsideOnly) {
  EXPECT_TRUE(RowSeesRow(kComb, 0, 3));
  EXPECT_TRUE(RowSeesRow(kComb, 5, 3));
  EXPECT_FALSE(RowSeesRow(kComb, 2, 4));  // over the notch, outside
  EXPECT_FALSE(RowSeesRow(kComb, 2, 6));  // through both notches
  EXPECT_FALSE(RowSeesRow(kComb, 0, 1));  // a side
  EXPECT_FALSE(RowSeesRow(kComb, 3, 3));
}

TEST(Visibility, ARowOnTheWayHidesWhatIsBehindIt) {
  const Points ring = PointsOf("0 0, 2 0, 4 0, 4 4, 2 2, 0 4");
  EXPECT_FALSE(RowSeesRow(ring, 0, 2));  // along the side
  EXPECT_FALSE(RowSeesRow(ring, 0, 3));  // over row 4
  EXPECT_TRUE(RowSeesRow(ring, 1, 4));
  EXPECT_FALSE(RowSeesPoint(ring, 0, Point(3, 3)));
  EXPECT_FALSE(PointSeesPoint(ring, Point(1, 1), Point(3, 3)));
  EXPECT_TRUE(PointSeesPoint(ring, Point(1, 1), Point(3, 1)));
  EXPECT_FALSE(PointSeesPoint(kComb, Point(0.5, 4), Point(7.5, 4)));
}

TEST(Visibility, IsMutualAndThatOfDiagonals) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    const Points ring = DrawOutlines(OutlineFamilies()[seed % 7], seed, 1, 18)[0];
    int diagonals = 0;
    for (int i = 0; i < 18; ++i) {
      for (int j = 0; j < i; ++j) {
        const bool sees = RowSeesRow(ring, i, j);
        EXPECT_EQ(sees, RowSeesRow(ring, j, i)) << "rows " << i << ' ' << j << " seed " << seed;
        if (!sees) continue;
        ++diagonals;
        // Both sides of the cut are simple.
        Points side(i - j + 1, 2);
        side = ring.middleRows(j, i - j + 1);
        EXPECT_TRUE(IsSimple(side));
        EXPECT_GT(SignedArea(side), 0.0);
      }
    }
    EXPECT_GE(diagonals, 15);  // those of a triangulation
  }
}

}  // namespace
}  // namespace posespace
