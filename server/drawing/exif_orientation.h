// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_EXIF_ORIENTATION_H_
#define POSESPACE_DRAWING_EXIF_ORIENTATION_H_

#include <cstdint>
#include <span>

#include "drawing/image.h"

namespace posespace {

// Which way up a camera held the picture, 1 to 8 as Exif 2.3 numbers them (tag 0x0112); 1, upright,
// when the metadata say nothing or make no sense.  `exif` begins with the TIFF header.
int ExifOrientation(std::span<const std::uint8_t> exif);

// The picture as it is meant to be seen.
Image Upright(Image image, int orientation);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_EXIF_ORIENTATION_H_
