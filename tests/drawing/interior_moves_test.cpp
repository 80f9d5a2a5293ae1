// SPDX-License-Identifier: Apache-2.0
#include "drawing/interior_moves.h"

#include <gtest/gtest.h>

namespace posespace {
namespace {

// A square of side 2 around the origin, whose centre is free to move.
CompatibleMesh Fan() {
  CompatibleMesh mesh;
  Points pose(5, 2);
  pose << 0.0, 0.0, -1.0, -1.0, 1.0, -1.0, 1.0, 1.0, -1.0, 1.0;
  mesh.poses = {pose};
  mesh.triangles.resize(4, 3);
  mesh.triangles << 0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 1;
  mesh.boundary = {{1, 2, 3, 4}};
  return mesh;
}

TEST(InteriorMoves, SqueezesATriangleNoMoreThanItMay) {
  // The centre at (x, 0) leaves the right triangle 1 - x as wide as it was.
  const double most = 1.0 - 1.0 / InteriorMoves::kMostStretch;
  const CompatibleMesh mesh = Fan();
  InteriorMoves moves(mesh, mesh.poses[0]);
  EXPECT_FALSE(moves.Move(0, {most + 0.01, 0.0}));
  EXPECT_EQ(moves.pose(), mesh.poses[0]);
  EXPECT_TRUE(moves.Move(0, {most - 0.01, 0.0}));
}

TEST(InteriorMoves, StretchesATriangleNoMoreThanItMay) {
  // The left triangle becomes 1 + x / 0.1 as wide as it was.
  CompatibleMesh mesh = Fan();
  mesh.poses[0].row(1) << -0.1, -1.0;
  mesh.poses[0].row(4) << -0.1, 1.0;
  const double most = 0.1 * (InteriorMoves::kMostStretch - 1.0);
  InteriorMoves moves(mesh, mesh.poses[0]);
  EXPECT_FALSE(moves.Move(0, {most + 0.005, 0.0}));
  EXPECT_TRUE(moves.Move(0, {most - 0.005, 0.0}));
}

TEST(InteriorMoves, CountsFromWhereAVertexWasGivenHoweverManySteps) {
  const CompatibleMesh mesh = Fan();
  InteriorMoves moves(mesh, mesh.poses[0]);
  double reached = 0.0;
  for (double x = 0.05; x < 1.0 && moves.Move(0, {x, 0.0}); x += 0.05) reached = x;
  EXPECT_NEAR(reached, 1.0 - 1.0 / InteriorMoves::kMostStretch, 0.051);
  EXPECT_TRUE(moves.Move(0, Point::Zero()));
}

TEST(InteriorMoves, AreFreeInsideAndNotAtLandmarks) {
  CompatibleMesh mesh = Fan();
  EXPECT_EQ(InteriorMoves(mesh, mesh.poses[0]).free(), (std::vector<char>{1, 0, 0, 0, 0}));
  mesh.landmarks = {0};
  EXPECT_EQ(InteriorMoves(mesh, mesh.poses[0]).free(), (std::vector<char>{0, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace posespace
