// SPDX-License-Identifier: Apache-2.0
#include "mapping/edge_grid.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "geometry/polygon.h"

namespace posespace {
namespace {

double Distance(const Point& p, const Point& a, const Point& b) {
  const double length = (b - a).squaredNorm();
  const double t = length > 0.0 ? std::clamp((p - a).dot(b - a) / length, 0.0, 1.0) : 0.0;
  return (p - a - t * (b - a)).norm();
}

double Distance(const Point& a, const Point& b, const Point& c, const Point& d) {
  if (SegmentsMeet(a, b, c, d)) return 0.0;
  return std::min({Distance(a, c, d), Distance(b, c, d), Distance(c, a, b), Distance(d, a, b)});
}

TEST(EdgeGrid, AsksOnceAboutEveryEdgeThatComesWithinReach) {
  std::mt19937 random(5);
  const auto coordinate = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  for (const double scale : {1e-3, 1.0, 1e5}) {
    Points ring(200, 2);
    for (int k = 0; k < ring.rows(); ++k) {
      ring.row(k) << scale * coordinate(-3, 7), scale * coordinate(1, 2);
    }
    ring.row(7) = ring.row(6);                      // an edge of no length
    ring.row(9) << ring(8, 0), ring(8, 1) + scale;  // an upright one
    ring.row(11) << ring(10, 0) + scale, ring(10, 1);
    EdgeGrid grid(ring);
    const auto end = [&](int edge, int which) -> Point {
      return ring.row((edge + which) % ring.rows()).transpose();
    };
    for (int edge = 0; edge < ring.rows(); ++edge) grid.Insert(edge, end(edge, 0), end(edge, 1));
    for (int edge = 0; edge < ring.rows(); edge += 3) grid.Erase(edge, end(edge, 0), end(edge, 1));
    for (int round = 0; round < 300; ++round) {
      const Point a(scale * coordinate(-6, 9), scale * coordinate(-1, 4));
      const Point b = round % 3 == 0 ? Point(a + 0.1 * scale * Point(coordinate(-1, 1), 0.0))
                                     : Point(scale * coordinate(-6, 9), scale * coordinate(-1, 4));
      const double reach = round % 2 == 0 ? 0.0 : 0.2 * scale;
      std::multiset<int> asked;
      EXPECT_FALSE(grid.AnyNear(a, b, reach, [&](int edge) {
        asked.insert(edge);
        return false;
      }));
      for (int edge = 0; edge < ring.rows(); ++edge) {
        EXPECT_LE(asked.count(edge), edge % 3 == 0 ? 0u : 1u);
        if (edge % 3 == 0 || Distance(a, b, end(edge, 0), end(edge, 1)) > reach) continue;
        EXPECT_EQ(asked.count(edge), 1u) << "edge " << edge << " round " << round;
      }
    }
  }
}

TEST(EdgeGrid, AsksFewOfTheEdgesOfManyNeedles) {
  constexpr int kNeedles = 500;
  Points ring(2 * kNeedles, 2);
  for (int k = 0; k < ring.rows(); ++k) {
    const double angle = M_PI * k / kNeedles, radius = k % 2 == 0 ? 1.0 : 100.0;
    ring.row(k) << radius * std::cos(angle), radius * std::sin(angle);
  }
  EdgeGrid grid(ring);
  const auto row = [&](int k) -> Point { return ring.row(k % ring.rows()).transpose(); };
  for (int edge = 0; edge < ring.rows(); ++edge) grid.Insert(edge, row(edge), row(edge + 1));
  int asked = 0;
  const Point outward = row(101).normalized();
  grid.AnyNear(50 * outward, 100 * outward, 0.0, [&](int) { return ++asked < 0; });
  EXPECT_GE(asked, 2);
  EXPECT_LT(asked, 200);  // of 1000, most of which its box meets
}

}  // namespace
}  // namespace posespace
