// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_FRAME_COLOUR_H_
#define POSESPACE_DRAWING_FRAME_COLOUR_H_

#include <algorithm>
#include <cstdlib>
#include <string>

#include "drawing/image.h"
#include "drawing/soft_edge.h"

namespace posespace {

// Colours this close in each channel are one colour to the eye of a person who drew on paper.
constexpr int kSameColour = 30;  // 0.12 of 255

// The largest difference of two colours in a channel, 0 .. 255.
inline int ColourDistance(const std::uint8_t* a, const std::uint8_t* b) {
  return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
}

// Calls visit(x, y) for each pixel of the picture's frame, one pixel wide, once.
template <typename Visit>
void ForFrame(const Image& image, const Visit& visit) {
  for (int x = 0; x < image.width; ++x) {
    visit(x, 0);
    if (image.height > 1) visit(x, image.height - 1);
  }
  for (int y = 1; y + 1 < image.height; ++y) {
    visit(0, y);
    if (image.width > 1) visit(image.width - 1, y);
  }
}

// The colour that most of a picture's frame has.
struct FrameColour {
  Rgb colour{};
  double share = 0.0;  // of the frame that has it, within kSameColour
};
FrameColour FindFrameColour(const Image& image);

// "(255, 250, 245)"
std::string ColourText(const Rgb& colour);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_FRAME_COLOUR_H_
