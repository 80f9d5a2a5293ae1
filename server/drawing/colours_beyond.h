// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_COLOURS_BEYOND_H_
#define POSESPACE_DRAWING_COLOURS_BEYOND_H_

#include <span>
#include <vector>

namespace posespace {

// An opaque RGBA for each of width x height premultiplied ones: its own colour where it is painted,
// continued smoothly to where it is not (paint_filling.h).
std::vector<float> ColoursBeyond(int width, int height, std::span<const float> premultiplied);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_COLOURS_BEYOND_H_
