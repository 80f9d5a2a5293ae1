// SPDX-License-Identifier: Apache-2.0
#include "mapping/boundary_simplification.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>

#include "geometry/polygon.h"
#include "tests/mapping/rings.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

using testing::ElementsAre;

SimplifiedOutlines Simplified(const std::vector<Points>& outlines,
                              const std::vector<int>& landmarks = {}, double tolerance = 0.03) {
  auto result = SimplifyBoundaries(outlines, landmarks, {.tolerance = tolerance});
  EXPECT_TRUE(result.has_value());
  return std::move(result).value();
}

void ExpectEnclosure(const Points& simplified, const Points& original, double tolerance) {
  EXPECT_TRUE(IsSimple(simplified));
  EXPECT_GT(SignedArea(simplified), 0.0);
  EXPECT_TRUE(Encloses(simplified, original));
  const double limit = tolerance * std::sqrt(SignedArea(original)) * (1.0 + 1e-9);
  EXPECT_LE(FarthestFrom(simplified, original), limit);
  EXPECT_LE(FarthestFrom(original, simplified), limit);
}

class SimplifyFigures : public testing::TestWithParam<std::tuple<int, double>> {};

TEST_P(SimplifyFigures, EnclosesEveryOutlineWithinToleranceWithFewerRows) {
  const auto [count, tolerance] = GetParam();
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    std::vector<Points> outlines;
    for (int i = 0; i < count; ++i) outlines.push_back(Figure(160, 5, 100.0, 100 * seed + i));
    const SimplifiedOutlines result = Simplified(outlines, {}, tolerance);
    ASSERT_EQ(result.outlines.size(), outlines.size());
    EXPECT_LT(result.outlines[0].rows(), 90);
    for (int i = 0; i < count; ++i) {
      EXPECT_EQ(result.outlines[i].rows(), result.outlines[0].rows());
      ExpectEnclosure(result.outlines[i], outlines[i], tolerance);
    }
  }
}

INSTANTIATE_TEST_SUITE_P(CountsAndTolerances, SimplifyFigures,
                         testing::Combine(testing::Values(1, 2, 4), testing::Values(0.02, 0.05)));

TEST(SimplifyBoundaries, KeepsTheGapsOfAWoundUpStripOpen) {
  for (const double roughness : {0.0, 1.0, 9.0}) {
    const Points spiral = Spiral(150, 2.5, roughness, 3);
    ASSERT_TRUE(IsSimple(spiral));
    for (const double tolerance : {0.02, 0.2, 1.0}) {
      const SimplifiedOutlines result = Simplified({spiral}, {}, tolerance);
      EXPECT_LT(result.outlines[0].rows(), 200);
      ExpectEnclosure(result.outlines[0], spiral, tolerance);
    }
  }
}

TEST(SimplifyBoundaries, EnclosesOutlinesThatAreNothingAlike) {
  const std::vector<Points> outlines = {Figure(120, 3, 50.0, 1), Spiral(60, 1.5, 4.0, 2),
                                        Figure(120, 9, 5000.0, 3)};
  const SimplifiedOutlines result = Simplified(outlines);
  for (int i = 0; i < 3; ++i) ExpectEnclosure(result.outlines[i], outlines[i], 0.03);
}

TEST(SimplifyBoundaries, LeavesOnlyTheCornersOfASquareWithManyPoints) {
  std::string text;
  for (int k = 0; k < 40; ++k) text += std::to_string(k) + " 0, ";
  for (int k = 0; k < 40; ++k) text += "40 " + std::to_string(k) + ", ";
  for (int k = 40; k > 0; --k) text += std::to_string(k) + " 40, ";
  for (int k = 40; k > 0; --k) text += "0 " + std::to_string(k) + ", ";
  const Points square = PointsOf(text);
  const SimplifiedOutlines result = Simplified({square, square});
  EXPECT_EQ(result.outlines[0].rows(), 4);
  EXPECT_NEAR(SignedArea(result.outlines[0]), 1600.0, 1e-3);
}

TEST(SimplifyBoundaries, NeverMovesOrDropsALandmark) {
  const std::vector<Points> outlines = {Figure(160, 5, 100.0, 1), Figure(160, 5, 100.0, 2)};
  const std::vector<int> landmarks = {159, 0, 1, 40, 77, 40};
  const SimplifiedOutlines result = Simplified(outlines, landmarks, 0.1);
  ASSERT_EQ(result.landmark_rows.size(), landmarks.size());
  for (int i = 0; i < 2; ++i) {
    for (std::size_t l = 0; l < landmarks.size(); ++l) {
      EXPECT_EQ(RowOf(result.outlines[i], result.landmark_rows[l]),
                RowOf(outlines[i], landmarks[l]));
    }
    ExpectEnclosure(result.outlines[i], outlines[i], 0.1);
  }
}

TEST(SimplifyBoundaries, ChangesNothingWhenEveryRowIsALandmark) {
  const Points figure = Figure(40, 4, 10.0, 5);
  std::vector<int> all(40);
  std::iota(all.begin(), all.end(), 0);
  const SimplifiedOutlines result = Simplified({figure}, all, 10.0);
  EXPECT_EQ(result.outlines[0], figure);
  EXPECT_EQ(result.landmark_rows, all);
}

TEST(SimplifyBoundaries, NeverGoesBelowThreeRows) {
  const Points triangle = PointsOf("0 0, 4 0, 0 3");
  EXPECT_EQ(Simplified({triangle}, {}, 100.0).outlines[0], triangle);
  for (const int corners : {4, 5, 6, 30}) {
    const Points polygon = Figure(corners, 1, 10.0, corners);
    const SimplifiedOutlines result = Simplified({polygon, polygon}, {}, 100.0);
    EXPECT_GE(result.outlines[0].rows(), 3);
    ExpectEnclosure(result.outlines[0], polygon, 100.0);
  }
}

TEST(SimplifyBoundaries, LeavesTheOutlineAsItIsAtToleranceZero) {
  const Points figure = Figure(60, 4, 10.0, 6);
  EXPECT_EQ(Simplified({figure}, {}, 0.0).outlines[0], figure);
}

TEST(SimplifyBoundaries, GivesTheSameAtEveryScale) {
  const Points figure = Figure(160, 5, 100.0, 7);
  const Points small = Simplified({figure}).outlines[0];
  for (const double scale : {1.0 / 1048576.0, 1024.0}) {  // powers of two round alike
    EXPECT_EQ(Simplified({Points(scale * figure)}).outlines[0], Points(scale * small));
  }
}

TEST(SimplifyBoundaries, EnclosesFarFromTheOrigin) {
  Points figure = Figure(160, 5, 1.0, 8);
  figure.rowwise() += Eigen::RowVector2d(1e6, -1e6);
  ASSERT_TRUE(IsSimple(figure));
  const Points result = Simplified({figure}).outlines[0];
  EXPECT_LT(result.rows(), 90);
  ExpectEnclosure(result, figure, 0.03);
}

TEST(SimplifyBoundaries, StopsWhenCancelled) {
  Progress progress;
  progress.Cancel();
  const std::vector<Points> outlines = {Figure(160, 5, 100.0, 1)};
  const auto result = SimplifyBoundaries(outlines, {}, {}, &progress);
  ASSERT_FALSE(result.has_value());
  EXPECT_EQ(result.error().code, ErrorCode::kCancelled);
}

TEST(SimplifyBoundaries, EnclosesTheDevelopmentLetters) {
  const std::filesystem::path shapes = ShapesFolder();
  if (shapes.empty()) GTEST_SKIP() << "the development drawings are not beside the project";
  int rings = 0;
  for (const auto& group : std::filesystem::directory_iterator(shapes / "glyph")) {
    for (const auto& file : OutlineFiles(group.path())) {
      const Points outline = OuterRing(file);
      if (!IsSimple(outline)) continue;  // one group is self-crossing on purpose
      const Points result = Simplified({outline}).outlines[0];
      EXPECT_LT(result.rows(), 60) << file;
      ExpectEnclosure(result, outline, 0.03);
      ++rings;
    }
  }
  EXPECT_GE(rings, 50);
}

}  // namespace
}  // namespace posespace
