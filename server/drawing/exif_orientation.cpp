// SPDX-License-Identifier: Apache-2.0
#include "drawing/exif_orientation.h"

#include <algorithm>
#include <cstddef>

#include "drawing/picture_limits.h"

namespace posespace {
namespace {

constexpr std::uint32_t kOrientationTag = 0x0112, kShortType = 3;

}  // namespace

int ExifOrientation(std::span<const std::uint8_t> exif) {
  if (exif.size() < 8 || exif[0] != exif[1] || (exif[0] != 'I' && exif[0] != 'M')) return 1;
  const bool little = exif[0] == 'I';
  // The number of `length` bytes at `at`; 0 beyond the end, which is no tag, count or orientation.
  const auto number = [&](std::size_t at, std::size_t length) {
    std::uint32_t value = 0;
    if (at > exif.size() || length > exif.size() - at) return value;
    for (std::size_t k = 0; k < length; ++k) {
      value = value << 8 | exif[at + (little ? length - 1 - k : k)];
    }
    return value;
  };
  const std::size_t directory = number(4, 4);
  const std::size_t entries = number(directory, 2);
  for (std::size_t k = 0; k < entries; ++k) {
    const std::size_t entry = directory + 2 + 12 * k;
    if (number(entry, 2) != kOrientationTag || number(entry + 2, 2) != kShortType) continue;
    const std::uint32_t orientation = number(entry + 8, 2);
    return orientation >= 1 && orientation <= 8 ? static_cast<int>(orientation) : 1;
  }
  return 1;
}

Image Upright(Image image, int orientation) {
  if (orientation <= 1 || orientation > 8) return image;
  // 5 to 8 have rows and columns exchanged; then the first row shown is the last stored one, ...
  const bool exchanged = orientation >= 5;
  const bool from_right =
      orientation == 2 || orientation == 3 || orientation == 7 || orientation == 8;
  const bool from_below =
      orientation == 3 || orientation == 4 || orientation == 6 || orientation == 7;
  Image upright =
      ImageOf(exchanged ? image.height : image.width, exchanged ? image.width : image.height);
  for (int y = 0; y < upright.height; ++y) {
    for (int x = 0; x < upright.width; ++x) {
      const int column = exchanged ? y : x, row = exchanged ? x : y;
      const std::uint8_t* pixel = image.at(from_right ? image.width - 1 - column : column,
                                           from_below ? image.height - 1 - row : row);
      std::copy(pixel, pixel + 4, upright.at(x, y));
    }
  }
  return upright;
}

}  // namespace posespace
