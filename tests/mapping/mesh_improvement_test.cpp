// SPDX-License-Identifier: Apache-2.0
#include "mapping/mesh_improvement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mapping/compatible_triangulation.h"
#include "tests/mapping/compatible_mesh_check.h"
#include "tests/mapping/outline_families.h"
#include "tests/support/fails_with.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

CompatibleMesh MeshOf(const std::vector<Points>& outlines,
                      const std::vector<int>& landmark_rows = {}) {
  auto result = TriangulateCompatibly(outlines, landmark_rows);
  EXPECT_THAT(result, Succeeds());
  return result->mesh;
}

// The longest edge of any pose / the square root of its area.
double LongestEdge(const CompatibleMesh& mesh) {
  double longest = 0.0;
  for (const Points& pose : mesh.poses) {
    double area = 0.0;
    for (int t = 0; t < mesh.num_triangles(); ++t) {
      area += 0.5 * Cross(pose.row(mesh.triangles(t, 0)), pose.row(mesh.triangles(t, 1)),
                          pose.row(mesh.triangles(t, 2)));
    }
    const Edges edges = EdgesOf(mesh.triangles);
    for (Eigen::Index e = 0; e < edges.rows(); ++e) {
      const double length = (pose.row(edges(e, 0)) - pose.row(edges(e, 1))).norm();
      longest = std::max(longest, length / std::sqrt(area));
    }
  }
  return longest;
}

class ImproveFamily : public testing::TestWithParam<OutlineFamily> {};

TEST_P(ImproveFamily, KeepsMeshesValidAndTheirSmallestAngle) {
  for (const int count : {1, 3}) {
    for (const int n : {6, 24}) {
      SCOPED_TRACE(testing::Message() << count << " outlines of " << n << " rows");
      const CompatibleMesh mesh = MeshOf(DrawOutlines(GetParam(), 10 * count + n, count, n));
      const auto improved = ImproveMesh(mesh);
      ASSERT_THAT(improved, Succeeds());
      EXPECT_THAT(*improved, IsACompatibleDisc());
      EXPECT_GE(MinAngle(*improved), (1.0 - 1e-9) * MinAngle(mesh));
    }
  }
}

TEST_P(ImproveFamily, LeavesBoundaryVerticesWhereTheyWereAndSplitsEdgesOnThemselves) {
  const auto outlines = DrawOutlines(GetParam(), 3, 3, 24);
  const auto improved = ImproveMesh(MeshOf(outlines));
  ASSERT_THAT(improved, Succeeds());
  const std::vector<int>& loop = improved->boundary[0];
  for (std::size_t s = 0; s < outlines.size(); ++s) {
    const Points& pose = improved->poses[s];
    EXPECT_EQ(pose.topRows(24), outlines[s]);
    // The loop passes the old rows in order; what lies between two of them lies on their edge, and
    // where rounding cannot put it there, inside.
    std::size_t at = 0;
    for (int row = 0; row < 24; ++row) {
      ASSERT_EQ(loop[at], row);
      const Point a = outlines[s].row(row), b = outlines[s].row((row + 1) % 24);
      for (++at; at < loop.size() && loop[at] != row + 1; ++at) {
        const Point p = pose.row(loop[at]);
        const double height = Cross(a, b, p) / (b - a).norm();
        EXPECT_NEAR(height, 0.0, 1e-14 * (a.norm() + b.norm()));
        EXPECT_GE(ExactOrientation(a, b, p), 0);
      }
    }
    EXPECT_EQ(at, loop.size());
  }
}

INSTANTIATE_TEST_SUITE_P(Families, ImproveFamily, testing::ValuesIn(OutlineFamilies()),
                         [](const auto& family) { return family.param.name; });

TEST(ImproveMesh, NeverFoldsOverInUnrelatedOutlines) {
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const double scale = seed % 3 == 0 ? 1e-6 : seed % 3 == 1 ? 1.0 : 1e6;
    const CompatibleMesh mesh =
        MeshOf(DrawMixedOutlines(seed, 2 + static_cast<int>(seed % 3), 18, scale));
    const auto improved = ImproveMesh(mesh);
    ASSERT_THAT(improved, Succeeds());
    EXPECT_THAT(*improved, IsACompatibleDisc());
    EXPECT_GE(MinAngle(*improved), (1.0 - 1e-9) * MinAngle(mesh));
  }
}

TEST(ImproveMesh, MakesRoundTrianglesOfOneDrawing) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto improved = ImproveMesh(MeshOf(DrawOutlines(OutlineFamilies()[4], seed, 1, 30)));
    ASSERT_THAT(improved, Succeeds());
    const std::vector<double> angles = SmallestAngles(*improved);
    EXPECT_GE(angles[0], 20.0);
    EXPECT_GE(angles[angles.size() / 20], 30.0);
    EXPECT_GE(angles[angles.size() / 2], 40.0);
  }
}

TEST(ImproveMesh, MakesRoundTrianglesOfFourDrawingsOfOneCharacter) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto improved = ImproveMesh(MeshOf(DrawOutlines(OutlineFamilies()[4], seed, 4, 30)));
    ASSERT_THAT(improved, Succeeds());
    const std::vector<double> angles = SmallestAngles(*improved);
    EXPECT_GE(angles[0], 6.0) << "seed " << seed;
    EXPECT_GE(angles[angles.size() / 20], 18.0) << "seed " << seed;
    EXPECT_GE(angles[angles.size() / 2], 34.0) << "seed " << seed;
  }
}

TEST(ImproveMesh, SplitsUntilEdgesAreNearTheTarget) {
  const CompatibleMesh mesh = MeshOf(DrawOutlines(OutlineFamilies()[4], 1, 3, 30));
  for (const double target : {0.3, 0.15, 0.08}) {
    ImprovementOptions options;
    options.target_edge_length = target;
    const auto improved = ImproveMesh(mesh, options);
    ASSERT_THAT(improved, Succeeds());
    EXPECT_LE(LongestEdge(*improved), 2.0 * target);
  }
}

TEST(ImproveMesh, RefinesASquareWithoutLosingItsAngles) {
  const auto improved = ImproveMesh(MeshOf({PointsOf("0 0, 64 0, 64 64, 0 64")}));
  ASSERT_THAT(improved, Succeeds());
  EXPECT_NEAR(SmallestAngles(*improved)[0], 45.0, 1e-9);
  EXPECT_LE(LongestEdge(*improved), 0.23);
}

TEST(ImproveMesh, StopsRefiningAtTheLimitOfVertices) {
  const CompatibleMesh mesh = MeshOf(DrawMixedOutlines(4, 3, 24));
  for (const int limit : {mesh.num_vertices(), 60, 100}) {
    ImprovementOptions options;
    options.max_vertices = limit;
    const auto improved = ImproveMesh(mesh, options);
    ASSERT_THAT(improved, Succeeds());
    EXPECT_LE(improved->num_vertices(), limit);
    EXPECT_THAT(*improved, IsACompatibleDisc());
  }
}

TEST(ImproveMesh, NeverMovesALandmarkEvenInside) {
  CompatibleMesh mesh;
  mesh.poses = {PointsOf("0 0, 8 0, 8 8, 0 8, 1 1"), PointsOf("0 0, 8 0, 8 8, 0 8, 7 6")};
  mesh.triangles.resize(4, 3);
  mesh.triangles << 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4;
  mesh.boundary = {{0, 1, 2, 3}};
  mesh.landmarks = {4, 2};
  const auto improved = ImproveMesh(mesh);
  ASSERT_THAT(improved, Succeeds());
  EXPECT_GT(improved->num_vertices(), 50);
  EXPECT_EQ(improved->landmarks, mesh.landmarks);
  for (int pose = 0; pose < 2; ++pose) {
    EXPECT_EQ(improved->poses[pose].topRows(5), mesh.poses[pose]);
  }
  EXPECT_THAT(*improved, IsACompatibleDisc());
}

TEST(ImproveMesh, EqualInputGivesEqualOutput) {
  const CompatibleMesh mesh = MeshOf(DrawMixedOutlines(9, 3, 24));
  const auto first = ImproveMesh(mesh), second = ImproveMesh(mesh);
  EXPECT_EQ(first->triangles, second->triangles);
  EXPECT_EQ(first->poses, second->poses);
}

TEST(ImproveMesh, StopsWhenCancelled) {
  const CompatibleMesh mesh = MeshOf(DrawMixedOutlines(9, 3, 24));
  Progress* running = nullptr;
  for (const double when : {0.0, 0.5}) {
    Progress progress([&](std::string_view, double fraction) {
      if (fraction > when) running->Cancel();
    });
    running = &progress;
    EXPECT_THAT(ImproveMesh(mesh, {}, &progress), FailsWith(ErrorCode::kCancelled));
  }
}

}  // namespace
}  // namespace posespace
