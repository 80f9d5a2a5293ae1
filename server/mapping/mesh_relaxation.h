// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_MESH_RELAXATION_H_
#define POSESPACE_MAPPING_MESH_RELAXATION_H_

#include <limits>

#include "geometry/progress.h"
#include "mapping/editable_mesh.h"

namespace posespace {

// What relaxation may not do while it lowers the mesh's energy, the sum over triangles and poses of
// a power of Distortion (triangle_quality.h).
struct RelaxationLimit {
  // A step may make angles smaller only as long as they stay wider than this: the largest
  // Sharpness that a step may create where there was none as large.
  double sharpest = std::numeric_limits<double>::infinity();
};

// Moves each interior vertex once, in each pose on its own, towards the minimum of the energy of
// its triangles, which is convex where they are positive.  Returns how many vertices moved.  Every
// triangle stays positive (exact).  Cost O(N V).
int SmoothVertices(EditableMesh& mesh, const RelaxationLimit& limit, Progress* progress);

// Flips interior edges while that lowers the energy over all poses.  Every triangle stays positive
// (exact).  Ends because each flip lowers the energy.  Returns how many flips were made.
int FlipEdges(EditableMesh& mesh, const RelaxationLimit& limit, Progress* progress);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_MESH_RELAXATION_H_
