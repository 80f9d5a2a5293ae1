// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_OUTLINE_MISMATCH_H_
#define POSESPACE_MAPPING_OUTLINE_MISMATCH_H_

#include <optional>
#include <vector>

#include "mapping/boundary_matching.h"
#include "mapping/outline_map.h"

namespace posespace {

// The worst mismatch between any two drawings, as in MatchedOutlines.
//
// `maps` go from a common parameter to each drawing's outline; landmark l lies at `landmarks[l]` of
// the parameter, and `order` lists the landmarks around it.
//
// Cost  O(N^2) with 256 steps a pair.
std::optional<Mismatch> FindMismatch(const std::vector<OutlineMap>& maps,
                                     const std::vector<double>& landmarks,
                                     const std::vector<int>& order);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_OUTLINE_MISMATCH_H_
