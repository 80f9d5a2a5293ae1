// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_SOFT_EDGE_H_
#define POSESPACE_DRAWING_SOFT_EDGE_H_

#include <array>
#include <cstdint>
#include <opencv2/core.hpp>

#include "drawing/image.h"

namespace posespace {

using Rgb = std::array<std::uint8_t, 3>;

// A plain background to be taken out of an opaque picture.
struct Background {
  Rgb colour;
  cv::Mat1b distance;  // of each pixel's colour from it, 0 .. 255
  cv::Mat1b painted;   // 255: the drawing, 0: background
  int noise = 0;       // distances up to this are background that is not quite plain
};

// Makes the background transparent and leaves the edge smooth.
//
// An antialiased pixel at the edge is a mix of the background and of the drawing beside it.  The
// drawing beside it is found by climbing, at most 3 pixels and while the distance grows; the
// share of the two distances becomes alpha, and the background's colour is taken out of the mix, so
// that none of it is left on another background.  Pixels further than 3 inside the drawing, and
// those behind a pixel that is wholly the drawing's, stay opaque as they are.
void FadeBackground(const Background& background, Image* image);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_SOFT_EDGE_H_
