// SPDX-License-Identifier: Apache-2.0
#include "interpolation/triangle_locator.h"

#include <gtest/gtest.h>

#include "interpolation/pose_lattice.h"
#include "tests/interpolation/sample_meshes.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

void ExpectFindsEverywhere(const PoseLattice& lattice, const TriangleLocator& locator) {
  std::mt19937 random(1);
  for (int k = 0; k < 4000; ++k) {
    Point point(Uniform(0.0, lattice.size.x(), &random), Uniform(0.0, lattice.size.y(), &random));
    if (k % 8 == 0) point.x() = k % 16 == 0 ? 0.0 : lattice.size.x();
    if (k % 8 == 1) point.y() = k % 16 == 1 ? 0.0 : lattice.size.y();
    if (k % 8 == 2) point = lattice.vertices.row(k % lattice.vertices.rows()).transpose();
    const auto [t, barycentric] = locator.Find(point);
    ASSERT_GE(barycentric.minCoeff(), -1e-12);
    EXPECT_NEAR(barycentric.sum(), 1.0, 1e-15);
    Point back = Point::Zero();
    for (int c = 0; c < 3; ++c) {
      back += barycentric[c] * lattice.vertices.row(lattice.triangles(t, c)).transpose();
    }
    ASSERT_LT((back - point).norm(), 1e-13);
  }
}

TEST(TriangleLocator, FindsEveryPointOfALattice) {
  const PoseLattice lattice = TessellateAround(PointsOf("1 0.7"), Point(2.0, 1.3), 0.05);
  ExpectFindsEverywhere(lattice,
                        TriangleLocator(lattice.vertices, lattice.triangles, lattice.size, 0.05));
}

TEST(TriangleLocator, FindsEveryPointOfALatticeOfManySizes) {
  const PoseLattice lattice =
      TessellateAround(PointsOf("1 0.7, 1.001 0.7, 1.02 0.71"), Point(2.0, 1.3), 0.05);
  ExpectFindsEverywhere(lattice,
                        TriangleLocator(lattice.vertices, lattice.triangles, lattice.size, 0.05));
}

TEST(TriangleLocator, DoesNotNeedAFittingCell) {
  const PoseLattice lattice = TessellateAround(PointsOf("1 0.7"), Point(2.0, 1.3), 0.05);
  for (const double cell : {0.01, 0.3, 10.0}) {
    ExpectFindsEverywhere(lattice,
                          TriangleLocator(lattice.vertices, lattice.triangles, lattice.size, cell));
  }
}

}  // namespace
}  // namespace posespace
