// SPDX-License-Identifier: Apache-2.0
#include "geometry/mesh.h"

#include <gtest/gtest.h>

#include <numbers>

#include "tests/support/points.h"

namespace posespace {
namespace {

TEST(MinAngle, OfATriangleIsItsSharpestCorner) {
  EXPECT_NEAR(MinAngle(Point(0, 0), Point(1, 0), Point(0, 1)), std::numbers::pi / 4, 1e-15);
  EXPECT_NEAR(MinAngle(Point(0, 0), Point(1, 0), Point(0.5, std::sqrt(0.75))), std::numbers::pi / 3,
              1e-15);
  EXPECT_EQ(MinAngle(Point(0, 0), Point(1, 1), Point(2, 2)), 0.0);
}

TEST(MinAngle, OfAMeshIsTheSharpestInAnyPose) {
  CompatibleMesh mesh;
  mesh.triangles.resize(1, 3);
  mesh.triangles << 0, 1, 2;
  mesh.poses = {PointsOf("0 0, 1 0, 0 1"), PointsOf("0 0, 10 0, 0 1")};
  EXPECT_NEAR(MinAngle(mesh), std::atan2(1.0, 10.0), 1e-15);
}

TEST(EdgesOf, NamesBothTrianglesOfAnInnerEdgeAndOneOfABoundaryEdge) {
  Triangles triangles(2, 3);
  triangles << 0, 1, 2, 0, 2, 3;
  const Edges edges = EdgesOf(triangles);
  Edges expected(5, 4);
  expected << 0, 1, 0, -1,  //
      0, 2, 0, 1,           //
      0, 3, 1, -1,          //
      1, 2, 0, -1,          //
      2, 3, 1, -1;
  EXPECT_EQ(edges, expected);
}

}  // namespace
}  // namespace posespace
