// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_SUPPORT_PICTURES_H_
#define POSESPACE_TESTS_SUPPORT_PICTURES_H_

#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "drawing/image.h"

namespace posespace {

using Colour = std::array<std::uint8_t, 4>;
inline constexpr Colour kRed = {255, 0, 0, 255}, kGreen = {0, 255, 0, 255},
                        kBlue = {0, 0, 255, 255}, kWhite = {255, 255, 255, 255},
                        kBlack = {0, 0, 0, 255}, kClear = {0, 0, 0, 0};

inline Image PictureOf(int width, int height, Colour colour = kClear) {
  Image image{width, height, {}};
  image.rgba.resize(4 * static_cast<std::size_t>(width) * height);
  for (std::size_t k = 0; k < image.rgba.size(); ++k) image.rgba[k] = colour[k % 4];
  return image;
}

inline void PaintPixel(Image* image, int x, int y, Colour colour) {
  if (x < 0 || y < 0 || x >= image->width || y >= image->height) return;
  std::copy(colour.begin(), colour.end(), image->at(x, y));
}

inline void PaintBox(Image* image, int left, int top, int width, int height, Colour colour) {
  for (int y = top; y < top + height; ++y) {
    for (int x = left; x < left + width; ++x) PaintPixel(image, x, y, colour);
  }
}

// Each pixel whose centre lies within the disc.
inline void PaintDisc(Image* image, double centre_x, double centre_y, double radius,
                      Colour colour) {
  for (int y = 0; y < image->height; ++y) {
    for (int x = 0; x < image->width; ++x) {
      const double dx = x + 0.5 - centre_x, dy = y + 0.5 - centre_y;
      if (dx * dx + dy * dy <= radius * radius) PaintPixel(image, x, y, colour);
    }
  }
}

// A picture from rows of text: '#' is black, '.' is clear.
inline Image PictureOf(const std::vector<std::string>& rows) {
  Image image = PictureOf(static_cast<int>(rows[0].size()), static_cast<int>(rows.size()));
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (rows[y][x] == '#') PaintPixel(&image, x, y, kBlack);
    }
  }
  return image;
}

}  // namespace posespace

#endif  // POSESPACE_TESTS_SUPPORT_PICTURES_H_
