// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_DECODE_H_
#define POSESPACE_DRAWING_DECODE_H_

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "drawing/image.h"
#include "geometry/result.h"

namespace posespace {

struct DecodeLimits {
  std::int64_t max_pixels = 32'000'000;  // read from the header, before any pixel is decoded
};

struct DecodedImage : Image {
  std::vector<std::string> warnings;  // what was done to the file's pixels, for a person to read
};

// Bytes of a picture file -> pixels.  The format is told by the first bytes:
//
//   PNG   of any colour type and depth
//   JPEG  baseline or progressive, 8 bits; grey, YCbCr, RGB, CMYK (converted without its profile);
//         turned as its EXIF orientation says; both are reported
//   WebP  lossy or lossless, with or without alpha; not animated
//
// Samples are taken as sRGB whatever profile the file carries, as game engines do.
// Hostile bytes are safe: they fail with kImageUndecodable (says what is wrong: another format and
// which, cut short, damaged) or kImageTooLarge (says size and limit), nothing else.
// Pure; call from any thread.
Result<DecodedImage> DecodeImage(std::span<const std::uint8_t> bytes,
                                 const DecodeLimits& limits = {});

}  // namespace posespace

#endif  // POSESPACE_DRAWING_DECODE_H_
