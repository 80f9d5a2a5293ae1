// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_INTERIOR_STAGE_H_
#define POSESPACE_SESSION_INTERIOR_STAGE_H_

#include <memory>
#include <span>

#include "geometry/progress.h"
#include "geometry/result.h"
#include "session/pose_space.h"

namespace posespace {

// Moves the inner vertices of a mapping's mesh so that what is drawn there corresponds
// (drawing/alignment.h), compared in the blend of all drawings with equal weights; adds the stage,
// the ghost losses and the new smallest angle to its report.  Drawings in one colour are only
// looked at.
//
// Requires  a mapping of these drawings.
// Fails     kCancelled, and as RigidBlend::Prepare does.
Result<void> AlignMapping(std::span<const std::shared_ptr<const Drawing>> drawings,
                          Mapping* mapping, Progress* progress);

}  // namespace posespace

#endif  // POSESPACE_SESSION_INTERIOR_STAGE_H_
