// SPDX-License-Identifier: Apache-2.0
#include "mapping/moved_limbs.h"

#include <cmath>
#include <utility>

#include "mapping/map_judgement.h"

namespace posespace {
namespace {

// From 0.07 to 0.15 the same groups of real drawings are right.
constexpr double kThicknessWeight = 0.1;
constexpr double kLeastApart = 0.02;  // turns, on average; maps that are nearer are the same
// What a loose match may cost, judged, of the upright one.  From 0.8 to 1 the same groups of real
// drawings are right.
constexpr double kClearlyBetter = 0.9;
constexpr int kSteps = 64;

double MeanDistance(const OutlineMap& map, const OutlineMap& other) {
  double sum = 0.0;
  for (int k = 0; k < kSteps; ++k) {
    const double position = static_cast<double>(k) / kSteps;
    const double turns = map.At(position) - other.At(position);
    sum += std::abs(turns - std::round(turns));
  }
  return sum / kSteps;
}

}  // namespace

std::optional<LooseMatch> MatchMovedLimbs(const OutlineCurve& a, const OutlineCurve& b,
                                          const CoarseMatch& upright, const PairWeights& weights) {
  LooseMatch loose{{0.0, 0.0, weights.stretch, kThicknessWeight}, {}};
  loose.match = MatchCoarsely(a, b, {}, loose.weights);
  const OutlineMap upright_map = MatchFrom(a, b, upright.starts[0], weights);
  const OutlineMap loose_map = MatchFrom(a, b, loose.match.starts[0], loose.weights);
  if (MeanDistance(upright_map, loose_map) < kLeastApart) return std::nullopt;
  const double limit = kClearlyBetter * JudgeMap(a, b, upright_map, weights.colour);
  if (JudgeMap(a, b, loose_map, weights.colour) >= limit) return std::nullopt;
  return loose;
}

}  // namespace posespace
