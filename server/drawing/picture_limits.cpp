// SPDX-License-Identifier: Apache-2.0
#include "drawing/picture_limits.h"

namespace posespace {

std::string SizeText(std::int64_t width, std::int64_t height) {
  return std::to_string(width) + " x " + std::to_string(height);
}

Result<void> CheckPixels(std::int64_t width, std::int64_t height, std::int64_t max_pixels) {
  if (width * height <= max_pixels) return {};
  return Error{ErrorCode::kImageTooLarge,
               "the picture has " + SizeText(width, height) + " pixels; at most " +
                   std::to_string(max_pixels) + " are accepted",
               {}};
}

Error CannotHold(const std::string& format, std::size_t bytes, std::int64_t width,
                 std::int64_t height) {
  return Error{ErrorCode::kImageUndecodable,
               "the " + format + " file is cut short: " + std::to_string(bytes) +
                   " bytes cannot hold " + SizeText(width, height) + " pixels",
               {}};
}

Image ImageOf(std::int64_t width, std::int64_t height) {
  Image image{static_cast<int>(width), static_cast<int>(height), {}};
  image.rgba.resize(4 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  return image;
}

}  // namespace posespace
