// SPDX-License-Identifier: Apache-2.0
#include "interpolation/fold_repair.h"

#include <gtest/gtest.h>

#include <cmath>

#include "interpolation/gradient_fit.h"
#include "interpolation/rigid_blend.h"
#include "interpolation/triangle_maps.h"
#include "tests/interpolation/sample_meshes.h"

namespace posespace {
namespace {

// Unfolds `start` towards the triangles of the mesh's first pose.
Points UnfoldedTowards(const CompatibleMesh& mesh, const Points& start) {
  const TriangleMaps maps = MeasureTriangles(mesh, RestShape::kFirstPose);
  const VertexParts parts = PartsOf(mesh.triangles, mesh.num_vertices());
  const auto fit = GradientFit::Prepare(mesh.triangles, parts, maps.gradients, maps.areas);
  EXPECT_TRUE(fit);
  return Unfolded(mesh.triangles, {maps.gradients, maps.areas}, start,
                  [&](const Eigen::MatrixXd& right) { return fit->SolveNormal(right); });
}

// Distances between all vertices and one: where a shape lies does not matter.
Eigen::VectorXd DistancesFrom(const Points& points, Eigen::Index vertex) {
  return (points.rowwise() - Eigen::RowVector2d(points.row(vertex))).rowwise().norm();
}

TEST(Unfolded, BringsBackAShapeThatWasFolded) {
  const CompatibleMesh mesh = StripMesh(6, 4, 1.0, {Moved(0.0, {0, 0})});
  Points start = mesh.poses[0];
  start.row(12) += Eigen::RowVector2d(2.5, 0.3);  // inner vertices, over their neighbours
  start.row(21) += Eigen::RowVector2d(0.2, -1.8);
  start.row(0) = mesh.poses[0].row(6) + Eigen::RowVector2d(0.3, 0.1);  // a corner, inwards
  ASSERT_GT(CountFolds(mesh.triangles, start), 5);
  const Points found = UnfoldedTowards(mesh, start);
  EXPECT_EQ(CountFolds(mesh.triangles, found), 0);
  for (const Eigen::Index vertex : {0, 14, 34}) {
    EXPECT_LT(
        (DistancesFrom(found, vertex) - DistancesFrom(mesh.poses[0], vertex)).cwiseAbs().maxCoeff(),
        0.2);
  }
}

TEST(Unfolded, UnfoldsNoise) {
  std::mt19937 random(1);
  const CompatibleMesh mesh = PlusMesh(2, {Moved(0.0, {0, 0})});
  Points start = mesh.poses[0];
  for (auto& coordinate : start.reshaped()) coordinate += Uniform(-0.7, 0.7, &random);
  ASSERT_GT(CountFolds(mesh.triangles, start), 40);
  EXPECT_EQ(CountFolds(mesh.triangles, UnfoldedTowards(mesh, start)), 0);
}

TEST(Unfolded, GivesNoMoreFoldsThanItTookWhereThereIsNoWayOut) {
  // The wheel's rim turns twice around its hub in the start: no small change unfolds that.
  CompatibleMesh mesh = AnnulusMesh(12, 1, {Moved(0.0, {0, 0})});
  Points start = mesh.poses[0];
  for (Eigen::Index v = 0; v < start.rows(); ++v) {
    const double angle = 2.0 * std::atan2(start(v, 1), start(v, 0));
    start.row(v) = start.row(v).norm() * Eigen::RowVector2d(std::cos(angle), -std::sin(angle));
  }
  const int folds = CountFolds(mesh.triangles, start);
  ASSERT_GT(folds, 0);
  const Points found = UnfoldedTowards(mesh, start);
  EXPECT_LE(CountFolds(mesh.triangles, found), folds);
  EXPECT_TRUE(found.allFinite());
}

}  // namespace
}  // namespace posespace
