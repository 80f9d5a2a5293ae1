// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_MAPPING_MATCHING_CASES_H_
#define POSESPACE_TESTS_MAPPING_MATCHING_CASES_H_

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "geometry/polygon.h"
#include "mapping/boundary_matching.h"
#include "tests/mapping/rings.h"
#include "tests/support/points.h"

// Drawings to match, and what every match must be.

namespace posespace {

inline std::vector<MatchingShape> ShapesOf(const std::vector<Points>& outlines) {
  std::vector<MatchingShape> shapes;
  for (const Points& outline : outlines) {
    shapes.push_back({std::string(1, static_cast<char>('A' + shapes.size())), outline, {}});
  }
  return shapes;
}

inline MatchedOutlines Matched(const std::vector<MatchingShape>& shapes,
                               const std::vector<Landmark>& landmarks = {},
                               const MatchingOptions& options = {}) {
  auto result = MatchBoundaries(shapes, landmarks, options);
  EXPECT_TRUE(result.has_value()) << (result ? "" : result.error().message);
  return std::move(result).value();
}

// Arc length of every row of the ring from row `start` on, in turns.
inline std::vector<double> PositionsFrom(const Points& ring, int start) {
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
inline double MeanError(const MatchedOutlines& match, const std::vector<Points>& outlines, int i,
                        int j) {
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

inline void ExpectRingsFollowOutlines(const MatchedOutlines& match,
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

// The drawing seen in a mirror, positively oriented again.
inline Points Mirrored(const Points& ring) {
  Points mirrored = ring.colwise().reverse();
  mirrored.col(0) *= -1.0;
  return mirrored;
}

// An animal that faces left with its tail raised, and with it hanging beside its thigh.
struct TailedPair {
  Points raised, hanging;
  Point raised_tip, hanging_tip;
};

inline TailedPair RaisedAndHangingTail() {
  const std::string head = "0 14, 0 4, 10 -4, 12 -22, 20 -24, 30 -6, 36 4, 60 -2, ";
  const std::string raised =
      "92 2, 99 -16, 97 -36, 86 -46, 72 -45, 72 -54, 88 -56, 103 -44, 109 -20, 104 8, 102 30, ";
  const std::string hanging =
      "80 0, 98 2, 103 10, 103 30, 112 37, 121 34, 124 41, 118 47, 107 45, ";
  const std::string legs =
      "104 62, 92 62, 91 44, 85 44, 84 62, 74 62, 72 40, 34 40, 33 62, 23 62, 22 44, 17 44, 16 62,"
      " 6 62, 5 34";
  return {PointsOf(head + raised + legs),
          PointsOf(head + hanging + legs),
          {72.0, -54.0},
          {124.0, 41.0}};
}

// A drawing and the same with its limbs bent about: angles and lengths change along the outline.
inline Points Bent(const Points& ring, double amount, std::uint32_t seed) {
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

}  // namespace posespace

#endif  // POSESPACE_TESTS_MAPPING_MATCHING_CASES_H_
