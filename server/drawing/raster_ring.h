// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_RASTER_RING_H_
#define POSESPACE_DRAWING_RASTER_RING_H_

#include <opencv2/core.hpp>

#include "geometry/mesh.h"

namespace posespace {

// Whether pixels that touch only at a corner belong together.
enum class Connectivity { kFour, kEight };

// The outer ring of the region that has `start`'s label, by marching squares: its vertices are the
// midpoints between the centre of a pixel of the region and that of a neighbour outside, so the
// ring passes strictly between centres and is simple for every region.  Positively oriented, in
// pixels of the raster (the centre of pixel (i, j) is (i + 0.5, j + 0.5)).
//
// Requires  the region is connected, `start` is its first pixel in reading order, and it does not
//           touch the border of the raster.
Points TraceRing(const cv::Mat1i& labels, cv::Point start, Connectivity connectivity);

// The ring with rows left out such that every row left out is within `tolerance` of the edge that
// replaces it (Douglas and Peucker 1973).  What lies further than `tolerance` from the ring stays
// on its side; the result may cross itself where the ring runs closer to itself than that.
Points SimplifyRing(const Points& ring, double tolerance);

// The ring with rows added so that no edge is longer than `length`.
Points DivideEdges(const Points& ring, double length);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_RASTER_RING_H_
