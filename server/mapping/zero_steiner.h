// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_ZERO_STEINER_H_
#define POSESPACE_MAPPING_ZERO_STEINER_H_

#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/progress.h"
#include "mapping/ring_programme.h"

namespace posespace {

// The triangulation that N rings of n rows share without any Steiner vertex and whose smallest
// angle over all rings is largest; nothing when they share none, or when cancelled.  Triangles are
// rows of the rings, positive in every ring by an exact predicate.  `forbidden` chords are not
// used.
//
// Requires  simple, positively oriented rings.
// Cost      O(N n^3).
std::optional<std::vector<Triangle>> TriangulateRings(
    std::span<const Points> rings, std::span<const std::pair<int, int>> forbidden = {},
    Progress* progress = nullptr);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_ZERO_STEINER_H_
