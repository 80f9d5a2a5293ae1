// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_REACH_H_
#define POSESPACE_SESSION_REACH_H_

#include "geometry/mesh.h"
#include "geometry/progress.h"
#include "interpolation/rigid_blend.h"

namespace posespace {

struct Box {
  Point low, high;
};

// What the poses take up, and the blends halfway to their neighbours in pose space (`placements`,
// N x 2): turning parts reach beyond both.  Incomplete when cancelled.
Box ReachOf(const CompatibleMesh& mesh, const RigidBlend& blend, const Points& placements,
            const Progress* progress);

}  // namespace posespace

#endif  // POSESPACE_SESSION_REACH_H_
