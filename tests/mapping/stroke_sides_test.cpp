// SPDX-License-Identifier: Apache-2.0
#include "mapping/stroke_sides.h"

#include <gtest/gtest.h>

#include <cmath>

#include "mapping/outline_map.h"
#include "tests/mapping/matching_cases.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

OutlineCurve CurveOf(const Points& ring) { return {ring, {}}; }

// A bar along x, `width` thick and 100 long: its perimeter is 200 + 2 width.
Points Bar(double width) {
  Points bar(4, 2);
  bar << 0.0, 0.0, 100.0, 0.0, 100.0, width, 0.0, width;
  return bar;
}

TEST(StrokeSides, FindThePlaceStraightAcross) {
  const OutlineCurve bar = CurveOf(Bar(2.0));
  const StrokeSides sides(bar);
  ASSERT_GT(sides.share(), 0.8);
  for (double x = 10.0; x < 90.0; x += 3.7) {
    const auto across = sides.Across(x / bar.perimeter());
    ASSERT_TRUE(across.has_value()) << x;
    EXPECT_LT((bar.At(*across) - Point(x, 2.0)).norm(), 0.1) << x;
  }
}

TEST(StrokeSides, EndAtTipsAndWhereADrawingIsNotThin) {
  const OutlineCurve thin = CurveOf(Bar(2.0));
  EXPECT_FALSE(StrokeSides(thin).Across(thin.NearestTo(Point(100, 1)).position).has_value());
  EXPECT_GT(StrokeSides(CurveOf(Bar(6.0))).share(), 0.7);
  EXPECT_EQ(StrokeSides(CurveOf(Bar(6.8))).share(), 0.0);
}

TEST(StrokeSides, AreNotTheTwoBanksOfAGap) {
  // A U whose legs, each 20 thick, are 1 apart.
  const Points u = PointsOf("0 0, 20 0, 20 60, 21 60, 21 0, 41 0, 41 80, 0 80");
  const OutlineCurve curve = CurveOf(SignedArea(u) > 0 ? u : Points(u.colwise().reverse()));
  EXPECT_FALSE(StrokeSides(curve).Across(curve.NearestTo(Point(20, 30)).position).has_value());
}

// How far, in turns, the sides of a stroke slip past each other: the mean distance of the place
// across from a row's match to the match of the place across.
double MeanSlip(const MatchedOutlines& match) {
  const OutlineCurve a = CurveOf(match.outlines[0]), b = CurveOf(match.outlines[1]);
  const StrokeSides sides_a(a), sides_b(b);
  const OutlineMap map = MapBetween(a, b);
  double sum = 0.0;
  int count = 0;
  for (int k = 0; k < 400; ++k) {
    const double position = k / 400.0;
    const auto across_a = sides_a.Across(position), across_b = sides_b.Across(map.At(position));
    if (!across_a || !across_b) continue;
    const double turns = map.At(*across_a) - *across_b;
    sum += std::abs(turns - std::round(turns));
    ++count;
  }
  return count > 0 ? sum / count : 1.0;
}

// A wavy stroke along x of a given thickness, with corners every 2 px on both sides.
Points Stroke(double thickness, double wave) {
  Points ring(202, 2);
  for (int k = 0; k <= 100; ++k) {
    const double y = wave * std::sin(0.06 * k);
    ring.row(k) << 2.0 * k, y;
    ring.row(201 - k) << 2.0 * k, y + thickness;
  }
  return ring;
}

TEST(MatchBoundaries, KeepsTheTwoSidesOfAThinStrokeTogether) {
  for (const double wave : {2.0, 10.0, 25.0}) {
    const MatchedOutlines match = Matched(ShapesOf({Stroke(3.0, wave), Stroke(7.0, -wave)}));
    EXPECT_LT(MeanSlip(match), 0.006) << wave;
  }
}

}  // namespace
}  // namespace posespace
