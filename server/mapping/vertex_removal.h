// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_VERTEX_REMOVAL_H_
#define POSESPACE_MAPPING_VERTEX_REMOVAL_H_

#include "mapping/editable_mesh.h"

// Steps that take one vertex out of a mesh.  Every triangle stays positive in every pose (exact),
// and no new triangle is sharper (triangle_quality.h) than `sharpest`.  Each returns whether it was
// done.

namespace posespace {

// The largest Sharpness of the triangles at a vertex, over all poses.
double SharpnessAround(const EditableMesh& mesh, int vertex);

// Takes out an interior vertex if its link has a triangulation in common in all poses that uses no
// edge of the mesh; the one with the widest angles fills it.
bool RemoveVertex(EditableMesh& mesh, int vertex, double sharpest);

// Makes one vertex, u, of two neighbours, both interior and free to move, if in every pose some
// point sees the whole rim of their triangles; u moves into the middle of all such points.
bool MergeVertices(EditableMesh& mesh, int u, int v, double sharpest);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_VERTEX_REMOVAL_H_
