// SPDX-License-Identifier: Apache-2.0
#include "drawing/decode.h"

#include <algorithm>
#include <string_view>
#include <utility>

#include "drawing/jpeg_file.h"
#include "drawing/png_file.h"
#include "drawing/webp_file.h"

namespace posespace {
namespace {

using namespace std::string_view_literals;

// How a file begins; '?' stands for any byte.
struct Beginning {
  std::string_view bytes;
  const char* name;
};

constexpr std::string_view kPng = "\x89PNG\r\n\x1a\n"sv;
constexpr std::string_view kJpeg = "\xff\xd8\xff"sv;
constexpr std::string_view kWebp = "RIFF????WEBP"sv;

// What people send by mistake, to tell them what they sent.
constexpr Beginning kOthers[] = {
    {"GIF8"sv, "a GIF file"},
    {"BM"sv, "a BMP file"},
    {"II*\0"sv, "a TIFF file"},
    {"MM\0*"sv, "a TIFF file"},
    {"8BPS"sv, "a Photoshop file"},
    {"gimp xcf"sv, "a GIMP file"},
    {"????ftypavif"sv, "an AVIF file"},
    {"????ftyp"sv, "a HEIF or MP4 file"},
    {"\0\0\0\x0cJXL "sv, "a JPEG XL file"},
    {"\xff\x0a"sv, "a JPEG XL file"},
    {"\0\0\1\0"sv, "an icon file"},
    {"qoif"sv, "a QOI file"},
    {"%PDF"sv, "a PDF file"},
    {"\x1f\x8b"sv, "gzip: an .svgz drawing goes in svg"},
    {"<"sv, "an SVG or other XML document: an SVG drawing goes in svg"},
    {"\xef\xbb\xbf<"sv, "an SVG or other XML document: an SVG drawing goes in svg"},
};

bool BeginsWith(std::span<const std::uint8_t> bytes, std::string_view beginning) {
  if (bytes.size() < beginning.size()) return false;
  for (std::size_t k = 0; k < beginning.size(); ++k) {
    if (beginning[k] != '?' && bytes[k] != static_cast<std::uint8_t>(beginning[k])) return false;
  }
  return true;
}

Error NotAPicture(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return {ErrorCode::kImageUndecodable, "the picture is empty", {}};
  const auto* other = std::find_if(std::begin(kOthers), std::end(kOthers), [&](const auto& known) {
    return BeginsWith(bytes, known.bytes);
  });
  const bool is_known = other != std::end(kOthers);
  return {ErrorCode::kImageUndecodable,
          (is_known ? "this looks like " + std::string(other->name)
                    : "this is not a picture file that is known here") +
              "; accepted are PNG, JPEG and WebP",
          {}};
}

}  // namespace

Result<DecodedImage> DecodeImage(std::span<const std::uint8_t> bytes, const DecodeLimits& limits) {
  if (BeginsWith(bytes, kPng)) return DecodedImage{TRY(ReadPng(bytes, limits.max_pixels)), {}};
  if (BeginsWith(bytes, kJpeg)) return ReadJpeg(bytes, limits.max_pixels);
  if (BeginsWith(bytes, kWebp)) return DecodedImage{TRY(ReadWebp(bytes, limits.max_pixels)), {}};
  return NotAPicture(bytes);
}

}  // namespace posespace
