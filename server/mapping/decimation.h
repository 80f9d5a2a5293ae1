// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_DECIMATION_H_
#define POSESPACE_MAPPING_DECIMATION_H_

#include "geometry/progress.h"
#include "mapping/editable_mesh.h"

namespace posespace {

// Takes out an interior vertex if its link has a triangulation in common in all poses that uses no
// edge of the mesh; the best one fills it.  `sharpest`: no new triangle may be sharper (see
// triangle_quality.h).  Every triangle stays positive, by exact predicates.
bool RemoveVertex(EditableMesh& mesh, int vertex, double sharpest);

// Removes interior vertices that are no landmarks, with smoothing and flips in between, until no
// more can be removed.  Stops early when cancelled; the mesh is valid at any time.
void Decimate(EditableMesh& mesh, Progress* progress);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_DECIMATION_H_
