// SPDX-License-Identifier: Apache-2.0
#include "drawing/webp_file.h"

#include <webp/decode.h>

#include <string>

#include "drawing/picture_limits.h"

namespace posespace {
namespace {

constexpr std::size_t kRiffHeader = 8;

Error Undecodable(const std::string& what) {
  return {ErrorCode::kImageUndecodable, "the WebP file " + what, {}};
}

Error Failure(VP8StatusCode status) {
  switch (status) {
    case VP8_STATUS_NOT_ENOUGH_DATA:
    case VP8_STATUS_SUSPENDED:
      return Undecodable("is cut short");
    case VP8_STATUS_UNSUPPORTED_FEATURE:
      return Undecodable("uses a feature that libwebp does not know");
    case VP8_STATUS_OUT_OF_MEMORY:
      return {ErrorCode::kInternal, "libwebp ran out of memory", {}};
    default:
      return Undecodable("is damaged");
  }
}

// The length of the file by its own header.
std::uint64_t ClaimedSize(std::span<const std::uint8_t> bytes) {
  std::uint64_t size = 0;
  for (int k = 3; k >= 0; --k) size = size << 8 | bytes[4 + k];
  return size + kRiffHeader;
}

}  // namespace

Result<Image> ReadWebp(std::span<const std::uint8_t> bytes, std::int64_t max_pixels) {
  WebPDecoderConfig config;
  if (WebPInitDecoderConfig(&config) == 0) {
    return Error{ErrorCode::kInternal, "libwebp could not be started", {}};
  }
  const VP8StatusCode header = WebPGetFeatures(bytes.data(), bytes.size(), &config.input);
  if (header != VP8_STATUS_OK) return Failure(header);
  if (config.input.has_animation != 0) {
    return Undecodable("is an animation; send one of its frames as a picture");
  }
  TRY(CheckPixels(config.input.width, config.input.height, max_pixels));
  if (ClaimedSize(bytes) > bytes.size()) return Undecodable("is cut short");

  Image image = ImageOf(config.input.width, config.input.height);
  config.output.colorspace = MODE_RGBA;
  config.output.is_external_memory = 1;
  config.output.u.RGBA = {image.rgba.data(), 4 * image.width, image.rgba.size()};
  const VP8StatusCode decoded = WebPDecode(bytes.data(), bytes.size(), &config);
  WebPFreeDecBuffer(&config.output);
  if (decoded != VP8_STATUS_OK) return Failure(decoded);
  return image;
}

}  // namespace posespace
