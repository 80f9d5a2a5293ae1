// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_MAPPING_DECIMATION_H_
#define POSESPACE_MAPPING_DECIMATION_H_

#include "geometry/progress.h"
#include "mapping/editable_mesh.h"

namespace posespace {

// Removes and merges interior vertices that are no landmarks, with flips and smoothing in between,
// until nothing more goes.  It makes no sliver (triangle_quality.h) where there was none.  Stops
// early when cancelled; the mesh is valid at any time.
void Decimate(EditableMesh& mesh, Progress* progress);

}  // namespace posespace

#endif  // POSESPACE_MAPPING_DECIMATION_H_
