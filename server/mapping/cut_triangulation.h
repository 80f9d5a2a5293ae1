// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_CUT_TRIANGULATION_H_
#define POSESPACE_MAPPING_CUT_TRIANGULATION_H_

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/progress.h"
#include "geometry/result.h"
#include "mapping/triangulation_levels.h"

namespace posespace {

struct CutTriangulation {
  CompatibleMesh mesh;                  // the outlines' rows, then the Steiner vertices
  std::vector<Level> origin;            // of each Steiner vertex
  std::array<int, kNumLevels> parts{};  // triangulated or cut by each level
};

// Divide and conquer: outlines that share no triangulation are cut in two (cut_stages.h), and each
// side is triangulated without Steiner vertices, or cut again, or, where no cut helps, handed to
// the overlay (overlay_triangulation.h).
//
// Requires  N >= 1 simple, positively oriented outlines of equal size that share no triangulation.
// Fails     as TriangulateByOverlay does; kMeshTooLarge beyond `max_vertices`, kCancelled.
// Cost      O(N K^3) a cut, K cuts at most.
Result<CutTriangulation> TriangulateByCuts(std::span<const Points> outlines,
                                           std::int64_t max_vertices, std::uint64_t seed,
                                           Progress* progress);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_CUT_TRIANGULATION_H_
