// SPDX-License-Identifier: Apache-2.0
#include "drawing/decode.h"

#include <gtest/gtest.h>
#include <png.h>
#include <zlib.h>

#include <cmath>
#include <random>
#include <string>

#include "drawing/png_file.h"
#include "tests/support/fails_saying.h"
#include "tests/support/fails_with.h"
#include "tests/support/pictures.h"

namespace posespace {
namespace {

using Bytes = std::vector<std::uint8_t>;

struct PngKind {
  int colour_type;
  int bit_depth;
  bool interlaced;

  int channels() const {
    return colour_type == PNG_COLOR_TYPE_RGBA         ? 4
           : colour_type == PNG_COLOR_TYPE_RGB        ? 3
           : colour_type == PNG_COLOR_TYPE_GRAY_ALPHA ? 2
                                                      : 1;
  }
  int largest() const { return (1 << bit_depth) - 1; }
};

std::vector<PngKind> AllKinds() {
  std::vector<PngKind> kinds;
  for (const bool interlaced : {false, true}) {
    for (const int depth : {1, 2, 4, 8, 16}) {
      kinds.push_back({PNG_COLOR_TYPE_GRAY, depth, interlaced});
      if (depth <= 8) kinds.push_back({PNG_COLOR_TYPE_PALETTE, depth, interlaced});
      if (depth < 8) continue;
      kinds.push_back({PNG_COLOR_TYPE_GRAY_ALPHA, depth, interlaced});
      kinds.push_back({PNG_COLOR_TYPE_RGB, depth, interlaced});
      kinds.push_back({PNG_COLOR_TYPE_RGBA, depth, interlaced});
    }
  }
  return kinds;
}

// The sample of channel c at (x, y): something that uses the whole range.
int SampleAt(const PngKind& kind, int x, int y, int c) {
  return (x * 7919 + y * 104729 + c * 1299709 + 13) % (kind.largest() + 1);
}

png_color PaletteAt(int index) {
  return {static_cast<png_byte>(index * 37), static_cast<png_byte>(255 - index),
          static_cast<png_byte>(index * 91)};
}
png_byte PaletteAlphaAt(int index) { return static_cast<png_byte>(255 - index * 50); }
constexpr int kPaletteAlphas = 2;  // further entries are opaque, as tRNS may be short

// Writes a PNG whose samples are SampleAt, packed as its kind asks.
Bytes WritePng(const PngKind& kind, int width, int height) {
  const int bits = kind.channels() * kind.bit_depth;
  std::vector<Bytes> rows(height, Bytes((width * bits + 7) / 8, 0));
  std::vector<png_bytep> pointers;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      for (int c = 0; c < kind.channels(); ++c) {
        const int sample = SampleAt(kind, x, y, c);
        const int bit = x * bits + c * kind.bit_depth;
        if (kind.bit_depth == 16) {
          rows[y][bit / 8] = static_cast<std::uint8_t>(sample >> 8);
          rows[y][bit / 8 + 1] = static_cast<std::uint8_t>(sample & 255);
        } else {
          rows[y][bit / 8] |= static_cast<std::uint8_t>(sample << (8 - kind.bit_depth - bit % 8));
        }
      }
    }
    pointers.push_back(rows[y].data());
  }
  Bytes bytes;
  png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
  png_infop info = png_create_info_struct(png);
  png_set_write_fn(
      png, &bytes,
      [](png_structp writer, png_bytep data, std::size_t size) {
        auto* to = static_cast<Bytes*>(png_get_io_ptr(writer));
        to->insert(to->end(), data, data + size);
      },
      nullptr);
  png_set_IHDR(png, info, width, height, kind.bit_depth, kind.colour_type,
               kind.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE,
               PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
  std::vector<png_color> palette;
  Bytes alphas;
  if (kind.colour_type == PNG_COLOR_TYPE_PALETTE) {
    for (int k = 0; k <= kind.largest(); ++k) palette.push_back(PaletteAt(k));
    for (int k = 0; k < kPaletteAlphas; ++k) alphas.push_back(PaletteAlphaAt(k));
    png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
    png_set_tRNS(png, info, alphas.data(), kPaletteAlphas, nullptr);
  }
  png_set_rows(png, info, pointers.data());
  png_write_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
  png_destroy_write_struct(&png, &info);
  return bytes;
}

Colour ExpectedAt(const PngKind& kind, int x, int y) {
  const auto scaled = [&](int c) {
    return static_cast<std::uint8_t>(std::lround(255.0 * SampleAt(kind, x, y, c) / kind.largest()));
  };
  switch (kind.colour_type) {
    case PNG_COLOR_TYPE_PALETTE: {
      const int index = SampleAt(kind, x, y, 0);
      const png_color colour = PaletteAt(index);
      const png_byte alpha = index < kPaletteAlphas ? PaletteAlphaAt(index) : 255;
      return {colour.red, colour.green, colour.blue, alpha};
    }
    case PNG_COLOR_TYPE_GRAY:
      return {scaled(0), scaled(0), scaled(0), 255};
    case PNG_COLOR_TYPE_GRAY_ALPHA:
      return {scaled(0), scaled(0), scaled(0), scaled(1)};
    case PNG_COLOR_TYPE_RGB:
      return {scaled(0), scaled(1), scaled(2), 255};
    default:
      return {scaled(0), scaled(1), scaled(2), scaled(3)};
  }
}

Colour PixelOf(const Image& image, int x, int y) {
  const std::uint8_t* p = image.at(x, y);
  return {p[0], p[1], p[2], p[3]};
}

template <typename Range>
void Append(Bytes* bytes, const Range& more) {
  for (const auto value : more) bytes->push_back(static_cast<std::uint8_t>(value));
}

void Append32(Bytes* bytes, std::uint32_t value) {
  for (int shift = 24; shift >= 0; shift -= 8) {
    bytes->push_back(static_cast<std::uint8_t>(value >> shift));
  }
}

Bytes Chunk(const std::string& type, const Bytes& data) {
  Bytes chunk;
  Append32(&chunk, static_cast<std::uint32_t>(data.size()));
  Append(&chunk, type);
  Append(&chunk, data);
  Append32(&chunk, static_cast<std::uint32_t>(
                       crc32(0, chunk.data() + 4, static_cast<uInt>(chunk.size() - 4))));
  return chunk;
}

const Bytes kSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
constexpr std::size_t kHeaderEnd = 8 + 25;  // signature and IHDR

// A PNG that claims a size and then ends after one small IDAT.
Bytes PngClaiming(std::uint32_t width, std::uint32_t height) {
  Bytes header;
  Append32(&header, width);
  Append32(&header, height);
  Append(&header, Bytes{8, PNG_COLOR_TYPE_RGBA, 0, 0, 0});
  Bytes bytes = kSignature;
  for (const Bytes& chunk : {Chunk("IHDR", header),
                             Chunk("IDAT", {0x78, 0x9c, 0x03, 0, 0, 0, 0, 1}), Chunk("IEND", {})}) {
    Append(&bytes, chunk);
  }
  return bytes;
}

TEST(DecodeImage, ReadsEveryColourTypeDepthAndInterlace) {
  for (const PngKind& kind : AllKinds()) {
    for (const auto& [width, height] : {std::pair(13, 11), std::pair(1, 1)}) {
      SCOPED_TRACE("type " + std::to_string(kind.colour_type) + " depth " +
                   std::to_string(kind.bit_depth) + (kind.interlaced ? " interlaced" : ""));
      const auto image = DecodeImage(WritePng(kind, width, height));
      ASSERT_TRUE(image) << image.error().message;
      ASSERT_EQ(image->width, width);
      ASSERT_EQ(image->height, height);
      for (int y = 0; y < height; ++y) {
        for (int x = 0; x < width; ++x) {
          ASSERT_EQ(PixelOf(*image, x, y), ExpectedAt(kind, x, y)) << x << ", " << y;
        }
      }
    }
  }
}

TEST(DecodeImage, RefusesEveryTruncation) {
  for (const bool interlaced : {false, true}) {
    const Bytes whole = WritePng({PNG_COLOR_TYPE_RGBA, 8, interlaced}, 13, 11);
    ASSERT_TRUE(DecodeImage(whole));
    for (std::size_t length = 0; length < whole.size(); ++length) {
      const std::span<const std::uint8_t> prefix(whole.data(), length);
      EXPECT_THAT(DecodeImage(prefix), FailsWith(ErrorCode::kImageUndecodable)) << length;
    }
  }
}

TEST(DecodeImage, SaysWhetherTheFileIsForeignCutShortOrDamaged) {
  EXPECT_THAT(DecodeImage({}), FailsSaying(ErrorCode::kImageUndecodable, "empty"));

  Bytes bytes = WritePng({PNG_COLOR_TYPE_RGB, 8, false}, 13, 11);
  const std::span<const std::uint8_t> half(bytes.data(), bytes.size() / 2);
  EXPECT_THAT(DecodeImage(half), FailsSaying(ErrorCode::kImageUndecodable, "cut short"));
  bytes[kHeaderEnd + 12] ^= 1;  // in the first bytes of IDAT
  EXPECT_THAT(DecodeImage(bytes), FailsSaying(ErrorCode::kImageUndecodable, "damaged"));
}

TEST(DecodeImage, SaysWhatBytesThatAreNoPictureLookLikeAndWhatIsAccepted) {
  const std::pair<std::string, const char*> cases[] = {
      {"GIF89a", "GIF"},
      {"BM\x36", "BMP"},
      {std::string("II*\0", 4), "TIFF"},
      {"8BPS", "Photoshop"},
      {std::string("\0\0\0\x1c", 4) + "ftypavif", "AVIF"},
      {std::string("\0\0\0\x1c", 4) + "ftypheic", "HEIF"},
      {"%PDF-1.7", "PDF"},
      {"<svg xmlns=", "goes in svg"},
      {"\x1f\x8b\x08", "goes in svg"},
      {"hello", "not a picture file"},
      {std::string("RIFF\0\0\0\0WAVE", 12), "not a picture file"},
  };
  for (const auto& [text, said] : cases) {
    const auto image = DecodeImage(Bytes(text.begin(), text.end()));
    EXPECT_THAT(image, FailsSaying(ErrorCode::kImageUndecodable, said));
    EXPECT_THAT(image, FailsSaying(ErrorCode::kImageUndecodable, "PNG, JPEG and WebP"));
  }
}

TEST(DecodeImage, ChecksTheSizeInTheHeaderBeforeDecoding) {
  EXPECT_THAT(DecodeImage(PngClaiming(100'000, 100'000)),
              FailsSaying(ErrorCode::kImageTooLarge, "100000 x 100000"));
  EXPECT_THAT(DecodeImage(PngClaiming(2'147'483'647, 2'147'483'647)),
              FailsSaying(ErrorCode::kImageTooLarge, "at most 32000000"));
  EXPECT_THAT(DecodeImage(PngClaiming(0, 10)), FailsWith(ErrorCode::kImageUndecodable));
  EXPECT_THAT(DecodeImage(PngClaiming(0xffffffff, 10)), FailsWith(ErrorCode::kImageUndecodable));

  const Bytes png = WritePng({PNG_COLOR_TYPE_RGBA, 8, false}, 12, 10);
  EXPECT_TRUE(DecodeImage(png, {.max_pixels = 120}));
  EXPECT_THAT(DecodeImage(png, {.max_pixels = 119}), FailsSaying(ErrorCode::kImageTooLarge, "119"));
}

TEST(DecodeImage, TakesNoMemoryForPixelsTheFileCannotHold) {
  EXPECT_THAT(DecodeImage(PngClaiming(8000, 4000)),
              FailsSaying(ErrorCode::kImageUndecodable, "cannot hold"));
}

TEST(DecodeImage, ReadsAnImageThatCompressesAsWellAsDeflateCan) {
  const Image plain = PictureOf(4000, 2000, kRed);
  const auto decoded = DecodeImage(EncodePng(plain));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->rgba, plain.rgba);
}

TEST(DecodeImage, SkipsChunksItDoesNotNeed) {
  const PngKind kind{PNG_COLOR_TYPE_RGB, 8, false};
  const Bytes bytes = WritePng(kind, 13, 11);
  Bytes with_extra(bytes.begin(), bytes.begin() + kHeaderEnd);
  for (int k = 0; k < 3000; ++k) {  // more than libpng's own limit of chunks kept
    Append(&with_extra, Chunk("tEXt", {'a', 0, 'b'}));
  }
  for (const char* type : {"iCCP", "zTXt", "eXIf", "vpAg"}) {
    Append(&with_extra, Chunk(type, {'a', 0, 0, 'n', 'o', 't', 'h', 'i', 'n', 'g'}));
  }
  Append(&with_extra, Chunk("gAMA", {0, 1, 0x86, 0xa0}));  // 1.0: linear, if it were heeded
  Append(&with_extra, Bytes(bytes.begin() + kHeaderEnd, bytes.end()));
  const auto image = DecodeImage(with_extra);
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(PixelOf(*image, 5, 7), ExpectedAt(kind, 5, 7));
}

TEST(DecodeImage, AnswersRandomAndMutatedBytesWithAnErrorOrAnImage) {
  std::mt19937 random(7);
  const auto check = [](const Bytes& bytes) {
    const auto image = DecodeImage(bytes, {.max_pixels = 1'000'000});
    if (image) {
      EXPECT_EQ(image->rgba.size(), 4u * image->width * image->height);
    } else {
      EXPECT_TRUE(image.error().code == ErrorCode::kImageUndecodable ||
                  image.error().code == ErrorCode::kImageTooLarge);
    }
  };
  for (int round = 0; round < 500; ++round) {
    Bytes bytes = round % 2 ? kSignature : Bytes();
    for (int k = random() % 200; k > 0; --k) {
      bytes.push_back(static_cast<std::uint8_t>(random()));
    }
    check(bytes);
  }
  for (const PngKind& kind : AllKinds()) {
    const Bytes whole = WritePng(kind, 9, 9);
    for (int round = 0; round < 100; ++round) {
      Bytes bytes = whole;
      for (int k = 1 + random() % 4; k > 0; --k) {
        bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
      }
      check(bytes);
      // The same with a checksum that fits, so that the damage reaches the decoder.
      const std::uint32_t sum = static_cast<std::uint32_t>(crc32(0, bytes.data() + 12, 17));
      for (int k = 0; k < 4; ++k) {
        bytes[29 + k] = static_cast<std::uint8_t>(sum >> (24 - 8 * k));
      }
      check(bytes);
    }
  }
}

TEST(EncodePng, KeepsEveryPixelEvenTheColourOfTransparentOnes) {
  Image image = PictureOf(17, 9);
  for (std::size_t k = 0; k < image.rgba.size(); ++k) {
    image.rgba[k] = static_cast<std::uint8_t>(k * 31 % 256);
  }
  PaintPixel(&image, 3, 3, {10, 200, 30, 0});
  const auto decoded = DecodeImage(EncodePng(image));
  ASSERT_TRUE(decoded) << decoded.error().message;
  EXPECT_EQ(decoded->width, 17);
  EXPECT_EQ(decoded->height, 9);
  EXPECT_EQ(decoded->rgba, image.rgba);
}

TEST(EncodePng, GivesNoBytesForAnEmptyImage) { EXPECT_TRUE(EncodePng({}).empty()); }

}  // namespace
}  // namespace posespace
