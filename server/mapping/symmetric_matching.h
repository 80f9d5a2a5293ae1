// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_SYMMETRIC_MATCHING_H_
#define POSESPACE_MAPPING_SYMMETRIC_MATCHING_H_

#include <vector>

#include "mapping/outline_curve.h"
#include "mapping/pair_matching.h"

namespace posespace {

// MatchFinely, but a match between mirror-symmetric drawings that takes mirrored places past
// mirrored places by 0.01 turns or more, on average, gives way to an exactly symmetric one where
// that costs at most 1.1 times as much: the outlines are matched again with the ends of one's axis
// tied to those of the other's.  Halfway between, such drawings are as symmetric as they are
// themselves.  `sums_a` and `sums_b` are their FindMirrorSums; any other match is MatchFinely's,
// bit for bit.
//
// Anchors are met exactly.  They forbid this when they are not symmetric themselves, that is when
// the mirror images of an anchor's places are no anchor's, within 0.01 turns; where they are, the
// match is as symmetric as they.
//
// Requires  anchors as MatchFinely does.
// Cost      that of two matches at most.
FineMatch MatchSymmetrically(const OutlineCurve& a, const std::vector<double>& sums_a,
                             const OutlineCurve& b, const std::vector<double>& sums_b,
                             const std::vector<Anchor>& anchors, const std::vector<double>& starts,
                             const PairWeights& weights);

// `close`, or where `match` is exactly symmetric, as MatchSymmetrically makes it, `close` made so
// by the same symmetries.
OutlineMap KeepSymmetry(const OutlineMap& match, const std::vector<double>& sums_a,
                        const std::vector<double>& sums_b, OutlineMap close);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_SYMMETRIC_MATCHING_H_
