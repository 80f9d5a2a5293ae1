// SPDX-License-Identifier: Apache-2.0
#include "mapping/boundary_matching.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "tests/mapping/articulated_figures.h"
#include "tests/mapping/matching_cases.h"
#include "tests/mapping/rings.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

using testing::AllOf;
using testing::Each;
using testing::ElementsAre;
using testing::Gt;
using testing::Le;

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

TEST(MatchBoundaries, SeesThatADrawingIsACopyTurnedByAQuarter) {
  for (const double turn : {1.2, 1.6, -1.6, 2.0}) {
    const Points figure = Figure(120, 5, 100.0, 3);
    const std::vector<Points> outlines = {figure, Turned(Bent(figure, 0.01, 1), turn)};
    EXPECT_LT(MeanError(Matched(ShapesOf(outlines)), outlines, 0, 1), 0.01) << turn;
  }
}

TEST(MatchBoundaries, FollowsArticulatedPairsAtAnyRotationFromAnyStart) {
  constexpr int kPairs = 60;
  constexpr double kWrong = 0.03;  // turns; a start at another limb is off by 0.2
  int right = 0;
  double sum = 0.0;
  for (int seed = 0; seed < kPairs; ++seed) {
    Random random(seed);
    const std::vector<Points> poses = ArticulatedPoses(random, 2);
    const Points turned = Turned(poses[1], 2.0 * std::numbers::pi * Uniform(random));
    const int start = static_cast<int>(Uniform(random) * static_cast<double>(turned.rows()));
    const MatchedOutlines match =
        Matched(ShapesOf({poses[0], StartedAt(turned, start)}), {}, ForAnyRotation());
    const double error = MeanError(match, {poses[0], turned}, 0, 1);
    if (error >= kWrong) continue;
    ++right;
    sum += error;
  }
  EXPECT_GE(right, 0.95 * kPairs);
  EXPECT_LE(sum / right, 0.002);
}

TEST(MatchBoundaries, FindsTheKnownCorrespondenceOfGlyphMastersUprightAndTurned) {
  for (const bool turned : {false, true}) {
    double sum = 0.0;
    int pairs = 0;
    for (int seed = 0; seed < 10; ++seed) {
      Random random(seed);
      std::vector<Points> masters = GlyphMasters(random, 3);
      if (turned) masters[1] = Turned(masters[1], 6.0 * Uniform(random));
      const MatchedOutlines match =
          Matched(ShapesOf(masters), {}, turned ? ForAnyRotation() : MatchingOptions());
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
          if (i == j) continue;
          sum += MeanError(match, masters, i, j);
          ++pairs;
        }
      }
    }
    EXPECT_LE(sum / pairs, 0.01) << (turned ? "turned" : "upright");
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

TEST(MatchBoundaries, TakesARaisedTailForAHangingOneAndNotForAThigh) {
  const TailedPair pair = RaisedAndHangingTail();
  for (const bool swapped : {false, true}) {
    const int up = swapped ? 1 : 0, down = 1 - up;
    std::vector<Points> outlines(2);
    outlines[up] = pair.raised;
    outlines[down] = StartedAt(pair.hanging, 7);
    const MatchedOutlines match = Matched(ShapesOf(outlines));
    ExpectRingsFollowOutlines(match, ShapesOf(outlines));
    const int tip = RowAt(match.outlines[up], pair.raised_tip);
    ASSERT_GE(tip, 0);
    EXPECT_LT((RowOf(match.outlines[down], tip) - pair.hanging_tip).norm(), 12.0);
    EXPECT_THAT(match.confidence, Each(Gt(0.5)));
    EXPECT_THAT(match.proposal.flips, Each(false));
  }
}

TEST(MatchBoundaries, KeepsLeftLimbsLeftThoughTheRightOnesAreMoreAlike) {
  // The left arm is short and thick and the right one long and thin, then the other way about.
  const Points first = PointsOf(
      "-10 -40, 10 -40, 10 -20, 60 -20, 60 -14, 10 -14, 10 40, -10 40, -10 -6,"
      "-35 -6, -35 -22, -10 -22");
  const Points second = Mirrored(first);
  const MatchedOutlines match = Matched(ShapesOf({first, second}));
  const int tip = RowAt(match.outlines[0], {60.0, -20.0});
  ASSERT_GE(tip, 0);
  EXPECT_GT(RowOf(match.outlines[1], tip).x(), 10.0);  // where the body ends
}

TEST(MatchBoundaries, IsLessSureOfADrawingThatFacesTheOtherWay) {
  const Points figure = Figure(120, 5, 100.0, 11);
  const MatchedOutlines match =
      Matched(ShapesOf({figure, Bent(figure, 0.02, 1), Mirrored(figure), Bent(figure, 0.02, 2)}));
  EXPECT_LT(match.confidence[2], 0.5);
  for (const int i : {0, 1, 3}) EXPECT_GT(match.confidence[i], match.confidence[2]);
  EXPECT_THAT(match.confidence, Each(AllOf(Gt(0.0), Le(1.0))));
}

TEST(MatchBoundaries, ProposesToFlipTheFewWhichFaceTheOtherWay) {
  const Points figure = Figure(120, 5, 100.0, 11);
  const std::vector<Points> outlines = {Bent(figure, 0.02, 1), Mirrored(Bent(figure, 0.02, 2)),
                                        Bent(figure, 0.02, 3), Bent(figure, 0.02, 4),
                                        Mirrored(Bent(figure, 0.02, 5))};
  const FlipProposal proposal = Matched(ShapesOf(outlines)).proposal;
  EXPECT_THAT(proposal.flips, ElementsAre(false, true, false, false, true));
  EXPECT_GT(proposal.gain, 1.05);
}

TEST(MatchBoundaries, ProposesNoFlipOfDrawingsThatFaceAlikeOrAreMarked) {
  const Points figure = Figure(120, 5, 100.0, 11);
  const std::vector<Points> alike = {figure, Bent(figure, 0.03, 1), Bent(figure, 0.03, 2)};
  const std::vector<Points> opposed = {figure, Mirrored(figure), Bent(figure, 0.03, 2)};
  const std::vector<Landmark> mark = {{{RowOf(figure, 0), RowOf(opposed[1], 0), {}}}};
  for (const MatchedOutlines& match :
       {Matched(ShapesOf(alike)), Matched(ShapesOf(opposed), mark)}) {
    EXPECT_THAT(match.proposal.flips, ElementsAre(false, false, false));
    EXPECT_EQ(match.proposal.gain, 1.0);
  }
}

TEST(MatchBoundaries, SaysWhichDrawingsHaveMuchWithoutCounterpart) {
  // The same block with a long spike at its left and at its right, and marks that keep to the
  // block.
  const Points left = PointsOf("0 0, 100 0, 100 40, 20 40, 15 140, 10 40, 0 40");
  const Points right = PointsOf("0 0, 100 0, 100 40, 90 40, 85 140, 80 40, 0 40");
  std::vector<Landmark> marks;
  for (const double x : {10.0, 20.0, 80.0, 90.0}) {
    marks.push_back({{Point(x, 40), Point(x, 40), Point(x, 40)}});
  }
  const MatchedOutlines match = Matched(ShapesOf({left, left, right}), marks);
  ASSERT_TRUE(match.mismatch.has_value());
  EXPECT_EQ(match.mismatch->second, 2);
  EXPECT_GT(match.mismatch->share, 0.3);
  EXPECT_LT(match.mismatch->share, 0.9);
  EXPECT_THAT(match.mismatch->landmarks, testing::AnyOf(ElementsAre(0, 1), ElementsAre(2, 3)));
}

TEST(MatchBoundaries, FindsACounterpartForEverythingInBentCopies) {
  const Points figure = Figure(120, 5, 100.0, 8);
  EXPECT_FALSE(Matched(ShapesOf({figure, Bent(figure, 0.08, 1), Bent(figure, 0.08, 2)}))
                   .mismatch.has_value());
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

TEST(MatchBoundaries, RefusesOutlinesOfMorePointsThanItCanMatch) {
  std::vector<MatchingShape> shapes = ShapesOf({Figure(80, 5, 100.0, 1), Figure(80, 5, 100.0, 2)});
  shapes[1].name = "long";
  shapes[1].outline = Points::Random(100'001, 2);
  const auto result = MatchBoundaries(shapes);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::kOutlineTooLong);
  EXPECT_THAT(result.error().message, ::testing::HasSubstr("'long' 100001"));
  EXPECT_THAT(result.error().message, ::testing::HasSubstr("100000"));
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
    EXPECT_LT(sum / (n * (n - 1)), 0.01) << group;
  }
}

}  // namespace
}  // namespace posespace
