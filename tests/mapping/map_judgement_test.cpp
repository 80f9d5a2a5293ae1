// SPDX-License-Identifier: Apache-2.0
#include "mapping/map_judgement.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/mapping/matching_cases.h"
#include "tests/mapping/rings.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

OutlineCurve CurveOf(const Points& ring, const Eigen::MatrixXd& colours = {}) {
  OutlineCurve curve(ring, colours);
  curve.MeasureThickness();
  return curve;
}

// Each position to itself, in steps of 1/64.
OutlineMap Even(double shift = 0.0) {
  std::vector<double> from, to;
  for (int k = 0; k <= 64; ++k) {
    from.push_back(k / 64.0);
    to.push_back(k / 64.0 + shift);
  }
  return {from, to};
}

TEST(JudgeMap, IsZeroForTheSameDrawingAtAnyScaleAndPlace) {
  const Points ring = Figure(80, 5, 100.0, 1);
  Points copy = 40.0 * ring;
  copy.rowwise() += Eigen::RowVector2d(3e4, -1e3);
  EXPECT_NEAR(JudgeMap(CurveOf(ring), CurveOf(copy), Even(), 0.0), 0.0, 1e-9);
}

TEST(JudgeMap, IsTheSameSeenFromTheOtherDrawing) {
  const OutlineCurve a = CurveOf(Figure(80, 5, 100.0, 1)), b = CurveOf(Figure(90, 4, 10.0, 2));
  const OutlineMap map({0.0, 0.3, 0.5, 0.8, 1.0}, {0.1, 0.25, 0.6, 0.9, 1.1});
  EXPECT_NEAR(JudgeMap(a, b, map, 0.0), JudgeMap(b, a, map.Inverse(), 0.0), 1e-12);
}

TEST(JudgeMap, CountsAPlaceThatMovedFarHardlyMoreThanOneThatMoved) {
  const Points body = PointsOf("0 0, 40 0, 40 60, 0 60");
  const auto turned = [&](double shift) {
    return JudgeMap(CurveOf(body), CurveOf(body), Even(shift), 0.0);
  };
  // Every place moves by 1/16 of a turn, and by half a turn: seven times as far on average.
  EXPECT_GT(turned(1.0 / 16), 0.02);
  EXPECT_LT(turned(0.5), 5.0 * turned(1.0 / 16));
}

TEST(JudgeMap, CountsColoursOnlyWhenTheyAreWeighted) {
  const Points ring = Figure(60, 5, 100.0, 3);
  const OutlineCurve red = CurveOf(ring, Eigen::RowVector3d(1, 0, 0).replicate(60, 1));
  const OutlineCurve blue = CurveOf(ring, Eigen::RowVector3d(0, 0, 1).replicate(60, 1));
  EXPECT_NEAR(JudgeMap(red, blue, Even(), 0.0), 0.0, 1e-9);
  EXPECT_NEAR(JudgeMap(red, blue, Even(), 0.3), 0.6, 1e-9);
}

TEST(JudgeMap, CountsUnevenStretching) {
  const Points ring = PointsOf("0 0, 40 0, 40 40, 0 40");
  const OutlineMap uneven({0.0, 0.1, 1.0}, {0.0, 0.2, 1.0});
  const OutlineMap even({0.0, 0.1, 1.0}, {0.0, 0.1, 1.0});
  const OutlineCurve curve = CurveOf(ring);
  EXPECT_GT(JudgeMap(curve, curve, uneven, 0.0), JudgeMap(curve, curve, even, 0.0));
}

}  // namespace
}  // namespace posespace
