// SPDX-License-Identifier: Apache-2.0
#include "mapping/vertex_removal.h"

#include <gtest/gtest.h>

#include "mapping/decimation.h"
#include "mapping/mesh_relaxation.h"
#include "tests/mapping/compatible_mesh_check.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

// A fan of every side of the outlines about their last row.
CompatibleMesh FanOf(std::vector<Points> poses) {
  CompatibleMesh mesh;
  mesh.poses = std::move(poses);
  const int n = mesh.num_vertices() - 1;
  mesh.triangles.resize(n, 3);
  mesh.boundary.emplace_back();
  for (int k = 0; k < n; ++k) {
    mesh.triangles.row(k) << k, (k + 1) % n, n;
    mesh.boundary[0].push_back(k);
  }
  return mesh;
}

TEST(RemoveVertex, FillsTheHoleWhereOneFillingServesAllPoses) {
  EditableMesh mesh(
      FanOf({PointsOf("0 0, 4 0, 4 4, 0 4, 1 1"), PointsOf("0 0, 4 0, 4 4, 3 1, 3.5 0.5")}));
  EXPECT_TRUE(RemoveVertex(mesh, 4, kAnySharpness));
  EXPECT_EQ(mesh.num_live_vertices(), 4);
  EXPECT_TRUE(mesh.HasEdge(1, 3));
  EXPECT_THAT(mesh.Finish(), IsACompatibleDisc());
}

TEST(RemoveVertex, KeepsAVertexThatTwoPosesNeed) {
  EditableMesh mesh(
      FanOf({PointsOf("3 1, 0 0, 4 0, 4 4, 3.5 0.5"), PointsOf("0 0, 4 0, 4 4, 3 1, 3.5 0.5")}));
  EXPECT_FALSE(RemoveVertex(mesh, 4, kAnySharpness));
  EXPECT_EQ(mesh.num_live_vertices(), 5);
}

TEST(RemoveVertex, MakesNoTriangleSharperThanAllowed) {
  EditableMesh mesh(FanOf({PointsOf("0 0, 9 0, 9 1, 0 1, 4 0.5")}));
  EXPECT_FALSE(RemoveVertex(mesh, 4, 8.9));
  EXPECT_TRUE(RemoveVertex(mesh, 4, 9.1));
}

TEST(MergeVertices, MakesOneOfTwoThatBothSeeTheWholeRim) {
  CompatibleMesh fan = FanOf({PointsOf("0 0, 4 0, 4 4, 0 4, 1 2")});
  EditableMesh mesh(fan);
  const std::vector<Point> middle = {Point(2.5, 3)};
  const int added = mesh.Split(4, 2, middle);
  EXPECT_TRUE(MergeVertices(mesh, 4, added, kAnySharpness));
  EXPECT_EQ(mesh.num_live_vertices(), 5);
  EXPECT_EQ(mesh.At(0, 4), Point(2, 2));
  EXPECT_THAT(mesh.Finish(), IsACompatibleDisc());
}

TEST(Decimate, LeavesTheOneVertexThatIsNeeded) {
  EditableMesh mesh(
      FanOf({PointsOf("3 1, 0 0, 4 0, 4 4, 3.5 0.5"), PointsOf("0 0, 4 0, 4 4, 3 1, 3.5 0.5")}));
  for (int corner = 0; corner < 4; ++corner) {
    const std::vector<Point> middles = {0.5 * (mesh.At(0, corner) + mesh.At(0, 4)),
                                        0.5 * (mesh.At(1, corner) + mesh.At(1, 4))};
    mesh.Split(corner, 4, middles);
  }
  ASSERT_EQ(mesh.num_live_vertices(), 9);
  Decimate(mesh, nullptr);
  EXPECT_EQ(mesh.num_live_vertices(), 5);
  EXPECT_THAT(mesh.Finish(), IsACompatibleDisc());
}

}  // namespace
}  // namespace posespace
