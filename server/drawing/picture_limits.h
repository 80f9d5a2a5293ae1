// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_PICTURE_LIMITS_H_
#define POSESPACE_DRAWING_PICTURE_LIMITS_H_

#include <cstddef>
#include <cstdint>
#include <string>

#include "drawing/image.h"
#include "geometry/result.h"

// What the readers of all formats check after the header and before they take memory for pixels.

namespace posespace {

// "640 x 480"
std::string SizeText(std::int64_t width, std::int64_t height);

// Fails with kImageTooLarge: more pixels than the limit.
Result<void> CheckPixels(std::int64_t width, std::int64_t height, std::int64_t max_pixels);

// The refusal of a file too short for the pixels that its header claims.
Error CannotHold(const std::string& format, std::size_t bytes, std::int64_t width,
                 std::int64_t height);

// An image of this size, all zeros.
Image ImageOf(std::int64_t width, std::int64_t height);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_PICTURE_LIMITS_H_
