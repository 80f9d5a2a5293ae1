// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_GROUP_LINKING_H_
#define POSESPACE_DRAWING_GROUP_LINKING_H_

#include <vector>

#include "drawing/comparison.h"
#include "drawing/group_alignment.h"
#include "geometry/progress.h"
#include "geometry/result.h"

namespace posespace {

// Brings groups that were aligned by themselves to each other where they have something in common:
// belts of fronts and backs, eyes of two kinds of animal.  The first member of each group moves
// towards that of the first group and its kin follow it, as far as the details around a vertex
// come closer for it.  A group stays where that does not lower the ghost loss of all drawings; all
// do when that falls by less than a fiftieth.
//
// Requires  groups that AlignGroup moved, or single drawings; `painted` is where all are painted.
// Fails     kCancelled.
Result<void> LinkGroups(const Comparison& comparison, const cv::Mat1b& painted,
                        std::vector<AlignmentGroup>* groups, Progress* progress);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_GROUP_LINKING_H_
