// SPDX-License-Identifier: Apache-2.0
#include "mapping/matched_places.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/mapping/matching_cases.h"
#include "tests/mapping/rings.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

TEST(SampleTogether, BeginsWhereAllOutlinesTurnMost) {
  const Points spike = PointsOf("0 0, 10 0, 10 10, 5 60, 0 10");
  Points twin = spike * 3.0;
  twin.rowwise() += Eigen::RowVector2d(7.0, -4.0);
  const auto places = SampleTogether(std::vector<Points>{spike, twin}, 16);
  ASSERT_EQ(places.size(), 2u);
  EXPECT_NEAR((RowOf(places[0], 0) - Point(5, 60)).norm(), 0.0, 1e-9);
  EXPECT_NEAR((RowOf(places[1], 0) - Point(22, 176)).norm(), 0.0, 1e-9);
}

TEST(SampleTogether, SpacesPlacesEvenlyAlongCopies) {
  const Points figure = Figure(80, 5, 100.0, 4);
  const auto places = SampleTogether(std::vector<Points>{figure, figure * 0.01}, 200);
  ASSERT_EQ(places[0].rows(), 200);
  EXPECT_LT((places[0] * 0.01 - places[1]).norm(), 1e-9);
  for (int k = 0; k < 200; ++k) {
    EXPECT_LT(DistanceToRing(RowOf(places[0], k), figure), 1e-9);
    EXPECT_LT((RowOf(places[0], k + 1) - RowOf(places[0], k)).norm(),
              Perimeter(figure) / 200 + 1e-9);
  }
}

TEST(SampleTogether, DoesNotDependOnTheOrderOfTheOutlines) {
  const Points figure = Figure(80, 5, 100.0, 4);
  const std::vector<Points> outlines = {figure, Bent(figure, 0.1, 1), Bent(figure, 0.1, 2)};
  const auto places = SampleTogether(outlines, 50);
  const auto again = SampleTogether(std::vector<Points>{outlines[2], outlines[0], outlines[1]}, 50);
  EXPECT_EQ(again[0], places[2]);
  EXPECT_EQ(again[1], places[0]);
  EXPECT_EQ(again[2], places[1]);
}

TEST(SampleTogether, GivesASinglePlace) {
  const auto places = SampleTogether(std::vector<Points>{PointsOf("0 0, 4 0, 0 3")}, 1);
  EXPECT_EQ(places[0].rows(), 1);
}

}  // namespace
}  // namespace posespace
