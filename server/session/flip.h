// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_FLIP_H_
#define POSESPACE_SESSION_FLIP_H_

#include <string>

#include "session/pose_space.h"
#include "session/upload.h"

namespace posespace {

// Drawings seen in a mirror, left and right exchanged: a picture about its middle, as if the file
// had been mirrored; rings without a picture about the middle of their box.  All functions are
// pure.

// The x of any point and that of its mirror image sum to this.  `drawing` is what was read from
// `source`, flipped or not.
double MirrorSum(const ShapeSource& source, const Drawing& drawing);

// The drawing's mirror image: its outline, colours, holes and texture; `flipped` and the digest
// tell it from the drawing. Requires  a drawing that is not flipped.
Drawing Flipped(Drawing drawing, double mirror_sum);

// The digest of the flipped drawing of a source with this digest.
std::string FlippedDigest(const std::string& digest);

}  // namespace posespace

#endif  // POSESPACE_SESSION_FLIP_H_
