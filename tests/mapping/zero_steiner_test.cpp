// SPDX-License-Identifier: Apache-2.0
#include "mapping/zero_steiner.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

#include "geometry/polygon.h"
#include "mapping/triangle_quality.h"
#include "tests/mapping/outline_families.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

double SharpestIn(const std::vector<Points>& rings, int i, int k, int j) {
  double sharpest = 0.0;
  for (const Points& ring : rings) {
    if (Orientation(ring.row(i), ring.row(k), ring.row(j)) <= 0) {
      return std::numeric_limits<double>::infinity();
    }
    sharpest = std::max(sharpest, Sharpness(ring.row(i), ring.row(k), ring.row(j)));
  }
  return sharpest;
}

// The least sharpness over all triangulations of rows i..j, by trying each of them.
double LeastSharpness(const std::vector<Points>& rings, int i, int j) {
  if (j - i < 2) return 0.0;
  double least = std::numeric_limits<double>::infinity();
  for (int k = i + 1; k < j; ++k) {
    least = std::min(least, std::max({SharpestIn(rings, i, k, j), LeastSharpness(rings, i, k),
                                      LeastSharpness(rings, k, j)}));
  }
  return least;
}

TEST(TriangulateRings, FindsTheTriangulationOfTheWidestAnglesAmongAll) {
  int found = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const int n = 4 + static_cast<int>(seed % 5);
    const auto rings = DrawOutlines(OutlineFamilies()[seed % 2], seed, 1 + seed % 2, n);
    const double least = LeastSharpness(rings, 0, n - 1);
    const auto triangles = TriangulateRings(rings);
    ASSERT_EQ(triangles.has_value(), std::isfinite(least)) << "seed " << seed;
    if (!triangles) continue;
    ++found;
    double sharpest = 0.0;
    for (const auto& [i, k, j] : *triangles) {
      sharpest = std::max(sharpest, SharpestIn(rings, i, k, j));
    }
    EXPECT_NEAR(sharpest, least, 1e-6 * least) << "seed " << seed;
    EXPECT_EQ(static_cast<int>(triangles->size()), n - 2);
  }
  EXPECT_GT(found, 100);
}

TEST(TriangulateRings, UsesNoForbiddenChord) {
  const std::vector<Points> square = {PointsOf("0 0, 4 0, 4 4, 0 4")};
  const std::vector<std::pair<int, int>> rising = {{0, 2}}, both = {{0, 2}, {1, 3}};
  const auto triangles = TriangulateRings(square, rising);
  ASSERT_TRUE(triangles.has_value());
  for (const Triangle& corners : *triangles) {
    EXPECT_TRUE(std::find(corners.begin(), corners.end(), 1) != corners.end());
    EXPECT_TRUE(std::find(corners.begin(), corners.end(), 3) != corners.end());
  }
  EXPECT_FALSE(TriangulateRings(square, both).has_value());
}

TEST(TriangulateRings, CutsOffNoTriangleOfThreeCollinearRows) {
  const auto triangles = TriangulateRings(std::vector{PointsOf("0 0, 1 0, 2 0, 2 2, 1 2, 0 2")});
  ASSERT_TRUE(triangles.has_value());
  for (const auto& [i, k, j] : *triangles) {
    EXPECT_FALSE((i == 0 && k == 1 && j == 2) || (i == 3 && k == 4 && j == 5));
  }
}

}  // namespace
}  // namespace posespace
