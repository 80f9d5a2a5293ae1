// SPDX-License-Identifier: Apache-2.0
#include "mapping/boundary_matching.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "geometry/polygon.h"
#include "tests/mapping/rings.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::Gt;
using testing::HasSubstr;
using testing::Le;
using testing::SizeIs;

std::vector<MatchingShape> ShapesOf(const std::vector<Points>& outlines) {
  std::vector<MatchingShape> shapes;
  for (const Points& outline : outlines) {
    shapes.push_back({std::string(1, static_cast<char>('A' + shapes.size())), outline, {}});
  }
  return shapes;
}

MatchedOutlines Matched(const std::vector<MatchingShape>& shapes,
                        const std::vector<Landmark>& landmarks = {},
                        const MatchingOptions& options = {}) {
  auto result = MatchBoundaries(shapes, landmarks, options);
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().message);
  return std::move(result).value();
}

Error Refused(const std::vector<MatchingShape>& shapes, const std::vector<Landmark>& landmarks) {
  auto result = MatchBoundaries(shapes, landmarks);
  EXPECT_FALSE(result.has_value());
  auto checked = CheckLandmarks(shapes, landmarks);
  EXPECT_FALSE(checked.has_value());
  EXPECT_EQ(checked.error().code, result.error().code);
  EXPECT_EQ(checked.error().message, result.error().message);
  return std::move(result).error();
}

// Arc length of every row of the ring from row `start` on, in turns.
std::vector<double> PositionsFrom(const Points& ring, int start) {
  std::vector<double> positions(ring.rows());
  double length = 0.0;
  for (Eigen::Index k = 0; k < ring.rows(); ++k) {
    positions[(start + k) % ring.rows()] = length / Perimeter(ring);
    length += (RowOf(ring, start + k + 1) - RowOf(ring, start + k)).norm();
  }
  return positions;
}

// The mean distance along outline j, in turns, from where the match takes corner k of outline i to
// corner k of outline j.
double MeanError(const MatchedOutlines& match, const std::vector<Points>& outlines, int i, int j) {
  const Points &ring_i = match.outlines[i], &ring_j = match.outlines[j];
  const std::vector<double> positions = PositionsFrom(ring_j, 0);
  double sum = 0.0, weights = 0.0;
  for (Eigen::Index k = 0; k < outlines[i].rows(); ++k) {
    const int found = RowAt(ring_i, RowOf(outlines[i], k));
    const int expected = RowAt(ring_j, RowOf(outlines[j], k));
    if (found < 0 || expected < 0) return 1.0;
    const double turns = positions[found] - positions[expected];
    const double weight = (RowOf(outlines[i], k + 1) - RowOf(outlines[i], k)).norm();
    sum += weight * std::abs(turns - std::round(turns));
    weights += weight;
  }
  return sum / weights;
}

void ExpectRingsFollowOutlines(const MatchedOutlines& match,
                               const std::vector<MatchingShape>& shapes) {
  ASSERT_EQ(match.outlines.size(), shapes.size());
  for (std::size_t i = 0; i < shapes.size(); ++i) {
    const Points &ring = match.outlines[i], &outline = shapes[i].outline;
    EXPECT_EQ(ring.rows(), match.outlines[0].rows());
    EXPECT_TRUE(IsSimple(ring));
    EXPECT_GT(SignedArea(ring), 0.0);
    for (Eigen::Index k = 0; k < outline.rows(); ++k) {
      EXPECT_GE(RowAt(ring, RowOf(outline, k)), 0) << "corner " << k << " of " << i << " is lost";
    }
    for (Eigen::Index k = 0; k < ring.rows(); ++k) {
      EXPECT_LT(DistanceToRing(RowOf(ring, k), outline), 1e-9 * Perimeter(outline));
    }
  }
}

// A drawing and the same with its limbs bent about: angles and lengths change along the outline.
Points Bent(const Points& ring, double amount, std::uint32_t seed) {
  Sequence next(seed);
  const double phase_x = 6.0 * next(), phase_y = 6.0 * next();
  const double extent = ring.cwiseAbs().maxCoeff();
  Points bent = ring;
  for (Eigen::Index k = 0; k < ring.rows(); ++k) {
    bent(k, 0) += amount * extent * std::sin(3.0 * ring(k, 1) / extent + phase_x);
    bent(k, 1) += amount * extent * std::sin(3.0 * ring(k, 0) / extent + phase_y);
  }
  return bent;
}

// The rectangle used for landmarks: corners at rows 0 to 3, and a point in the middle of each side.
const Points kRectangle = PointsOf("0 0, 30 0, 60 0, 60 20, 60 40, 30 40, 0 40, 0 20");

TEST(MatchBoundaries, GivesBackASingleOutline) {
  const std::vector<MatchingShape> shapes = ShapesOf({Figure(80, 5, 100.0, 1)});
  const MatchedOutlines match = Matched(shapes);
  ExpectRingsFollowOutlines(match, shapes);
  EXPECT_EQ(match.outlines[0].rows(), 80);
  EXPECT_THAT(match.confidence, ElementsAre(1.0));
}

TEST(MatchBoundaries, FindsEachCornerOfCopiesThatStartElsewhereAtAnyScaleAndPlace) {
  const Points figure = Figure(90, 5, 100.0, 2);
  Points large = StartedAt(figure, 37) * 4096.0;
  Points small = StartedAt(figure, 71) / 4096.0;
  large.rowwise() += Eigen::RowVector2d(1e5, -3e5);
  const MatchedOutlines match = Matched(ShapesOf({figure, large, small}));
  ASSERT_EQ(match.outlines[0].rows(), 90);
  for (int r = 0; r < 90; ++r) {
    const int k = RowAt(figure, RowOf(match.outlines[0], r));
    ASSERT_GE(k, 0);
    EXPECT_EQ(RowOf(match.outlines[1], r), RowOf(large, k + 90 - 37));
    EXPECT_EQ(RowOf(match.outlines[2], r), RowOf(small, k + 90 - 71));
  }
  EXPECT_THAT(match.confidence, Each(Gt(0.9)));
}

TEST(MatchBoundaries, FollowsBentLimbs) {
  for (std::uint32_t seed = 0; seed < 12; ++seed) {
    const Points figure = Figure(120, 5, 100.0, seed);
    const std::vector<Points> outlines = {figure, Bent(figure, 0.08, seed + 50),
                                          Bent(figure, 0.08, seed + 90)};
    const std::vector<MatchingShape> shapes =
        ShapesOf({outlines[0], StartedAt(outlines[1], 31), StartedAt(outlines[2], 77)});
    const MatchedOutlines match = Matched(shapes);
    ExpectRingsFollowOutlines(match, shapes);
    for (int j = 1; j < 3; ++j) EXPECT_LT(MeanError(match, outlines, 0, j), 0.01) << seed;
  }
}

TEST(MatchBoundaries, FollowsTurnedDrawingsWhenPositionSaysNothing) {
  MatchingOptions options;
  options.position_weight = 0.0;
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const Points figure = Figure(120, 5, 100.0, seed);
    const std::vector<Points> outlines = {figure, Turned(Bent(figure, 0.05, seed), 2.0 + seed)};
    const MatchedOutlines match = Matched(ShapesOf(outlines), {}, options);
    EXPECT_LT(MeanError(match, outlines, 0, 1), 0.01) << seed;
  }
}

TEST(MatchBoundaries, KeepsEveryCornerOfOutlinesThatAreNothingAlike) {
  const std::vector<MatchingShape> shapes =
      ShapesOf({Figure(50, 3, 0.01, 1), Spiral(60, 1.5, 3.0, 2), Figure(200, 9, 1e5, 3),
                PointsOf("0 0, 4 0, 0 3")});
  ExpectRingsFollowOutlines(Matched(shapes), shapes);
}

TEST(MatchBoundaries, DoesNotDependOnTheOrderOfTheDrawings) {
  const Points figure = Figure(70, 4, 100.0, 5);
  std::vector<MatchingShape> shapes =
      ShapesOf({figure, Bent(figure, 0.05, 1), Bent(figure, 0.07, 2), Bent(figure, 0.09, 3)});
  std::vector<Landmark> landmarks = {{{RowOf(shapes[0].outline, 10), {}, {}, {}}},
                                     {{{}, RowOf(shapes[1].outline, 50), {}, {}}}};
  const MatchedOutlines match = Matched(shapes, landmarks);
  const std::vector<std::vector<int>> orders = {
      {1, 0, 2, 3}, {3, 2, 1, 0}, {2, 3, 0, 1}, {1, 2, 3, 0}, {3, 0, 2, 1}};
  for (const std::vector<int>& order : orders) {
    std::vector<MatchingShape> reordered;
    std::vector<Landmark> marks(2);
    for (const int i : order) {
      reordered.push_back(shapes[i]);
      for (int l = 0; l < 2; ++l) marks[l].points.push_back(landmarks[l].points[i]);
    }
    const MatchedOutlines again = Matched(reordered, marks);
    EXPECT_EQ(again.landmark_rows, match.landmark_rows);
    for (int k = 0; k < 4; ++k) {
      EXPECT_EQ(again.outlines[k], match.outlines[order[k]]);
      EXPECT_EQ(again.confidence[k], match.confidence[order[k]]);
    }
  }
}

TEST(MatchBoundaries, SharesRowsBetweenCornersThatLieTogether) {
  const Points figure = Figure(100, 5, 100.0, 3);
  const std::vector<MatchingShape> shapes = ShapesOf({figure, Bent(figure, 0.002, 1)});
  EXPECT_LT(Matched(shapes).outlines[0].rows(), 115);
}

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

TEST(MatchBoundaries, TellsSidesOfASquareByTheirColours) {
  const Points square = PointsOf("0 0, 5 0, 10 0, 10 5, 10 10, 5 10, 0 10, 0 5");
  Eigen::MatrixXd colours(8, 3);
  for (int k = 0; k < 8; ++k) colours.row(k) << (k < 2), (k < 4), 0.0;
  std::vector<MatchingShape> shapes = ShapesOf({square, square});
  shapes[0].colours = colours;
  shapes[1].colours.resize(8, 3);
  for (int k = 0; k < 8; ++k) shapes[1].colours.row((k + 2) % 8) = colours.row(k);
  MatchingOptions options;
  options.position_weight = 0.0;
  const MatchedOutlines match = Matched(shapes, {}, options);
  for (int k = 0; k < 8; ++k) {
    const int row = RowAt(match.outlines[0], RowOf(square, k));
    ASSERT_GE(row, 0);
    EXPECT_LT((RowOf(match.outlines[1], row) - RowOf(square, k + 2)).norm(), 0.1);
  }
}

TEST(MatchBoundaries, IgnoresColoursOfDrawingsPaintedOtherwise) {
  const Points figure = Figure(80, 5, 100.0, 7);
  std::vector<MatchingShape> plain = ShapesOf({figure, Bent(figure, 0.05, 7)});
  std::vector<MatchingShape> painted = plain;
  painted[0].colours = Eigen::MatrixXd::Constant(80, 3, 0.1);
  painted[1].colours = Eigen::MatrixXd::Constant(80, 3, 0.9);
  painted[1].colours.topRows(40).setConstant(0.6);
  const MatchedOutlines expected = Matched(plain), match = Matched(painted);
  // The drawings' own order may differ, so rows are compared by what they pair.
  ASSERT_EQ(match.outlines[0].rows(), expected.outlines[0].rows());
  for (int k = 0; k < 80; ++k) {
    const int row = RowAt(match.outlines[0], RowOf(figure, k));
    const int expected_row = RowAt(expected.outlines[0], RowOf(figure, k));
    EXPECT_LT((RowOf(match.outlines[1], row) - RowOf(expected.outlines[1], expected_row)).norm(),
              1e-9);
  }
}

TEST(MatchBoundaries, IsLessSureOfADrawingThatFacesTheOtherWay) {
  const Points figure = Figure(120, 5, 100.0, 11);
  Points mirrored = Points(figure.colwise().reverse());
  mirrored.col(0) *= -1.0;
  const MatchedOutlines match =
      Matched(ShapesOf({figure, Bent(figure, 0.02, 1), mirrored, Bent(figure, 0.02, 2)}));
  EXPECT_LT(match.confidence[2], 0.5);
  for (const int i : {0, 1, 3}) EXPECT_GT(match.confidence[i], match.confidence[2]);
  EXPECT_THAT(match.confidence, Each(AllOf(Gt(0.0), Le(1.0))));
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

TEST(MatchBoundaries, StopsWhenCancelledBeforeOrOnTheWay) {
  const std::vector<MatchingShape> shapes =
      ShapesOf({Figure(80, 5, 100.0, 1), Figure(80, 5, 100.0, 2), Figure(80, 5, 100.0, 3)});
  for (const double when : {0.0, 0.2, 0.6}) {
    Progress* running = nullptr;
    Progress progress([&](std::string_view, double fraction) {
      if (fraction >= when) running->Cancel();
    });
    running = &progress;
    const auto result = MatchBoundaries(shapes, {}, {}, &progress);
    ASSERT_FALSE(result.has_value()) << when;
    EXPECT_EQ(result.error().code, ErrorCode::kCancelled);
  }
}

TEST(MatchBoundaries, FindsTheKnownCorrespondenceOfLetterMasters) {
  const std::filesystem::path folder = ShapesFolder();
  if (folder.empty()) GTEST_SKIP() << "the development drawings are not beside the project";
  for (const std::string group : {"recursive-lc", "recursive-ls", "recursive-lw", "recursive-lz"}) {
    std::vector<Points> outlines;
    for (const auto& file : OutlineFiles(folder / "glyph" / group)) {
      outlines.push_back(OuterRing(file));
    }
    const int n = static_cast<int>(outlines.size());
    ASSERT_EQ(n, 6);
    const MatchedOutlines match = Matched(ShapesOf(outlines));
    double sum = 0.0;
    for (int i = 0; i < n; ++i) {
      for (int j = 0; j < n; ++j) sum += MeanError(match, outlines, i, j);
    }
    EXPECT_LT(sum / (n * (n - 1)), 0.02) << group;
  }
}

}  // namespace
}  // namespace posespace
