// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "mapping/boundary_matching.h"
#include "tests/mapping/matching_cases.h"
#include "tests/mapping/rings.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::SizeIs;

Error Refused(const std::vector<MatchingShape>& shapes, const std::vector<Landmark>& landmarks) {
  auto result = MatchBoundaries(shapes, landmarks);
  EXPECT_FALSE(result.has_value());
  auto checked = CheckLandmarks(shapes, landmarks);
  EXPECT_FALSE(checked.has_value());
  EXPECT_EQ(checked.error().code, result.error().code);
  EXPECT_EQ(checked.error().message, result.error().message);
  return std::move(result).error();
}

// Corners at even rows, and the middle of each side between them.
const Points kRectangle = PointsOf("0 0, 30 0, 60 0, 60 20, 60 40, 30 40, 0 40, 0 20");

TEST(MatchBoundaries, MeetsEveryLandmarkAtTheOutlinePointNearestToIt) {
  const Points figure = Figure(90, 5, 100.0, 4);
  const std::vector<MatchingShape> shapes = ShapesOf({figure, Bent(figure, 0.1, 4)});
  // A corner of A with a point on an edge of B, and the other way round, both marked a little off.
  const Point a_edge = 0.4 * RowOf(figure, 60) + 0.6 * RowOf(figure, 61);
  const Point b_edge = 0.7 * RowOf(shapes[1].outline, 22) + 0.3 * RowOf(shapes[1].outline, 23);
  const Point outward = 0.5 * RowOf(figure, 20).normalized();
  const std::vector<Landmark> landmarks = {
      {{RowOf(figure, 20), b_edge}},
      {{a_edge + outward, RowOf(shapes[1].outline, 64)}},
  };
  const MatchedOutlines match = Matched(shapes, landmarks);
  ExpectRingsFollowOutlines(match, shapes);
  ASSERT_THAT(match.landmark_rows, SizeIs(2));
  const auto at = [&](int drawing, int landmark) {
    return RowOf(match.outlines[drawing], match.landmark_rows[landmark]);
  };
  EXPECT_EQ(at(0, 0), RowOf(figure, 20));
  EXPECT_LT((at(1, 0) - b_edge).norm(), 1e-9);
  EXPECT_EQ(at(1, 1), RowOf(shapes[1].outline, 64));
  const Point mark = *landmarks[1].points[0];
  EXPECT_NEAR((at(0, 1) - mark).norm(), DistanceToRing(mark, figure), 1e-9);
}

TEST(MatchBoundaries, FindsLandmarksOnDrawingsThatDoNotMarkThem) {
  const Points figure = Figure(120, 5, 100.0, 6);
  std::vector<Points> outlines = {figure, Bent(figure, 0.05, 1), Bent(figure, 0.06, 2),
                                  Bent(figure, 0.07, 3), Bent(figure, 0.04, 4)};
  const std::vector<MatchingShape> shapes = ShapesOf(outlines);
  const auto mark = [&](int drawing, int corner) { return RowOf(outlines[drawing], corner); };
  const std::vector<Landmark> landmarks = {{{mark(0, 12), {}, {}, {}, mark(4, 12)}},
                                           {{{}, {}, mark(2, 90), {}, {}}},
                                           {{{}, mark(1, 36), {}, mark(3, 36), {}}},
                                           {{{}, {}, {}, {}, mark(4, 60)}},
                                           {{{}, {}, mark(2, 108), mark(3, 108), {}}}};
  const std::vector<int> corners = {12, 90, 36, 60, 108};
  const MatchedOutlines match = Matched(shapes, landmarks);
  ExpectRingsFollowOutlines(match, shapes);
  for (std::size_t l = 0; l < landmarks.size(); ++l) {
    for (int i = 0; i < 5; ++i) {
      const Point found = RowOf(match.outlines[i], match.landmark_rows[l]);
      const double off = (found - mark(i, corners[l])).norm() / Perimeter(outlines[i]);
      EXPECT_LT(off, landmarks[l].points[i] ? 1e-12 : 0.02) << "landmark " << l << " on " << i;
    }
  }
}

TEST(MatchBoundaries, TurnsDrawingsThatTwoLandmarksShowTurned) {
  // Two squares, one turned by a quarter as the marks say: shape and position would not turn it.
  const Points square = PointsOf("0 0, 10 0, 10 10, 0 10");
  const MatchedOutlines match = Matched(
      ShapesOf({square, square}), {{{Point(0, 0), Point(10, 0)}}, {{Point(10, 10), Point(0, 10)}}});
  ASSERT_EQ(match.outlines[0].rows(), 4);
  for (int k = 0; k < 4; ++k) {
    const int row = RowAt(match.outlines[0], RowOf(square, k));
    ASSERT_GE(row, 0);
    EXPECT_EQ(RowOf(match.outlines[1], row), RowOf(square, k + 1));
  }
}

TEST(MatchBoundaries, FollowsLimbsTurnedUpsideDownOnceTwoLandmarksShowIt) {
  const Points figure = Figure(120, 5, 100.0, 3);
  const std::vector<Points> outlines = {figure, Turned(Bent(figure, 0.06, 3), 3.0)};
  const MatchedOutlines match =
      Matched(ShapesOf(outlines), {{{RowOf(outlines[0], 12), RowOf(outlines[1], 12)}},
                                   {{RowOf(outlines[0], 60), RowOf(outlines[1], 60)}}});
  EXPECT_LT(MeanError(match, outlines, 0, 1), 0.01);
}

TEST(MatchBoundaries, GivesTuplesThatMarkOnePlaceOneRow) {
  const std::vector<MatchingShape> shapes = ShapesOf({kRectangle, kRectangle, kRectangle});
  const MatchedOutlines match = Matched(shapes, {{{Point(0, 0), Point(0, 0), {}}},
                                                 {{Point(-0.1, -0.1), {}, Point(0, 0)}},
                                                 {{Point(60, 40), {}, {}}}});
  EXPECT_EQ(match.landmark_rows[0], match.landmark_rows[1]);
  EXPECT_NE(match.landmark_rows[0], match.landmark_rows[2]);
  ExpectRingsFollowOutlines(match, shapes);
}

TEST(MatchBoundaries, RefusesALandmarkThatIsNotFiniteAndNamesIt) {
  const Error error = Refused(ShapesOf({kRectangle, kRectangle}),
                              {{{Point(0, 0), Point(0, 0)}}, {{{}, Point(NAN, 0)}}});
  EXPECT_EQ(error.code, ErrorCode::kLandmarkNotFinite);
  ASSERT_THAT(error.where, SizeIs(1));
  EXPECT_EQ(error.where[0].field, "tuples[1].points['B']");
}

TEST(MatchBoundaries, RefusesATupleThatMarksNothing) {
  EXPECT_EQ(Refused(ShapesOf({kRectangle, kRectangle}), {{{{}, {}}}}).code,
            ErrorCode::kLandmarkNotFinite);
}

TEST(MatchBoundaries, RefusesLandmarksOffTheOutlineAllAtOnceWithDistanceAndLimit) {
  // The limit is 5 % of the drawing's size: sqrt(2400) * 0.05 = 2.449 px.
  const Error error =
      Refused(ShapesOf({kRectangle, kRectangle}),
              {{{Point(30, 20), Point(0, 0)}}, {{Point(-2.4, 20), Point(-2.5, 20)}}});
  EXPECT_EQ(error.code, ErrorCode::kLandmarkOffOutline);
  ASSERT_THAT(error.where, SizeIs(2));
  EXPECT_EQ(error.where[0].field, "tuples[0].points['A']");
  EXPECT_EQ(error.where[1].field, "tuples[1].points['B']");
  EXPECT_THAT(error.message, AllOf(HasSubstr("tuple 0 is 20 px"), HasSubstr("shape 'A'"),
                                   HasSubstr("tuple 1 is 2.5 px"), HasSubstr("limit 2.449")));
}

TEST(MatchBoundaries, RefusesContradictingOrdersNamingLandmarksAndDrawingsForEveryPair) {
  const auto at = [](int row) { return RowOf(kRectangle, row); };
  // Along C tuples 1 and 2 have changed places.
  const Error error =
      Refused(ShapesOf({kRectangle, kRectangle, kRectangle}), {{{at(0), at(0), at(0)}},
                                                               {{at(2), at(2), at(4)}},
                                                               {{at(4), at(4), at(2)}},
                                                               {{at(6), at(6), at(6)}}});
  EXPECT_EQ(error.code, ErrorCode::kLandmarksOutOfOrder);
  ASSERT_THAT(error.where, SizeIs(2));  // A with C, B with C
  EXPECT_THAT(error.message, AllOf(HasSubstr("'A'"), HasSubstr("'B'"), HasSubstr("'C'")));
  for (const Violation& violation : error.where) {
    EXPECT_THAT(violation.description,
                AllOf(HasSubstr("tuple"), HasSubstr("1"), HasSubstr("2"), HasSubstr("shape 'C'")));
    EXPECT_THAT(violation.field, HasSubstr("points['C']"));
  }
}

TEST(MatchBoundaries, RefusesOnePlaceThatIsTwoElsewhere) {
  const auto at = [](int row) { return RowOf(kRectangle, row); };
  const Error error =
      Refused(ShapesOf({kRectangle, kRectangle}), {{{at(0), at(0)}}, {{at(0), at(3)}}});
  EXPECT_EQ(error.code, ErrorCode::kLandmarksOutOfOrder);
  ASSERT_THAT(error.where, SizeIs(1));
  EXPECT_EQ(error.where[0].field, "tuples[1].points['B']");
}

TEST(MatchBoundaries, RefusesAnOrderThatOnlyThreeDrawingsTogetherContradict) {
  const auto at = [](int row) { return RowOf(kRectangle, row); };
  const Error error = Refused(
      ShapesOf({kRectangle, kRectangle, kRectangle}),
      {{{at(0), at(0), at(0)}}, {{at(2), {}, at(4)}}, {{at(4), at(2), {}}}, {{{}, at(4), at(2)}}});
  EXPECT_EQ(error.code, ErrorCode::kLandmarksOutOfOrder);
}

TEST(MatchBoundaries, TakesMarksThatAgreeWhereverTheOutlineBegins) {
  const std::vector<MatchingShape> shapes = ShapesOf({kRectangle, StartedAt(kRectangle, 5)});
  std::vector<Landmark> landmarks;
  for (int k = 0; k < 8; ++k) {
    landmarks.push_back({{RowOf(kRectangle, k), RowOf(kRectangle, k)}});
  }
  EXPECT_TRUE(CheckLandmarks(shapes, landmarks).has_value());
  EXPECT_EQ(Matched(shapes, landmarks).outlines[0].rows(), 8);
}

}  // namespace
}  // namespace posespace
