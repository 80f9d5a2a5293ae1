// SPDX-License-Identifier: Apache-2.0
#include "interpolation/pose_lattice.h"

#include <gtest/gtest.h>

#include <numbers>
#include <set>

#include "geometry/polygon.h"
#include "interpolation/rigid_blend.h"
#include "tests/interpolation/sample_meshes.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

double AreaOf(const PoseLattice& lattice) {
  double twice = 0.0;
  for (const auto& t : lattice.triangles.rowwise()) {
    twice +=
        Cross(lattice.vertices.row(t[0]), lattice.vertices.row(t[1]), lattice.vertices.row(t[2]));
  }
  return 0.5 * twice;
}

// A positive triangulation of the rectangle without hanging vertices, a vertex on each placement.
void ExpectSound(const PoseLattice& lattice, const Points& placements) {
  EXPECT_EQ(CountFolds(lattice.triangles, lattice.vertices), 0);
  EXPECT_NEAR(AreaOf(lattice), lattice.size.prod(), 1e-11);
  const Edges edges = EdgesOf(lattice.triangles);
  for (const auto& edge : edges.rowwise()) {
    if (edge[3] >= 0) continue;
    const Point a = lattice.vertices.row(edge[0]), b = lattice.vertices.row(edge[1]);
    const bool on_rim = (a.x() == b.x() && (a.x() == 0.0 || a.x() == lattice.size.x())) ||
                        (a.y() == b.y() && (a.y() == 0.0 || a.y() == lattice.size.y()));
    EXPECT_TRUE(on_rim) << "a gap inside at " << a.transpose();
  }
  EXPECT_EQ(lattice.vertices.rows() - edges.rows() + lattice.triangles.rows(), 1);
  std::set<int> distinct(lattice.pose_vertices.begin(), lattice.pose_vertices.end());
  EXPECT_EQ(distinct.size(), static_cast<std::size_t>(placements.rows()));
  for (Eigen::Index i = 0; i < placements.rows(); ++i) {
    EXPECT_EQ(lattice.vertices.row(lattice.pose_vertices[i]), placements.row(i));
  }
}

double SmallestAngle(const PoseLattice& lattice) {
  CompatibleMesh mesh;
  mesh.triangles = lattice.triangles;
  mesh.poses = {lattice.vertices};
  return MinAngle(mesh);
}

TEST(PoseLattice, IsNearlyEquilateralWithStraightSides) {
  const Points placements = PointsOf("1 0.65");
  const PoseLattice lattice = TessellateAround(placements, Point(2.0, 1.3), 1.0 / 48);
  ExpectSound(lattice, placements);
  EXPECT_NEAR(lattice.spacing, 1.0 / 48, 1e-3);
  EXPECT_GT(SmallestAngle(lattice), 28.0 * std::numbers::pi / 180.0);  // halves at the sides
}

TEST(PoseLattice, HasAVertexOnEachOfManyPlacements) {
  for (unsigned seed = 0; seed < 30; ++seed) {
    std::mt19937 random(seed);
    Points placements(12, 2);
    for (auto&& row : placements.rowwise()) {
      row << Uniform(0.5, 1.4, &random), Uniform(0.5, 1.2, &random);
    }
    const PoseLattice lattice = TessellateAround(placements, Point(1.9, 1.7), 1.0 / 48);
    ExpectSound(lattice, placements);
    EXPECT_GT(SmallestAngle(lattice), 12.0 * std::numbers::pi / 180.0) << seed;
  }
}

TEST(PoseLattice, IsHalvedAroundClosePlacements) {
  for (const double distance : {0.05, 0.02, 0.01, 0.004, 0.001}) {
    Points placements(5, 2);
    placements << 0.7, 0.7, 0.7 + distance, 0.7, 0.7, 0.7 + distance, 1.2, 0.9, 0.7 - 4 * distance,
        0.71;
    const PoseLattice lattice = TessellateAround(placements, Point(1.9, 1.7), 1.0 / 48);
    ExpectSound(lattice, placements);
    EXPECT_GT(SmallestAngle(lattice), 12.0 * std::numbers::pi / 180.0) << distance;
    EXPECT_LT(lattice.vertices.rows(), 15000);
  }
}

TEST(PoseLattice, StaysSoundForManyClusters) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    std::mt19937 random(seed);
    std::vector<Point> places;
    while (places.size() < 24) {
      Point place(Uniform(0.5, 1.5, &random), Uniform(0.5, 1.5, &random));
      if (!places.empty() && random() % 4 != 0) {
        const double radius = std::pow(10.0, Uniform(-3.0, -0.5, &random));
        const double angle = Uniform(0.0, 6.3, &random);
        place = places[random() % places.size()] + radius * Point(std::cos(angle), std::sin(angle));
      }
      place = place.cwiseMax(0.5).cwiseMin(1.5);
      const bool is_free = std::all_of(places.begin(), places.end(), [&](const Point& other) {
        return (other - place).norm() >= 1e-3;
      });
      if (is_free) places.push_back(place);
    }
    Points placements(24, 2);
    for (int i = 0; i < 24; ++i) placements.row(i) = places[i];
    const PoseLattice lattice = TessellateAround(placements, Point(2.0, 2.0), 1.0 / 48);
    ExpectSound(lattice, placements);
    EXPECT_GT(SmallestAngle(lattice), 8.0 * std::numbers::pi / 180.0) << seed;
  }
}

}  // namespace
}  // namespace posespace
