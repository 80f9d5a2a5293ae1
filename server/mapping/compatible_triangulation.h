// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_COMPATIBLE_TRIANGULATION_H_
#define POSESPACE_MAPPING_COMPATIBLE_TRIANGULATION_H_

#include <cstdint>
#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/progress.h"
#include "geometry/result.h"
#include "mapping/triangulation_levels.h"

namespace posespace {

struct TriangulationOptions {
  // More than this fails with kMeshTooLarge, and so does an overlay of 4 times it, or of 32,000.
  int max_vertices = 8000;
  std::uint64_t seed = 1;  // of the overlay's circle angles; any seed gives a valid mesh
};

struct Triangulation {
  CompatibleMesh mesh;
  LevelCounts levels;         // which level solved how many parts
  int before_decimation = 0;  // Steiner vertices before decimation
  int steiner_vertices = 0;   // Steiner vertices in the mesh
};

// Triangulates N outlines with one shared list of triangles.
//
// Row k of every outline is the same place (see boundary_matching.h).  Rows [0, K) of each output
// pose are its outline, in order and unmoved; Steiner vertices follow.  Every triangle is positive
// in every pose, decided by an exact predicate: no pose folds over.  It always ends with a valid
// mesh: first a dynamic programme that finds the triangulation without Steiner vertices whose
// smallest angle is largest, if there is one.  Otherwise the outlines are cut in parts that have
// one (cut_triangulation.h, the paper's stages), and each outline's own triangulation is laid over
// the others in a circle, which any N outlines allow (overlay_triangulation.h), beginning with each
// of them unless that takes many vertices.  All are decimated and the mesh of fewest Steiner
// vertices is taken, of equals that of the wider angles.
// Equal input gives equal output.
//
// Requires  N >= 1 simple outlines of K >= 3 rows each, positively oriented.
// Fails     kOutlineNotSimple (names drawing index and edges), kSizeMismatch, kMeshTooLarge,
//           kCancelled; kInternal where outlines that need a Steiner vertex leave no room for one
//           between neighbouring doubles, in which case a mesh in doubles need not exist.
// Cost      O(N K^3) without Steiner vertices; the overlay has at most C(N, 2) (K - 3)^2 crossings.
// Serves    Baxter, Barla, Anjyo 2009, section 3.1, "Compatible triangulation".
// Follows   Klincsek 1980 for the dynamic programme, Aronov, Seidel, Souvaine 1993 for the overlay.
Result<Triangulation> TriangulateCompatibly(std::span<const Points> outlines,
                                            std::span<const int> landmark_rows,
                                            const TriangulationOptions& options = {},
                                            Progress* progress = nullptr);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_COMPATIBLE_TRIANGULATION_H_
