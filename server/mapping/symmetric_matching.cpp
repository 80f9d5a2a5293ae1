// SPDX-License-Identifier: Apache-2.0
#include "mapping/symmetric_matching.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mapping/mirror_symmetry.h"

namespace posespace {
namespace {

constexpr double kLeastDeviation = 0.01;  // turns; what is off by less looks symmetric
// A symmetric match that costs more than this many times the free one loses something else; between
// real drawings it costs 0.75 to 1.03 times as much.
constexpr double kSymmetricTie = 1.1;
constexpr double kSamePlace = 0.01;  // turns
constexpr double kExact = 1e-9;      // turns; deviations of exactly symmetric maps, by rounding

bool IsSamePlace(double position, double other) {
  return std::abs(position - other - std::round(position - other)) < kSamePlace;
}

bool AreSymmetric(const std::vector<Anchor>& anchors, const SymmetryPair& symmetry) {
  return std::all_of(anchors.begin(), anchors.end(), [&](const Anchor& anchor) {
    return std::any_of(anchors.begin(), anchors.end(), [&](const Anchor& other) {
      return IsSamePlace(other.on_a, symmetry.sum_a - anchor.on_a) &&
             IsSamePlace(other.on_b, symmetry.sum_b - anchor.on_b);
    });
  });
}

// The anchors and, where none of them is, the ends of the axes, either matched with the nearer one
// by the map; in their order along a.
std::vector<Anchor> WithAxis(std::vector<Anchor> anchors, const SymmetryPair& symmetry,
                             const OutlineMap& map) {
  const double end_a = 0.5 * symmetry.sum_a;
  double end_b = 0.5 * symmetry.sum_b;
  end_b += 0.5 * std::round(2.0 * (map.At(end_a) - end_b));
  const std::vector<Anchor> given = anchors;
  for (const Anchor& end : {Anchor{end_a, end_b}, Anchor{end_a + 0.5, end_b + 0.5}}) {
    if (std::none_of(given.begin(), given.end(), [&](const Anchor& anchor) {
          return IsSamePlace(anchor.on_a, end.on_a) || IsSamePlace(anchor.on_b, end.on_b);
        })) {
      anchors.push_back({end.on_a - std::floor(end.on_a), end.on_b});
    }
  }
  std::sort(anchors.begin(), anchors.end(),
            [](const Anchor& x, const Anchor& y) { return x.on_a < y.on_a; });
  return anchors;
}

// True when the anchors, sorted along a, follow each other around b, too.
bool AreInOrder(const std::vector<Anchor>& anchors) {
  double turns = 0.0;
  for (std::size_t k = 0; k < anchors.size(); ++k) {
    const double step = anchors[(k + 1) % anchors.size()].on_b - anchors[k].on_b;
    turns += step - std::floor(step);
  }
  return std::lround(turns) == 1;
}

}  // namespace

FineMatch MatchSymmetrically(const OutlineCurve& a, const std::vector<double>& sums_a,
                             const OutlineCurve& b, const std::vector<double>& sums_b,
                             const std::vector<Anchor>& anchors, const std::vector<double>& starts,
                             const PairWeights& weights) {
  FineMatch match = MatchFinely(a, b, anchors, starts, weights);
  const auto symmetry = BestKeptSymmetry(sums_a, sums_b, match.map);
  if (!symmetry || symmetry->deviation < kLeastDeviation || !AreSymmetric(anchors, *symmetry)) {
    return match;
  }
  const std::vector<Anchor> through = WithAxis(anchors, *symmetry, match.map);
  if (!AreInOrder(through)) return match;
  FineMatch symmetric = MatchFinely(a, b, through, {}, weights);
  if (symmetric.cost > kSymmetricTie * match.cost) return match;
  if (anchors.empty()) symmetric.map = Symmetrised(symmetric.map, *symmetry);
  return symmetric;
}

OutlineMap KeepSymmetry(const OutlineMap& match, const std::vector<double>& sums_a,
                        const std::vector<double>& sums_b, OutlineMap close) {
  const auto symmetry = BestKeptSymmetry(sums_a, sums_b, match);
  if (!symmetry || symmetry->deviation > kExact) return close;
  return Symmetrised(close, *symmetry);
}

}  // namespace posespace
