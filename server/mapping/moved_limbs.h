// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_MOVED_LIMBS_H_
#define POSESPACE_MAPPING_MOVED_LIMBS_H_

#include <optional>

#include "mapping/outline_curve.h"
#include "mapping/pair_matching.h"

namespace posespace {

// A match by shape and thickness alone, and what it was found by.
struct LooseMatch {
  PairWeights weights;
  CoarseMatch match;
};

// For two upright drawings: the match that takes limbs for limbs wherever they lie, where it is
// another than `upright`, by 0.02 turns on average, and clearly better as JudgeMap sees both, by a
// tenth.  Position keeps left from right and head from tail, but it also takes a hanging tail for
// the thigh that lies where the other drawing's thigh is.
//
// Requires  curves whose thickness was measured; `upright` was found without anchors, by `weights`.
// Cost      that of MatchCoarsely, and less again.
std::optional<LooseMatch> MatchMovedLimbs(const OutlineCurve& a, const OutlineCurve& b,
                                          const CoarseMatch& upright, const PairWeights& weights);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_MOVED_LIMBS_H_
