// SPDX-License-Identifier: Apache-2.0
#include "mapping/overlay_triangulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "geometry/polygon.h"
#include "tests/mapping/compatible_mesh_check.h"
#include "tests/mapping/outline_families.h"
#include "tests/support/fails_with.h"

namespace posespace {
namespace {

// A triangle of the outline's own may be as thin as numbers allow.
TEST(TriangulateByOverlay, FitsIntoThinOutlines) {
  for (const double thinness : {1e-3, 1e-6, 1e-9, 1e-11}) {
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      std::vector<Points> outlines = DrawOutlines(OutlineFamilies()[1], seed, 3, 14);
      for (Points& outline : outlines) outline.col(1) *= thinness;
      const auto overlay = TriangulateByOverlay(outlines, 100'000, seed, nullptr);
      ASSERT_THAT(overlay, Succeeds()) << "thinness " << thinness << " seed " << seed;
      EXPECT_THAT(overlay->mesh, IsACompatibleDisc());
    }
  }
}

}  // namespace
}  // namespace posespace
