// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_OVERLAY_TRIANGULATION_H_
#define POSESPACE_MAPPING_OVERLAY_TRIANGULATION_H_

#include <cstdint>
#include <span>

#include "geometry/mesh.h"
#include "geometry/progress.h"
#include "geometry/result.h"

namespace posespace {

struct Overlay {
  CompatibleMesh mesh;
  int draws = 1;  // of the K-gon; the last one's mesh is valid
};

// Triangulates any N simple outlines of K rows compatibly, with as many Steiner vertices as it
// takes.
//
// Each outline gets a triangulation of its own, chosen to share chords with the others'.  Drawn in
// one convex K-gon, the chords of all of them cut it into convex faces, and each face lies in one
// triangle of each outline's triangulation; so the faces exist in every outline too.  Rows [0, K)
// of each pose are its outline; the crossings of chords follow.  Which chords cross, and in which
// order, is decided in exact integers.  In an outline, the crossings on one of its own chords are
// spread evenly over it, and the others are placed by Tutte's embedding in the triangle that holds
// them: valid for any crossings, and far better conditioned than positions carried over from the
// K-gon; they are solved for in that triangle's barycentric coordinates, so that thin triangles
// lose nothing.  The mesh is verified with exact predicates; when rounding has spoiled a triangle,
// the K-gon is drawn again with other angles.
//
// Requires  N >= 1 simple, positively oriented outlines of K >= 3 rows each.
// Fails     kMeshTooLarge, kCancelled, kInternal (after 20 draws: an outline has features so thin
//           that no vertices fit between their doubles).
// Cost      O(N K^3), and O(X log X) for X <= C(N, 2) (K - 3)^2 crossings.
// Follows   Aronov, Seidel, Souvaine 1993, for N polygons in one convex polygon.
Result<Overlay> TriangulateByOverlay(std::span<const Points> outlines, std::int64_t max_vertices,
                                     std::uint64_t seed, Progress* progress);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_OVERLAY_TRIANGULATION_H_
