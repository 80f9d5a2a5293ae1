// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_MATCHED_PLACES_H_
#define POSESPACE_MAPPING_MATCHED_PLACES_H_

#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace posespace {

// The same places on all outlines, for a person to look at: `count` of them, spaced evenly by the
// mean over the outlines of the share of the perimeter passed.  Row 0 is the place where all
// outlines turn most, a tip or a notch: if that one is right, the start of the matching is.
//
// Requires  outlines in correspondence (MatchedOutlines), n >= 3 rows each; count >= 1.
// Returns   one count x 2 per outline, row k the same place in each, in drawing pixels; depends on
//           the order of the outlines only in its own.
std::vector<Points> SampleTogether(std::span<const Points> outlines, int count);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_MATCHED_PLACES_H_
