// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_GROUP_ALIGNMENT_H_
#define POSESPACE_DRAWING_GROUP_ALIGNMENT_H_

#include <opencv2/core.hpp>
#include <vector>

#include "drawing/comparison.h"
#include "geometry/progress.h"
#include "geometry/result.h"

namespace posespace {

// Drawings that show the same (kin.h), and how they come to correspond.
struct AlignmentGroup {
  std::vector<int> members;          // the first one is what the others are brought to
  std::vector<cv::Mat3f> unaligned;  // by member: filled, on the raster of the comparison
  cv::Mat1b painted;                 // in all members: what lies beside another is no ghost inside
  std::vector<Moving> moving;        // by member; out
  std::vector<cv::Mat3f> pictures;   // by member, where `moving` has them; out
};

// Moves the members' vertices, in rounds: each along the field that brings it to the first one,
// less the mean of all fields, so that none is bent alone.  After each round a vertex goes back as
// far as the colours around it came no closer to the others'.  A member keeps its old vertices
// where moving them does not lower the group's ghost loss; all do when that falls by less than a
// twentieth.  One drawing stays where it is.
//
// Requires  members, unaligned and painted.
// Fails     kCancelled.
Result<void> AlignGroup(const Comparison& comparison, AlignmentGroup* group, Progress* progress);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_GROUP_ALIGNMENT_H_
