// SPDX-License-Identifier: Apache-2.0
#include "mapping/zero_steiner.h"

#include <algorithm>
#include <limits>

#include "geometry/polygon.h"
#include "mapping/triangle_quality.h"

namespace posespace {

std::optional<std::vector<Triangle>> TriangulateRings(
    std::span<const Points> rings, std::span<const std::pair<int, int>> forbidden,
    Progress* progress) {
  constexpr double kInfinite = std::numeric_limits<double>::infinity();
  constexpr double kSharpest = 1e30;  // positive but flat in double: still better than none

  ChordTable chords(static_cast<int>(rings[0].rows()));
  for (const auto& [i, j] : forbidden) chords.Forbid(i, j);
  for (const Points& ring : rings) chords.KeepChordsInside(ring);

  const auto sharpness = [&](int i, int k, int j) {
    double worst = 0.0;
    for (const Points& ring : rings) {
      const Point a = ring.row(i), b = ring.row(k), c = ring.row(j);
      if (Orientation(a, b, c) <= 0) return kInfinite;
      worst = std::max(worst, std::min(Sharpness(a, b, c), kSharpest));
    }
    return worst;
  };
  const auto worst_of = [](float left, float right, float triangle) {
    return std::max({left, right, triangle});
  };
  return CheapestRingTriangulation(chords, sharpness, worst_of, progress);
}

}  // namespace posespace
