// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <numbers>

#include "interpolation/rigid_blend.h"

namespace posespace {
namespace {

// The whole turns that bring `angle` within half a turn of `reference`; half a turn away, but for
// rounding, it stays where it is.
int TurnsTowards(double reference, double angle) {
  constexpr double kHalf = 0.5 + 1e-9;
  const double turns = (reference - angle) / (2.0 * std::numbers::pi);
  return static_cast<int>(turns > 0.0 ? std::ceil(turns - kHalf) : std::floor(turns + kHalf));
}

}  // namespace

std::vector<int> TurnsAlongPlacements(const std::vector<double>& mean_rotations,
                                      const Points& placements) {
  const int count = static_cast<int>(mean_rotations.size());
  std::vector<int> turns(mean_rotations.size(), 0);

  // Prim's tree from pose 0; of equally near poses the first joins first.
  std::vector<bool> joined(mean_rotations.size(), false);
  std::vector<int> nearest(mean_rotations.size(), 0);
  std::vector<double> distance(mean_rotations.size(), std::numeric_limits<double>::infinity());
  for (int newest = 0, step = 1; step < count; ++step) {
    joined[newest] = true;
    int next = -1;
    for (int i = 0; i < count; ++i) {
      if (joined[i]) continue;
      const double to_newest = (placements.row(i) - placements.row(newest)).stableNorm();
      if (to_newest < distance[i]) {
        distance[i] = to_newest;
        nearest[i] = newest;
      }
      if (next < 0 || distance[i] < distance[next]) next = i;
    }
    const double parent_angle =
        mean_rotations[nearest[next]] + 2.0 * std::numbers::pi * turns[nearest[next]];
    turns[next] = TurnsTowards(parent_angle, mean_rotations[next]);
    newest = next;
  }
  return turns;
}

}  // namespace posespace
