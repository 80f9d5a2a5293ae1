// SPDX-License-Identifier: Apache-2.0
#include "mapping/compatible_triangulation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "geometry/polygon.h"
#include "mapping/overlay_triangulation.h"
#include "tests/mapping/compatible_mesh_check.h"
#include "tests/mapping/outline_families.h"
#include "tests/support/fails_saying.h"
#include "tests/support/fails_with.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

int PartsOf(const Triangulation& triangulation, Level level) {
  return triangulation.levels[static_cast<std::size_t>(level)].parts;
}

// Rows [0, K) of each pose are its outline and the boundary loop; the rest counts as Steiner.
void ExpectTriangulates(const Result<Triangulation>& result, const std::vector<Points>& outlines) {
  ASSERT_THAT(result, Succeeds());
  const CompatibleMesh& mesh = result->mesh;
  const int n = static_cast<int>(outlines[0].rows());
  ASSERT_EQ(mesh.poses.size(), outlines.size());
  for (std::size_t s = 0; s < outlines.size(); ++s) {
    EXPECT_EQ(mesh.poses[s].topRows(n), outlines[s]) << "drawing " << s;
  }
  std::vector<int> rows(n);
  std::iota(rows.begin(), rows.end(), 0);
  EXPECT_EQ(mesh.boundary, std::vector<std::vector<int>>{rows});
  EXPECT_EQ(result->steiner_vertices, mesh.num_vertices() - n);
  EXPECT_LE(result->steiner_vertices, result->before_decimation);
  int parts = 0, steiner = 0;
  for (const LevelCount& level : result->levels) {
    parts += level.parts;
    steiner += level.steiner_vertices;
    EXPECT_TRUE(level.parts > 0 || level.steiner_vertices == 0);
  }
  EXPECT_GE(parts, 1);
  EXPECT_EQ(steiner, result->steiner_vertices);
  EXPECT_TRUE(parts > PartsOf(*result, Level::kZeroSteiner) || result->steiner_vertices == 0);
  EXPECT_THAT(mesh, IsACompatibleDisc());
}

class TriangulateFamily : public testing::TestWithParam<OutlineFamily> {};

TEST_P(TriangulateFamily, KeepsEveryTrianglePositiveInEveryDrawing) {
  for (const int count : {1, 2, 3, 5, 8}) {
    for (const int n : {6, 12, 24, 48}) {
      SCOPED_TRACE(testing::Message() << count << " outlines of " << n << " rows");
      const auto outlines = DrawOutlines(GetParam(), 100 * count + n, count, n);
      ExpectTriangulates(TriangulateCompatibly(outlines, {}), outlines);
    }
  }
}

TEST_P(TriangulateFamily, NeedsNoSteinerVertexForCopiesOfOneOutline) {
  for (const std::uint64_t seed : {1, 2, 3}) {
    const Points outline = DrawOutlines(GetParam(), seed, 1, 30)[0];
    const std::vector<Points> outlines = {outline, 2.0 * outline, 0.5 * outline};
    const auto result = TriangulateCompatibly(outlines, {});
    ExpectTriangulates(result, outlines);
    EXPECT_EQ(PartsOf(*result, Level::kZeroSteiner), 1);
    EXPECT_EQ(result->before_decimation, 0);
  }
}

INSTANTIATE_TEST_SUITE_P(Families, TriangulateFamily, testing::ValuesIn(OutlineFamilies()),
                         [](const auto& family) { return family.param.name; });

TEST(TriangulateCompatibly, NeverFoldsOverInHundredsOfUnrelatedOutlines) {
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const int count = 2 + static_cast<int>(seed % 4), n = 8 + static_cast<int>(seed % 17);
    const auto outlines = DrawMixedOutlines(seed, count, n - n % 6);
    ExpectTriangulates(TriangulateCompatibly(outlines, {}), outlines);
  }
}

TEST(TriangulateCompatibly, WorksAtTinyAndHugeScale) {
  for (const double scale : {1e-6, 1e6}) {
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      SCOPED_TRACE(testing::Message() << "scale " << scale << " seed " << seed);
      const auto outlines = DrawMixedOutlines(seed, 3, 18, scale);
      ExpectTriangulates(TriangulateCompatibly(outlines, {}), outlines);
    }
  }
}

TEST(TriangulateCompatibly, GivesTheSameTrianglesWhenAllDrawingsDouble) {
  const auto outlines = DrawMixedOutlines(7, 4, 24);
  std::vector<Points> doubled;
  for (const Points& outline : outlines) doubled.push_back(2.0 * outline);
  EXPECT_EQ(TriangulateCompatibly(outlines, {})->mesh.triangles,
            TriangulateCompatibly(doubled, {})->mesh.triangles);
}

TEST(TriangulateCompatibly, AnySeedGivesAValidMesh) {
  const auto outlines = DrawOutlines(OutlineFamilies()[1], 11, 3, 16);
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    TriangulationOptions options;
    options.seed = seed;
    ExpectTriangulates(TriangulateCompatibly(outlines, {}, options), outlines);
  }
}

TEST(TriangulateCompatibly, EqualInputGivesEqualOutput) {
  const auto outlines = DrawMixedOutlines(3, 4, 30);
  const auto first = TriangulateCompatibly(outlines, {}),
             second = TriangulateCompatibly(outlines, {});
  ASSERT_THAT(first, Succeeds());
  EXPECT_GT(first->steiner_vertices, 0);
  EXPECT_EQ(first->mesh.triangles, second->mesh.triangles);
  EXPECT_EQ(first->mesh.poses, second->mesh.poses);
}

TEST(TriangulateCompatibly, ReportsLandmarksAsTheirRows) {
  const auto outlines = DrawMixedOutlines(5, 3, 12);
  const std::vector<int> landmark_rows = {7, 0, 11};
  EXPECT_EQ(TriangulateCompatibly(outlines, landmark_rows)->mesh.landmarks, landmark_rows);
}

TEST(TriangulateCompatibly, TakesOneTriangleAsItIs) {
  const auto result = TriangulateCompatibly(std::vector{PointsOf("0 0, 4 0, 0 3")}, {});
  ASSERT_THAT(result, Succeeds());
  EXPECT_EQ(result->mesh.num_triangles(), 1);
}

// A published triangulator of two polygons does not end on a bat and a star.
TEST(TriangulateCompatibly, EndsOnABatAndAStarFromEveryStart) {
  const Points bat = PointsOf(
      "0 40, 12 14, 30 4, 44 10, 47 2, 50 8, 53 2, 56 10, 70 4, 88 14, 100 40, 90 33, 82 46, 74 36,"
      " 66 52, 58 40, 50 66, 42 40, 34 52, 26 36, 18 46, 10 33");
  const int n = static_cast<int>(bat.rows());
  for (int start = 0; start < n; ++start) {
    SCOPED_TRACE(testing::Message() << "start " << start);
    Points star(n, 2);
    for (int k = 0; k < n; ++k) {
      const double angle = 2.0 * std::numbers::pi * (k + start) / n;
      star.row(k) = ((k + start) % 2 == 0 ? 50.0 : 18.0) *
                    Eigen::RowVector2d(std::sin(angle), -std::cos(angle));
    }
    const std::vector<Points> outlines = {bat, star};
    ExpectTriangulates(TriangulateCompatibly(outlines, {}), outlines);
  }
}

// Two chevrons: each has one diagonal only, and they are not the same.
TEST(TriangulateCompatibly, AddsASteinerVertexWhereOutlinesShareNoTriangulation) {
  const std::vector<Points> outlines = {PointsOf("0 0, 4 0, 4 4, 3 1"),
                                        PointsOf("3 1, 0 0, 4 0, 4 4")};
  const auto result = TriangulateCompatibly(outlines, {});
  ExpectTriangulates(result, outlines);
  EXPECT_EQ(result->steiner_vertices, 1);
}

TEST(TriangulateCompatibly, MergesSteinerVerticesOfStarShapedOutlinesIntoFew) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const auto outlines = DrawOutlines(OutlineFamilies()[0], seed, 4, 20);
    EXPECT_LE(TriangulateCompatibly(outlines, {})->steiner_vertices, 4) << "seed " << seed;
  }
}

TEST(TriangulateCompatibly, RefusesOutlinesOfUnequalSize) {
  EXPECT_THAT(TriangulateCompatibly({}, {}), FailsWith(ErrorCode::kSizeMismatch));
  EXPECT_THAT(TriangulateCompatibly(
                  std::vector{PointsOf("0 0, 1 0, 0 1"), PointsOf("0 0, 1 0, 1 1, 0 1")}, {}),
              FailsSaying(ErrorCode::kSizeMismatch, "drawing 1 has 4 rows"));
  EXPECT_THAT(TriangulateCompatibly(std::vector{PointsOf("0 0, 1 0, 0 1")}, std::vector{3}),
              FailsSaying(ErrorCode::kSizeMismatch, "landmark row 3"));
}

TEST(TriangulateCompatibly, NamesTheDrawingAndEdgesOfAnOutlineThatIsNotSimple) {
  const Points square = PointsOf("0 0, 1 0, 1 1, 0 1");
  EXPECT_THAT(
      TriangulateCompatibly(std::vector{square, PointsOf("0 0, 2 2, 2 0, 0 2")}, {}),
      FailsSaying(ErrorCode::kOutlineNotSimple, "drawing 1 is not simple: edge 0 meets edge 2"));
  EXPECT_THAT(TriangulateCompatibly(std::vector{square, PointsOf("0 0, 0 1, 1 1, 1 0")}, {}),
              FailsSaying(ErrorCode::kOutlineNotSimple, "drawing 1 is negatively oriented"));
  Points endless = square;
  endless(2, 0) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(TriangulateCompatibly(std::vector{endless}, {}),
              FailsSaying(ErrorCode::kOutlineNotSimple, "not finite"));
  EXPECT_THAT(TriangulateCompatibly(std::vector{PointsOf("0 0, 1 0")}, {}),
              FailsSaying(ErrorCode::kOutlineNotSimple, "fewer than 3"));
}

TEST(TriangulateCompatibly, RefusesAMeshOfMoreVerticesThanAllowed) {
  const auto outlines = DrawOutlines(OutlineFamilies()[1], 0, 3, 30);
  const auto enough = TriangulateCompatibly(outlines, {});
  ASSERT_THAT(enough, Succeeds());
  TriangulationOptions options;
  options.max_vertices = enough->mesh.num_vertices();
  ASSERT_GT(enough->before_decimation, options.max_vertices);
  EXPECT_THAT(TriangulateCompatibly(outlines, {}, options), Succeeds());
  for (const int limit : {options.max_vertices - 1, 30, 29}) {
    options.max_vertices = limit;
    EXPECT_THAT(TriangulateCompatibly(outlines, {}, options),
                FailsSaying(ErrorCode::kMeshTooLarge, "limit is"));
  }
}

// Coordinates of the size of 2^54 are 4 apart, and these outlines leave no room for a vertex
// between.
TEST(TriangulateCompatibly, RefusesRatherThanFoldOverWhereNoDoubleFits) {
  std::vector<Points> outlines = {PointsOf("0 0, 4 0, 4 4, 3 1"), PointsOf("3 1, 0 0, 4 0, 4 4")};
  for (Points& outline : outlines) outline = (4.0 * outline.array() + 0x1p54).matrix();
  EXPECT_THAT(TriangulateCompatibly(outlines, {}), FailsSaying(ErrorCode::kInternal, "too thin"));
}

// Coordinates of the size of 2^52 are 1 apart.
TEST(TriangulateCompatibly, FindsRoomFarFromTheOriginWhereAnOverlayFindsNone) {
  int refused = 0, overlays_refused = 0;
  for (std::uint64_t seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::vector<Points> outlines = DrawOutlines(OutlineFamilies()[1], seed, 2, 14);
    bool usable = true;
    for (Points& outline : outlines) {
      outline = ((outline.array() * 160.0).round() + 0x1p52).matrix();
      usable = usable && IsSimple(outline) && SignedArea(outline) > 0.0;
    }
    if (!usable) continue;
    overlays_refused += TriangulateByOverlay(outlines, 100'000, 1, nullptr) ? 0 : 1;
    const auto result = TriangulateCompatibly(outlines, {});
    if (result) {
      ExpectTriangulates(result, outlines);
    } else {
      EXPECT_THAT(result, FailsSaying(ErrorCode::kInternal, "too thin"));
      ++refused;
    }
  }
  EXPECT_GT(overlays_refused, 0);
  EXPECT_LT(2 * refused, overlays_refused);
}

TEST(TriangulateCompatibly, StopsWhenCancelled) {
  const auto outlines = DrawOutlines(OutlineFamilies()[1], 2, 4, 30);
  Progress cancelled_before;
  cancelled_before.Cancel();
  EXPECT_THAT(TriangulateCompatibly(outlines, {}, {}, &cancelled_before),
              FailsWith(ErrorCode::kCancelled));
  // Between the two stages, too.
  Progress* running = nullptr;
  Progress cancelled_later([&](std::string_view, double fraction) {
    if (fraction > 0.5) running->Cancel();
  });
  running = &cancelled_later;
  EXPECT_THAT(TriangulateCompatibly(outlines, {}, {}, &cancelled_later),
              FailsWith(ErrorCode::kCancelled));
}

}  // namespace
}  // namespace posespace
