// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_EDGE_DISTANCE_H_
#define POSESPACE_DRAWING_EDGE_DISTANCE_H_

#include <cstdint>
#include <vector>

#include "drawing/image.h"

namespace posespace {

// Fractions of a pixel in which EdgeDistance counts.
inline constexpr int kEdgeDistanceUnits = 64;

// For each pixel: how far its centre lies from the edge of the painting (alpha half), in 1/64 of a
// pixel, at most 511 pixels; positive inside, negative outside.  What lies beyond the picture is
// not painted.  Rounded at corners by about a pixel.  Cost: a few milliseconds a megapixel. Follows
// Felzenszwalb, Huttenlocher 2012 (exact distance transform), by OpenCV.
std::vector<std::int16_t> EdgeDistance(const Image& image);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_EDGE_DISTANCE_H_
