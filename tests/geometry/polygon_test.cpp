// SPDX-License-Identifier: Apache-2.0
#include "geometry/polygon.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/points.h"

namespace posespace {
namespace {

TEST(Orientation, IsPositiveForATurnToTheRightOnAScreen) {
  EXPECT_EQ(Orientation({0, 0}, {1, 0}, {1, 1}), 1);
  EXPECT_EQ(Orientation({0, 0}, {1, 1}, {1, 0}), -1);
}

TEST(Orientation, SeesOneUnitInTheLastPlace) {
  const Point a{0.1, 0.1}, b{1e8 + 0.1, 1e8 + 0.1};
  const Point on{0.5 * (a + b)};
  const Point above{on.x(), std::nextafter(on.y(), 1e9)};
  const Point below{on.x(), std::nextafter(on.y(), -1e9)};
  EXPECT_EQ(Orientation(a, b, above), 1);
  EXPECT_EQ(Orientation(a, b, below), -1);
}

TEST(SegmentsMeet, AtACrossingATouchAndAnOverlapButNotApart) {
  EXPECT_TRUE(SegmentsMeet({0, 0}, {2, 2}, {0, 2}, {2, 0}));
  EXPECT_TRUE(SegmentsMeet({0, 0}, {2, 0}, {1, 0}, {1, 5}));
  EXPECT_TRUE(SegmentsMeet({0, 0}, {2, 0}, {1, 0}, {3, 0}));
  EXPECT_TRUE(SegmentsMeet({0, 0}, {2, 0}, {2, 0}, {3, 1}));
  EXPECT_FALSE(SegmentsMeet({0, 0}, {2, 0}, {3, 0}, {4, 0}));
  EXPECT_FALSE(SegmentsMeet({0, 0}, {2, 0}, {1, 1e-300}, {1, 5}));
}

TEST(SignedArea, IsPositiveForAPositiveRingAndKeepsDigitsFarFromTheOrigin) {
  EXPECT_DOUBLE_EQ(SignedArea(PointsOf("0 0, 4 0, 4 3, 0 3")), 12.0);
  EXPECT_DOUBLE_EQ(SignedArea(PointsOf("0 3, 4 3, 4 0, 0 0")), -12.0);
  Points far = PointsOf("0 0, 1 0, 1 1, 0 1");
  far.rowwise() += Eigen::RowVector2d(1e7, 1e7);
  EXPECT_DOUBLE_EQ(SignedArea(far), 1.0);
}

TEST(AreaCentroid, OfAnLIsWhereItWouldBalance) {
  const Point centroid = AreaCentroid(PointsOf("0 0, 2 0, 2 1, 1 1, 1 2, 0 2"));
  EXPECT_NEAR(centroid.x(), 5.0 / 6.0, 1e-15);
  EXPECT_NEAR(centroid.y(), 5.0 / 6.0, 1e-15);
}

TEST(Perimeter, ClosesTheRing) { EXPECT_DOUBLE_EQ(Perimeter(PointsOf("0 0, 3 0, 3 4")), 12.0); }

TEST(FindCrossing, IsEmptyForSimpleRings) {
  EXPECT_TRUE(IsSimple(PointsOf("0 0, 1 0, 0 1")));
  EXPECT_TRUE(IsSimple(PointsOf("0 0, 4 0, 4 4, 2 1, 0 4")));
  EXPECT_TRUE(IsSimple(PointsOf("0 0, 2 0, 4 0, 4 4, 0 4")));  // a point on a straight run
}

TEST(FindCrossing, NamesTheFirstPairOfEdgesThatCross) {
  EXPECT_EQ(FindCrossing(PointsOf("0 0, 2 2, 2 0, 0 2")), std::pair(0, 2));
}

TEST(FindCrossing, RefusesSpikesTouchesRepeatsAndDegenerateRings) {
  EXPECT_FALSE(IsSimple(PointsOf("0 0, 4 0, 2 0, 2 3")));       // an edge back over itself
  EXPECT_FALSE(IsSimple(PointsOf("0 0, 4 0, 4 4, 2 0, 0 4")));  // a vertex on another edge
  EXPECT_FALSE(IsSimple(PointsOf("0 0, 4 0, 4 4, 4 0, 0 4")));  // a vertex twice
  EXPECT_FALSE(IsSimple(PointsOf("0 0, 1 1, 2 2")));            // no area
  EXPECT_FALSE(IsSimple(PointsOf("0 0, 1 1")));
}

TEST(FindCrossing, AgreesWithTryingAllPairs) {
  // Rings from a fixed multiplicative sequence, some simple and some not.
  std::uint32_t state = 7;
  const auto next = [&] {
    return static_cast<double>((state = state * 48271u % 2147483647u) % 64);
  };
  int simple = 0;
  for (int trial = 0; trial < 2000; ++trial) {
    const int n = 3 + trial % 6;
    Points ring(n, 2);
    for (int k = 0; k < n; ++k) ring.row(k) << next(), next();
    bool clash = false;
    for (int i = 0; i < n && !clash; ++i) {
      for (int j = i + 2; j < n && !clash; ++j) {
        if (i == 0 && j == n - 1) continue;
        clash = SegmentsMeet(ring.row(i), ring.row(i + 1), ring.row(j), ring.row((j + 1) % n));
      }
      const Point a = ring.row(i), b = ring.row((i + 1) % n), c = ring.row((i + 2) % n);
      clash = clash || IsOnSegment(c, a, b) || IsOnSegment(a, b, c);
    }
    EXPECT_EQ(IsSimple(ring), !clash) << ring;
    simple += !clash;
  }
  EXPECT_GT(simple, 200);
  EXPECT_LT(simple, 1800);
}

TEST(FindCrossing, FindsNothingOnceCancelled) {
  Progress cancelled;
  cancelled.Cancel();
  EXPECT_FALSE(FindCrossing(PointsOf("0 0, 2 2, 2 0, 0 2"), &cancelled).has_value());
  const Progress running;
  EXPECT_TRUE(FindCrossing(PointsOf("0 0, 2 2, 2 0, 0 2"), &running).has_value());
}

TEST(Locate, TellsInsideFromOnFromOutside) {
  const Points ring = PointsOf("0 0, 4 0, 4 4, 2 1, 0 4");
  EXPECT_EQ(Locate({1, 1}, ring), 1);
  EXPECT_EQ(Locate({2, 0}, ring), 0);
  EXPECT_EQ(Locate({2, 1}, ring), 0);
  EXPECT_EQ(Locate({2, 2}, ring), -1);
  EXPECT_EQ(Locate({-1, 0}, ring), -1);
  EXPECT_EQ(Locate({5, 4}, ring), -1);  // level with two vertices
}

CompatibleMesh TwoTriangles() {
  CompatibleMesh mesh;
  mesh.triangles.resize(2, 3);
  mesh.triangles << 0, 1, 2, 0, 2, 3;
  mesh.poses = {PointsOf("0 0, 1 0, 1 1, 0 1"), PointsOf("0 0, 2 0, 2 2, 0 1")};
  mesh.boundary = {{0, 1, 2, 3}};
  return mesh;
}

TEST(FindDefect, IsEmptyForAValidMesh) { EXPECT_FALSE(FindDefect(TwoTriangles()).has_value()); }

TEST(FindDefect, NamesThePoseAndTriangleThatFolds) {
  CompatibleMesh mesh = TwoTriangles();
  mesh.poses[1].row(3) << 3, 0.5;
  const auto defect = FindDefect(mesh);
  ASSERT_TRUE(defect.has_value());
  EXPECT_EQ(defect->pose, 1);
  EXPECT_EQ(defect->triangle, 1);
}

TEST(FindDefect, RefusesATriangleWithoutArea) {
  CompatibleMesh mesh = TwoTriangles();
  mesh.poses[0].row(3) << 0.5, 0.5;
  EXPECT_TRUE(FindDefect(mesh).has_value());
}

}  // namespace
}  // namespace posespace
