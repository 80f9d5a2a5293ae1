// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_MIRROR_SYMMETRY_H_
#define POSESPACE_MAPPING_MIRROR_SYMMETRY_H_

#include <optional>
#include <vector>

#include "mapping/outline_curve.h"
#include "mapping/outline_map.h"

namespace posespace {

// Mirror symmetries of outlines.  One about any axis takes position s to position sum - s, so that
// its sum, in turns, is all there is to know of it; its axis meets the outline at sum / 2 and half
// a turn on.

// The sums, in [0, 1), of the symmetries of an outline: those of which the outline and its mirror
// image differ by less than 3 % of its radius of gyration, root mean square.  Increasing; none when
// the outline is not symmetric.
//
// Cost  O(M^2) with M = 512 samples.
std::vector<double> FindMirrorSums(const OutlineCurve& curve);

// One symmetry of either of two outlines.
struct SymmetryPair {
  double sum_a;
  double sum_b;
  // How far a map between the outlines is from taking mirrored places to mirrored places: the mean
  // over the places, turns.
  double deviation;
};

// Of all pairs of symmetries of both outlines, the one that the map from the first to the second
// keeps best; none when it means no symmetry of the second by any of the first, within 0.1 turns.
std::optional<SymmetryPair> BestKeptSymmetry(const std::vector<double>& sums_a,
                                             const std::vector<double>& sums_b,
                                             const OutlineMap& map);

// A map between two symmetric outlines made exactly symmetric: the mean of the map and of its
// mirrored self, as strictly increasing as the map.
OutlineMap Symmetrised(const OutlineMap& map, const SymmetryPair& symmetry);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_MIRROR_SYMMETRY_H_
