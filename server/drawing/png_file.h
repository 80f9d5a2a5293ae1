// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_PNG_FILE_H_
#define POSESPACE_DRAWING_PNG_FILE_H_

#include <cstdint>
#include <span>
#include <vector>

#include "drawing/image.h"
#include "geometry/result.h"

namespace posespace {

// The pixels of a PNG file of any colour type and depth; fails as DecodeImage does.
Result<Image> ReadPng(std::span<const std::uint8_t> bytes, std::int64_t max_pixels);

// Pixels -> the bytes of a PNG file; none for an image without pixels.
std::vector<std::uint8_t> EncodePng(const Image& image);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_PNG_FILE_H_
