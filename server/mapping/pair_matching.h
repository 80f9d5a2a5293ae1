// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_PAIR_MATCHING_H_
#define POSESPACE_MAPPING_PAIR_MATCHING_H_

#include <vector>

#include "mapping/matching_arcs.h"
#include "mapping/outline_curve.h"
#include "mapping/outline_map.h"

namespace posespace {

struct CoarseMatch {
  double cost;
  OutlineMap map;
  std::vector<double>
      starts;  // without anchors: the places on b where a may begin, likeliest first
};

struct FineMatch {
  double cost;
  OutlineMap map;
};

// A quick match of a to b from 64 samples, over all places of b where a may begin unless anchors
// (in their common cyclic order, distinct) say so.
CoarseMatch MatchCoarsely(const OutlineCurve& a, const OutlineCurve& b,
                          const std::vector<Anchor>& anchors, const PairWeights& weights);

// A match from 128 samples that takes a's position 0 to this one of b: quick, but finer than the
// coarse one, for maps to be compared.
OutlineMap MatchFrom(const OutlineCurve& a, const OutlineCurve& b, double start,
                     const PairWeights& weights);

// A match from 256 samples refined to 1024, through the anchors or, when there are none, from the
// best of the given starts.  The cut is moved to the most salient pair of places and the match
// repeated, so that no start is met exactly only because it was a sample.
FineMatch MatchFinely(const OutlineCurve& a, const OutlineCurve& b,
                      const std::vector<Anchor>& anchors, const std::vector<double>& starts,
                      const PairWeights& weights);

// The mean colour difference along the map, RGB in [0, 1].
double MeanColourDifference(const OutlineCurve& a, const OutlineCurve& b, const OutlineMap& map);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_PAIR_MATCHING_H_
