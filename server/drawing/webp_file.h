// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_WEBP_FILE_H_
#define POSESPACE_DRAWING_WEBP_FILE_H_

#include <cstdint>
#include <span>

#include "drawing/image.h"
#include "geometry/result.h"

namespace posespace {

// The pixels of a WebP file, lossy or lossless; fails as DecodeImage does, also when it is
// animated.
Result<Image> ReadWebp(std::span<const std::uint8_t> bytes, std::int64_t max_pixels);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_WEBP_FILE_H_
