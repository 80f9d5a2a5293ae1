// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_IMAGE_H_
#define POSESPACE_DRAWING_IMAGE_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/mesh.h"

namespace posespace {

// Pixels as files have them: sRGB, straight (not premultiplied) alpha, rows from the top.
struct Image {
  int width = 0;
  int height = 0;
  std::vector<std::uint8_t> rgba;  // width * height * 4

  const std::uint8_t* at(int x, int y) const {
    return rgba.data() + 4 * (static_cast<std::size_t>(y) * width + x);
  }
  std::uint8_t* at(int x, int y) {
    return rgba.data() + 4 * (static_cast<std::size_t>(y) * width + x);
  }
};

// The pixels of a drawing and where they lie in it: texel coordinates = (p - origin) * scale.
// For a picture origin is (0, 0) and scale 1; for a polygon without a picture the ring is painted.
struct Texture {
  Image image;
  Point origin = Point::Zero();
  double scale = 1.0;

  Point ToDrawing(const Point& texel) const { return origin + texel / scale; }
};

}  // namespace posespace

#endif  // POSESPACE_DRAWING_IMAGE_H_
