// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_PIXEL_PLACEMENT_H_
#define POSESPACE_DRAWING_PIXEL_PLACEMENT_H_

#include <cstdio>
#include <string>

#include "geometry/mesh.h"

namespace posespace {

// Where a picture's pixels lie in the drawing, as Texture has it, and how that is said to a person:
// lengths and places in drawing pixels.
struct PixelPlacement {
  Point origin = Point::Zero();
  double scale = 1.0;

  Points ToDrawing(Points ring) const {
    ring /= scale;
    ring.rowwise() += origin.transpose();
    return ring;
  }
  std::string SizeText(int width, int height) const {
    return Text(width / scale) + " x " + Text(height / scale);
  }
  std::string PlaceText(int x, int y) const {
    return "(" + Text(origin.x() + x / scale) + ", " + Text(origin.y() + y / scale) + ")";
  }

 private:
  static std::string Text(double drawing_pixels) {
    char text[32];
    std::snprintf(text, sizeof(text), "%.5g", drawing_pixels);
    return text;
  }
};

}  // namespace posespace

#endif  // POSESPACE_DRAWING_PIXEL_PLACEMENT_H_
