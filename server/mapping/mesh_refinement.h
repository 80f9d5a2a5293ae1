// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_MESH_REFINEMENT_H_
#define POSESPACE_MAPPING_MESH_REFINEMENT_H_

#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/progress.h"
#include "mapping/editable_mesh.h"

namespace posespace {

// Per pose, `relative` / size of the drawing in drawing units.
std::vector<double> TargetLengths(const CompatibleMesh& mesh, double relative);

// Splits edges, longest first, until each is shorter than 1.4 targets in all poses or the mesh has
// `max_vertices`.  The length of an edge is max over poses of length / target.  Edges whose split
// would leave a triangle that is not positive stay whole.  Returns the number of splits.
int SplitLongEdges(EditableMesh& mesh, std::span<const double> targets, int max_vertices,
                   Progress* progress);

// Removes interior vertices with an edge shorter than half its target in all poses, where the hole
// can be filled without a triangle sharper than `sharpest`.  Returns the number of vertices removed.
int CollapseShortEdges(EditableMesh& mesh, std::span<const double> targets, double sharpest,
                       Progress* progress);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_MESH_REFINEMENT_H_
