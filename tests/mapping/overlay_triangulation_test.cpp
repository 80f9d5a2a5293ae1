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

// Far from the origin neighbouring doubles are so far apart that an overlay fits into an outline
// for some angles of the K-gon and not for others.
TEST(TriangulateByOverlay, DrawsAgainUntilTheMeshIsValid) {
  int drawn_again = 0, refused = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    std::vector<Points> outlines = DrawOutlines(OutlineFamilies()[1], seed, 2, 10);
    bool simple = true;
    for (Points& outline : outlines) {
      outline = ((outline.array() * 400.0).round() + 0x1p52).matrix();
      simple = simple && IsSimple(outline) && SignedArea(outline) > 0.0;
    }
    if (!simple) continue;
    const auto overlay = TriangulateByOverlay(outlines, 100'000, seed, nullptr);
    if (!overlay) {
      EXPECT_THAT(overlay, FailsWith(ErrorCode::kInternal));
      ++refused;
      continue;
    }
    EXPECT_FALSE(FindDefect(overlay->mesh).has_value()) << "seed " << seed;
    drawn_again += overlay->draws > 1 ? 1 : 0;
  }
  EXPECT_GT(drawn_again, 0);
  EXPECT_LT(refused, 20);
}

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
