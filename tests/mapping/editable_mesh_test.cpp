// SPDX-License-Identifier: Apache-2.0
#include "mapping/editable_mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "tests/mapping/compatible_mesh_check.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

using testing::ElementsAre;

// A square about a vertex, 4, in two poses.
CompatibleMesh Pinwheel() {
  CompatibleMesh mesh;
  mesh.poses = {PointsOf("0 0, 8 0, 8 8, 0 8, 3 3"), PointsOf("0 0, 8 0, 8 8, 0 8, 5 4")};
  mesh.triangles.resize(4, 3);
  mesh.triangles << 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4;
  mesh.boundary = {{0, 1, 2, 3}};
  mesh.landmarks = {2};
  return mesh;
}

TEST(EditableMesh, ReturnsWhatItWasGiven) {
  const CompatibleMesh mesh = Pinwheel(), finished = EditableMesh(mesh).Finish();
  EXPECT_EQ(finished.triangles, mesh.triangles);
  EXPECT_EQ(finished.poses, mesh.poses);
  EXPECT_EQ(finished.boundary, mesh.boundary);
  EXPECT_EQ(finished.landmarks, mesh.landmarks);
}

TEST(EditableMesh, GivesTheLinkInPositiveOrder) {
  std::vector<int> link = EditableMesh(Pinwheel()).Link(4);
  std::rotate(link.begin(), std::find(link.begin(), link.end(), 0), link.end());
  EXPECT_THAT(link, ElementsAre(0, 1, 2, 3));
}

TEST(EditableMesh, SplitsABoundaryEdgeIntoItsLoop) {
  EditableMesh mesh(Pinwheel());
  const std::vector<Point> middles = {Point(0, 4), Point(0, 2)};
  EXPECT_EQ(mesh.Split(0, 3, middles), 5);
  EXPECT_TRUE(mesh.IsFixed(5));
  EXPECT_THAT(mesh.Finish().boundary[0], ElementsAre(0, 1, 2, 3, 5));
  EXPECT_THAT(mesh.Finish(), IsACompatibleDisc());
}

TEST(EditableMesh, SplitsAnInteriorEdgeIntoFourTriangles) {
  EditableMesh mesh(Pinwheel());
  const std::vector<Point> middles = {Point(1, 1), Point(3, 2)};
  EXPECT_EQ(mesh.Split(0, 4, middles), 5);
  EXPECT_FALSE(mesh.IsFixed(5));
  EXPECT_EQ(mesh.TrianglesAt(5).size(), 4U);
  EXPECT_THAT(mesh.Finish(), IsACompatibleDisc());
}

TEST(EditableMesh, FlipsAnEdgeToTheOtherDiagonalAndBack) {
  EditableMesh mesh(Pinwheel());
  const std::vector<Point> middles = {Point(1, 1), Point(3, 2)};
  mesh.Split(0, 4, middles);
  mesh.Flip(4, 1);
  EXPECT_FALSE(mesh.HasEdge(4, 1));
  EXPECT_TRUE(mesh.HasEdge(5, 2));
  mesh.Flip(2, 5);
  EXPECT_TRUE(mesh.HasEdge(4, 1));
  EXPECT_THAT(mesh.Finish(), IsACompatibleDisc());
}

TEST(EditableMesh, LeavesOutVerticesWithoutTrianglesAndRenumbersTheRest) {
  EditableMesh mesh(Pinwheel());
  const std::vector<Point> middles = {Point(8, 4), Point(8, 4)};
  mesh.Split(1, 2, middles);
  const std::vector<int> patch(mesh.TrianglesAt(4).begin(), mesh.TrianglesAt(4).end());
  const std::vector<Triangle> filling = {{0, 1, 5}, {0, 5, 3}, {5, 2, 3}};
  mesh.Refill(patch, filling);
  EXPECT_FALSE(mesh.IsLive(4));
  EXPECT_EQ(mesh.num_live_vertices(), 5);
  const CompatibleMesh finished = mesh.Finish();
  EXPECT_EQ(finished.num_vertices(), 5);
  EXPECT_THAT(finished.boundary[0], ElementsAre(0, 1, 4, 2, 3));
  EXPECT_THAT(finished, IsACompatibleDisc());
}

}  // namespace
}  // namespace posespace
