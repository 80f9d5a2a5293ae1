// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_BOUNDARY_SIMPLIFICATION_H_
#define POSESPACE_MAPPING_BOUNDARY_SIMPLIFICATION_H_

#include <numbers>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/progress.h"
#include "geometry/result.h"

namespace posespace {

struct SimplificationOptions {
  // Farthest that a simplified outline may lie from its original, / size of the drawing.
  double tolerance = 0.03;
  // New corners are not made sharper than this unless the original was, radians.
  double min_corner_angle = std::numbers::pi / 9.0;
};

struct SimplifiedOutlines {
  std::vector<Points> outlines;    // N of m x 2: row k is the same place in every drawing
  std::vector<int> landmark_rows;  // where the landmarks went; landmarks are never moved
};

// Drops outline vertices in all drawings together, so that the mesh gets a sensible size.
//
// Every output ring is simple, positively oriented, contains its original ring, and stays within
// the tolerance of it; never fewer than 3 rows.  Decided by exact predicates.
//
// Requires  N >= 1 matched outlines (see boundary_matching.h) of n >= 3 rows each.
// Fails     kCancelled.
// Cost      O(N n log n + N n k), k = outline edges near a vertex.
// Follows   Baxter, Barla, Anjyo 2009, section 3.1, "Compatible simplification": greedy, the cost
// of
//           a step is that of the drawing in which it is worst.
Result<SimplifiedOutlines> SimplifyBoundaries(std::span<const Points> outlines,
                                              std::span<const int> landmark_rows,
                                              const SimplificationOptions& options = {},
                                              Progress* progress = nullptr);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_BOUNDARY_SIMPLIFICATION_H_
