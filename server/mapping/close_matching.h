// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_CLOSE_MATCHING_H_
#define POSESPACE_MAPPING_CLOSE_MATCHING_H_

#include <vector>

#include "mapping/matching_arcs.h"
#include "mapping/outline_curve.h"
#include "mapping/outline_map.h"
#include "mapping/stroke_sides.h"

namespace posespace {

// A match made closer: corners come to lie on corners and straight runs on straight runs, also
// where a thick letter's corners are far from a thin one's.  Windows along the outline, which the
// match before compared, see a corner only within their own width; here each place has the
// direction in which its outline runs there, too.  An arc comes to lie around the corner that it
// rounds off.
//
// Directions are compared after b is turned onto a, as a whole where that explains them all but as
// well, or else part by part (by their mean difference over 0.06 turns), as where limbs swing, or
// limb by limb (over 0.02), as where an arm is raised that hangs in the other drawing.
//
// Where both drawings are made of thin strokes for the most part, as letters and stick figures are,
// the two sides of strokes are kept together: each place is drawn towards the middle between its
// match and the place across from the match of its opposite side.
//
// Anchors, in their common cyclic order, are met exactly; every other place moves by 0.06 turns a
// pass at most.
//
// Cost  O(M B) with M = 1,024 samples and B = 123 of the other outline for each.
OutlineMap MatchClosely(const OutlineCurve& a, const StrokeSides& sides_a, const OutlineCurve& b,
                        const StrokeSides& sides_b, const std::vector<Anchor>& anchors,
                        const OutlineMap& map, const PairWeights& weights);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_CLOSE_MATCHING_H_
