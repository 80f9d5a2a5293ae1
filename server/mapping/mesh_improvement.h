// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_MESH_IMPROVEMENT_H_
#define POSESPACE_MAPPING_MESH_IMPROVEMENT_H_

#include "geometry/mesh.h"
#include "geometry/progress.h"
#include "geometry/result.h"

namespace posespace {

struct ImprovementOptions {
  double target_edge_length = 0.08;  // / size of each drawing
  int max_vertices = 8000;           // refinement stops here; the mesh stays valid
};

// Makes a compatible mesh finer and its triangles rounder, in all drawings at once.
//
// Vertices move (smoothing), edges flip, long edges split, short interior edges collapse.  Every
// triangle stays positive in every pose at every step, by an exact predicate; the smallest angle of
// the mesh never falls, but for the rounding of split points (1e-9 of it).  Boundary vertices and
// landmarks stay where they are; a split boundary edge gets a vertex on itself.  Equal input gives
// equal output.
//
// Requires  a valid mesh (FindDefect(mesh) is empty).
// Fails     kCancelled.
// Cost      about O(N V) a sweep, a few tens of sweeps.
// Follows   Baxter, Barla, Anjyo 2009, section 3.1, last paragraph; Surazhsky, Gotsman 2004.
Result<CompatibleMesh> ImproveMesh(CompatibleMesh mesh, const ImprovementOptions& options = {},
                                   Progress* progress = nullptr);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_MESH_IMPROVEMENT_H_
