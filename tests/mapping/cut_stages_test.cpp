// SPDX-License-Identifier: Apache-2.0
#include "mapping/cut_stages.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <vector>

#include "geometry/polygon.h"
#include "mapping/cut_triangulation.h"
#include "mapping/link_paths.h"
#include "mapping/visibility.h"
#include "mapping/zero_steiner.h"
#include "tests/mapping/compatible_mesh_check.h"
#include "tests/mapping/outline_families.h"
#include "tests/support/fails_with.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

std::vector<Points> SideOf(const std::vector<Points>& rings, const Cut& cut, const CutSide& side) {
  std::vector<Points> parts;
  for (std::size_t s = 0; s < rings.size(); ++s) {
    Points& part = parts.emplace_back(static_cast<Eigen::Index>(side.rows.size()), 2);
    for (std::size_t k = 0; k < side.rows.size(); ++k) {
      const int row = side.rows[k], n = static_cast<int>(rings[s].rows());
      part.row(static_cast<Eigen::Index>(k)) =
          row < n ? rings[s].row(row) : cut.bends[s].row(row - n);
    }
  }
  return parts;
}

// Whether some chord is inside all rings.
bool ShareAChord(const std::vector<Points>& rings) {
  const int n = static_cast<int>(rings[0].rows());
  for (int i = 0; i < n; ++i) {
    for (int j = 0; j < i; ++j) {
      if (std::all_of(rings.begin(), rings.end(),
                      [&](const Points& ring) { return RowSeesRow(ring, i, j); })) {
        return true;
      }
    }
  }
  return false;
}

TEST(LinkPaths, CountTheBendsAroundCorners) {
  // A U: from foot to foot one must bend twice.
  const LinkPaths paths(PointsOf("0 0, 9 0, 9 9, 6 9, 6 3, 3 3, 3 9, 0 9"));
  EXPECT_EQ(paths.Bends(7, 6), 1);
  EXPECT_EQ(paths.Bends(7, 2), 2);
  EXPECT_EQ(paths.Bends(2, 7), 2);
}

TEST(LinkPaths, RunStrictlyInside) {
  for (std::uint64_t seed = 0; seed < 14; ++seed) {
    const Points ring = DrawOutlines(OutlineFamilies()[seed % 7], seed, 1, 18)[0];
    const LinkPaths paths(ring);
    for (int i = 0; i < 18; i += 3) {
      for (int j = i + 2; j < 18; j += 4) {
        const int bends = paths.Bends(i, j);
        if (bends == LinkPaths::kNoPath) continue;
        EXPECT_EQ(paths.Bends(j, i), bends);
        const auto path = paths.Path(i, j, bends);
        ASSERT_TRUE(path.has_value());
        ASSERT_EQ(static_cast<int>(path->size()), bends);
        EXPECT_TRUE(RowSeesPoint(ring, i, path->front()));
        EXPECT_TRUE(RowSeesPoint(ring, j, path->back()));
        for (int b = 0; b < bends; ++b) {
          EXPECT_GT(Locate((*path)[b], ring), 0);
          EXPECT_TRUE(b == 0 || PointSeesPoint(ring, (*path)[b - 1], (*path)[b]));
        }
        EXPECT_TRUE(bends == 1 || !paths.Path(i, j, bends - 1));
      }
    }
  }
}

// Two chevrons with a triangle added on one side: they share the chord that cuts it off, no more.
TEST(FindCut, StageICutsByAChordThatIsInsideEveryRing) {
  const std::vector<Points> rings = {PointsOf("0 0, 4 0, 6 2, 4 4, 3 1"),
                                     PointsOf("3 1, 0 0, 2 -2, 4 0, 4 4")};
  ASSERT_FALSE(TriangulateRings(rings).has_value());
  const auto cut = FindCut(rings, nullptr);
  ASSERT_TRUE(cut.has_value());
  EXPECT_EQ(cut->level, Level::kStraightCut);
  EXPECT_EQ(cut->sides[0].rows, (std::vector<int>{1, 2, 3}));
  EXPECT_TRUE(cut->sides[0].triangles.has_value());
  EXPECT_FALSE(cut->sides[1].triangles.has_value());
}

TEST(FindCut, StageIICutsOverOneVertexWhereNoChordIsInsideEveryRing) {
  const std::vector<Points> rings = {PointsOf("2 4, 1 4, 2 2, 4 5, 6 7"),
                                     PointsOf("4 9, 0 0, 8 4, 6 7, 3 6")};
  ASSERT_FALSE(ShareAChord(rings));
  const auto cut = FindCut(rings, nullptr);
  ASSERT_TRUE(cut.has_value());
  EXPECT_EQ(cut->level, Level::kOnePointCut);
  for (const Points& bends : cut->bends) EXPECT_EQ(bends.rows(), 1);
}

TEST(FindCut, StageIIICutsAlongAPathWhereOneVertexIsNotEnough) {
  const std::vector<Points> rings = {PointsOf("6 5, 3 1, 8 0, 6 4, 5 2"),
                                     PointsOf("3 4, 1 4, 0 5, 1 2, 7 6")};
  ASSERT_FALSE(ShareAChord(rings));
  const auto cut = FindCut(rings, nullptr);
  ASSERT_TRUE(cut.has_value());
  EXPECT_EQ(cut->level, Level::kLinkPathCut);
  for (const Points& bends : cut->bends) EXPECT_GE(bends.rows(), 2);
}

// Two chevrons: no chord is inside both, and a cut over one vertex leaves a side of four rows.
TEST(FindCut, FindsNothingWhereNoCutMakesPartsSmaller) {
  const std::vector<Points> rings = {PointsOf("0 0, 4 0, 4 4, 3 1"),
                                     PointsOf("3 1, 0 0, 4 0, 4 4")};
  ASSERT_FALSE(ShareAChord(rings));
  const auto cut = FindCut(rings, nullptr);
  EXPECT_TRUE(!cut || (cut->sides[0].triangles && cut->sides[1].triangles));
}

TEST(FindCut, StopsWhenCancelled) {
  Progress progress;
  progress.Cancel();
  const auto rings = DrawOutlines(OutlineFamilies()[1], 3, 3, 30);
  EXPECT_FALSE(FindCut(rings, &progress).has_value());
  EXPECT_THAT(TriangulateByCuts(rings, 100'000, 1, &progress), FailsWith(ErrorCode::kCancelled));
}

TEST(FindCut, SidesAreSimpleEverywhereAndGetSmaller) {
  std::vector<int> found(kNumLevels, 0);
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    const int n = 12 + 6 * static_cast<int>(seed % 4);
    const auto rings = DrawMixedOutlines(seed, 2 + static_cast<int>(seed % 3), n);
    if (TriangulateRings(rings)) continue;
    const auto cut = FindCut(rings, nullptr);
    if (!cut) continue;
    ++found[static_cast<std::size_t>(cut->level)];
    const auto bends = cut->bends[0].rows();
    EXPECT_EQ(static_cast<Eigen::Index>(cut->sides[0].rows.size() + cut->sides[1].rows.size()),
              n + 2 + 2 * bends);
    for (const CutSide& side : cut->sides) {
      for (const Points& part : SideOf(rings, *cut, side)) {
        EXPECT_TRUE(IsSimple(part)) << "seed " << seed;
        EXPECT_GT(SignedArea(part), 0.0) << "seed " << seed;
      }
      EXPECT_TRUE(side.triangles || static_cast<int>(side.rows.size()) < n) << "seed " << seed;
    }
  }
  EXPECT_GT(found[static_cast<std::size_t>(Level::kStraightCut)], 10);
}

TEST(TriangulateByCuts, EndsWithAValidMeshAndSaysWhereItsVerticesComeFrom) {
  std::vector<int> parts(kNumLevels, 0);
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const int n = 12 + 6 * static_cast<int>(seed % 4);
    const auto rings = DrawMixedOutlines(seed, 2 + static_cast<int>(seed % 3), n);
    if (TriangulateRings(rings)) continue;
    const auto result = TriangulateByCuts(rings, 100'000, seed, nullptr);
    ASSERT_THAT(result, Succeeds());
    EXPECT_THAT(result->mesh, IsACompatibleDisc());
    EXPECT_EQ(n + static_cast<int>(result->origin.size()), result->mesh.num_vertices());
    for (std::size_t level = 0; level < kNumLevels; ++level) parts[level] += result->parts[level];
    EXPECT_EQ(std::count(result->origin.begin(), result->origin.end(), Level::kOnePointCut),
              result->parts[static_cast<std::size_t>(Level::kOnePointCut)]);
    EXPECT_EQ(std::count(result->origin.begin(), result->origin.end(), Level::kZeroSteiner), 0);
    EXPECT_EQ(std::count(result->origin.begin(), result->origin.end(), Level::kStraightCut), 0);
  }
  for (std::size_t level = 0; level < kNumLevels; ++level) {
    EXPECT_GT(parts[level], 0) << kLevelNames[level];
  }
}

}  // namespace
}  // namespace posespace
