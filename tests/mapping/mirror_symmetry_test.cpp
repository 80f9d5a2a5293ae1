// SPDX-License-Identifier: Apache-2.0
#include "mapping/mirror_symmetry.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "mapping/symmetric_matching.h"
#include "tests/mapping/matching_cases.h"

namespace posespace {
namespace {

constexpr PairWeights kWeights{0.15, 0.0, 0.05, 0.0};

// A figure that is its own mirror image about x = 0, with an edge across the axis at either end:
// row k's image is row 2 rows_each_side - 1 - k.
Points SymmetricFigure(int rows_each_side, std::uint32_t seed) {
  Sequence next(seed);
  Points ring(2 * rows_each_side, 2);
  for (int k = 0; k < rows_each_side; ++k) {
    const double x = 10.0 + 40.0 * next(), y = 10.0 * k;
    ring.row(k) << x, y;
    ring.row(2 * rows_each_side - 1 - k) << -x, y;
  }
  return ring;
}

// Two different symmetric figures, and what is known of them.
struct SymmetricPair {
  explicit SymmetricPair(std::uint32_t seed)
      : rows(6 + static_cast<int>(seed % 9)),
        a(SymmetricFigure(rows, seed), {}),
        b(SymmetricFigure(rows + 1, seed + 200), {}),
        sums_a(FindMirrorSums(a)),
        sums_b(FindMirrorSums(b)),
        starts(MatchCoarsely(a, b, {}, kWeights).starts) {}

  FineMatch Free(const std::vector<Anchor>& anchors = {}) const {
    return MatchFinely(a, b, anchors, starts, kWeights);
  }
  FineMatch Symmetric(const std::vector<Anchor>& anchors = {}) const {
    return MatchSymmetrically(a, sums_a, b, sums_b, anchors, starts, kWeights);
  }
  // How far mirrored places go from mirrored places, the mean in turns.
  double Deviation(const OutlineMap& map) const {
    double sum = 0.0;
    for (int k = 0; k < 1000; ++k) {
      const double turns = map.At(k / 1000.0) + map.At(sums_a[0] - k / 1000.0) - sums_b[0];
      sum += std::abs(turns - std::round(turns)) / 1000.0;
    }
    return sum;
  }
  // Corner k of a with corner k of b; negative: counted from the last.
  Anchor Corner(int k) const {
    return {a.corner_position((k + 2 * rows) % (2 * rows)),
            b.corner_position((k + 2 * rows + 2) % (2 * rows + 2))};
  }

  int rows;
  OutlineCurve a;
  OutlineCurve b;
  std::vector<double> sums_a;
  std::vector<double> sums_b;
  std::vector<double> starts;
};

void ExpectStrictlyIncreasing(const OutlineMap& map) {
  for (std::size_t k = 1; k < map.to().size(); ++k) {
    EXPECT_GT(map.from()[k], map.from()[k - 1]);
    EXPECT_GT(map.to()[k], map.to()[k - 1]);
  }
  EXPECT_DOUBLE_EQ(map.from().back(), map.from().front() + 1.0);
  EXPECT_DOUBLE_EQ(map.to().back(), map.to().front() + 1.0);
}

TEST(FindMirrorSums, FindsThemAboutAnyAxisFromAnyStart) {
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    const int start = static_cast<int>(seed);
    const OutlineCurve curve(StartedAt(Turned(SymmetricFigure(9, seed), 0.7 * seed), start), {});
    const std::vector<double> sums = FindMirrorSums(curve);
    ASSERT_EQ(sums.size(), 1u) << seed;
    // The figure's first corner and its last are mirror images.
    const int first = (18 - start) % 18, last = (first + 17) % 18;
    const double turns = curve.corner_position(first) + curve.corner_position(last) - sums[0];
    EXPECT_NEAR(turns, std::round(turns), 1e-3) << seed;
  }
}

TEST(FindMirrorSums, FindsAllOfASquare) {
  Points square(4, 2);
  square << 0, 0, 10, 0, 10, 10, 0, 10;
  const std::vector<double> sums = FindMirrorSums(OutlineCurve(square, {}));
  ASSERT_EQ(sums.size(), 4u);
  for (const double sum : sums) EXPECT_NEAR(4.0 * sum, std::round(4.0 * sum), 1e-9);
}

TEST(FindMirrorSums, FindsNoneInFiguresWithoutAnyOrWithOneArmOut) {
  for (std::uint32_t seed = 0; seed < 8; ++seed) {
    EXPECT_TRUE(FindMirrorSums(OutlineCurve(Figure(60, 5, 100.0, seed), {})).empty()) << seed;
    Points figure = SymmetricFigure(9, seed);
    figure(4, 0) += 25.0;
    EXPECT_TRUE(FindMirrorSums(OutlineCurve(figure, {})).empty()) << seed;
  }
}

TEST(BestKeptSymmetry, IsTheOneThatTheMapMeans) {
  const OutlineMap quarter({0.0, 1.0}, {0.25, 1.25});
  const auto kept = BestKeptSymmetry({0.3}, {0.05, 0.4, 0.78}, quarter);
  ASSERT_TRUE(kept.has_value());
  EXPECT_EQ(kept->sum_b, 0.78);
  EXPECT_NEAR(kept->deviation, 0.0, 1e-12);
  EXPECT_FALSE(BestKeptSymmetry({0.3}, {0.05, 0.4}, quarter).has_value());
  EXPECT_FALSE(BestKeptSymmetry({}, {0.8}, quarter).has_value());
  EXPECT_FALSE(BestKeptSymmetry({0.3}, {}, quarter).has_value());
}

TEST(Symmetrised, IsExactlySymmetricAndStrictlyIncreasing) {
  const OutlineMap map({0.1, 0.2, 0.5, 0.9, 1.1}, {0.7, 0.9, 1.1, 1.4, 1.7});
  const OutlineMap symmetrised = Symmetrised(map, {0.3, 1.9, 0.0});
  ExpectStrictlyIncreasing(symmetrised);
  for (double position = 0.0; position < 1.0; position += 0.037) {
    const double turns = symmetrised.At(position) + symmetrised.At(0.3 - position) - 1.9;
    EXPECT_NEAR(turns, std::round(turns), 1e-9);
  }
}

TEST(MatchSymmetrically, TakesMirroredPlacesToMirroredPlaces) {
  int asymmetric = 0, left = 0;
  for (std::uint32_t seed = 0; seed < 40; ++seed) {
    const SymmetricPair pair(seed);
    const OutlineMap map = pair.Symmetric().map;
    ExpectStrictlyIncreasing(map);
    asymmetric += pair.Deviation(pair.Free().map) > 0.01;
    left += pair.Deviation(map) > 0.01;
  }
  EXPECT_GE(asymmetric, 6);
  EXPECT_LE(left, 1);  // figures so unlike that their match means no symmetry at all
}

TEST(MatchSymmetrically, LeavesFiguresWithoutSymmetryAsTheyAre) {
  for (std::uint32_t seed = 30; seed < 36; ++seed) {
    SymmetricPair pair(seed);
    Points figure = SymmetricFigure(pair.rows, seed);
    figure(pair.rows / 2, 0) += 25.0;
    pair.a = OutlineCurve(figure, {});
    pair.sums_a = FindMirrorSums(pair.a);
    const FineMatch match = pair.Symmetric(), free = pair.Free();
    EXPECT_EQ(match.map.from(), free.map.from()) << seed;
    EXPECT_EQ(match.map.to(), free.map.to()) << seed;
    EXPECT_EQ(match.cost, free.cost) << seed;
  }
}

TEST(MatchSymmetrically, LeavesMatchesThroughAsymmetricAnchorsAsTheyAre) {
  for (std::uint32_t seed = 36; seed < 40; ++seed) {
    const SymmetricPair pair(seed);
    for (const std::vector<Anchor>& anchors :
         {std::vector<Anchor>{pair.Corner(3)}, {pair.Corner(0), pair.Corner(2), pair.Corner(-1)}}) {
      const FineMatch match = pair.Symmetric(anchors), free = pair.Free(anchors);
      EXPECT_EQ(match.map.from(), free.map.from()) << seed;
      EXPECT_EQ(match.map.to(), free.map.to()) << seed;
    }
  }
}

TEST(MatchSymmetrically, MeetsSymmetricAnchorsExactly) {
  int straightened = 0;
  for (std::uint32_t seed = 30; seed < 44; ++seed) {
    const SymmetricPair pair(seed);
    const std::vector<Anchor> anchors = {pair.Corner(0), pair.Corner(-1)};
    const OutlineMap map = pair.Symmetric(anchors).map;
    ExpectStrictlyIncreasing(map);
    for (const Anchor& anchor : anchors) {
      const double turns = map.At(anchor.on_a) - anchor.on_b;
      EXPECT_NEAR(turns, std::round(turns), 1e-12) << seed;
    }
    const double before = pair.Deviation(pair.Free(anchors).map);
    EXPECT_LE(pair.Deviation(map), std::max(before, 0.01)) << seed;
    straightened += before > 0.01 && pair.Deviation(map) < 0.01;
  }
  EXPECT_GE(straightened, 1);
}

TEST(MatchBoundaries, KeepsHalvesOfSymmetricDrawingsSymmetricBesideOnesThatAreNot) {
  for (const std::uint32_t seed : {9u, 37u, 38u}) {
    const int rows = 6 + static_cast<int>(seed % 9);
    const std::vector<Points> outlines = {SymmetricFigure(rows, seed),
                                          SymmetricFigure(rows + 1, seed + 200),
                                          Figure(60, 5, 80.0, seed)};
    for (const std::size_t count : {2u, 3u}) {
      const auto shapes = ShapesOf({outlines.begin(), outlines.begin() + count});
      const MatchedOutlines match = Matched(shapes);
      ExpectRingsFollowOutlines(match, shapes);
      const Points half = 0.5 * (match.outlines[0] + match.outlines[1]);
      Points mirrored = half;
      mirrored.col(0) *= -1.0;
      EXPECT_LT(FarthestFrom(mirrored, half), 1.0) << seed << " of " << count;
    }
  }
}

TEST(KeepSymmetry, MakesAMatchSymmetricAgainWhereTheOneBeforeItWas) {
  for (std::uint32_t seed = 0; seed < 6; ++seed) {
    const SymmetricPair pair(seed);
    const OutlineMap free = pair.Free().map;
    const auto symmetry = BestKeptSymmetry(pair.sums_a, pair.sums_b, free);
    ASSERT_TRUE(symmetry.has_value());
    const OutlineMap match = Symmetrised(free, *symmetry);
    const OutlineMap close = OutlineMap({0.0, 0.3, 1.0}, {0.0, 0.302, 1.0}).Then(match);
    EXPECT_GT(pair.Deviation(close), 1e-4);
    const OutlineMap kept = KeepSymmetry(match, pair.sums_a, pair.sums_b, close);
    EXPECT_LT(pair.Deviation(kept), 1e-9);
    ExpectStrictlyIncreasing(kept);
  }
}

TEST(KeepSymmetry, LeavesAMatchAsItIsWhereTheOneBeforeItWasNotSymmetric) {
  const SymmetricPair pair(1);
  const OutlineMap off({0.0, 0.3, 1.0}, {0.0, 0.302, 1.0});
  const OutlineMap match = off.Then(pair.Symmetric().map);
  ASSERT_GT(pair.Deviation(match), 1e-4);
  EXPECT_EQ(KeepSymmetry(match, pair.sums_a, pair.sums_b, off).to(), off.to());
}

}  // namespace
}  // namespace posespace
