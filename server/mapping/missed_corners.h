// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_MISSED_CORNERS_H_
#define POSESPACE_MAPPING_MISSED_CORNERS_H_

#include <optional>
#include <span>

#include "mapping/boundary_matching.h"

namespace posespace {

// The two drawings that miss most of each other's sharp corners, as in MatchedOutlines; the first
// such pair when several miss as many.
//
// Requires  outlines in correspondence (MatchedOutlines).
// Cost      O(N M) to find corners, with M = 1,024 samples of an outline; small for each pair.
std::optional<MissedCorners> FindMissedCorners(std::span<const Points> outlines);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_MISSED_CORNERS_H_
