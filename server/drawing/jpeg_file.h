// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_JPEG_FILE_H_
#define POSESPACE_DRAWING_JPEG_FILE_H_

#include <cstdint>
#include <span>

#include "drawing/decode.h"
#include "geometry/result.h"

namespace posespace {

// The pixels of a JPEG file, turned upright by its EXIF orientation; fails as DecodeImage does.
Result<DecodedImage> ReadJpeg(std::span<const std::uint8_t> bytes, std::int64_t max_pixels);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_JPEG_FILE_H_
