// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_DECODE_H_
#define POSESPACE_DRAWING_DECODE_H_

#include <cstdint>
#include <span>
#include <vector>

#include "drawing/image.h"
#include "geometry/result.h"

namespace posespace {

struct DecodeLimits {
  std::int64_t max_pixels = 32'000'000;  // read from the header, before any pixel is decoded
};

// Bytes of a picture file -> pixels.  PNG of any colour type and depth.
// Hostile bytes are safe: they fail with kImageUndecodable (says what is wrong: not a PNG, cut
// short, bad checksum) or kImageTooLarge (says size and limit), nothing else.
// Pure; call from any thread.
Result<Image> DecodeImage(std::span<const std::uint8_t> bytes, const DecodeLimits& limits = {});

// Pixels -> the bytes of a PNG file; none for an image without pixels.
std::vector<std::uint8_t> EncodePng(const Image& image);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_DECODE_H_
