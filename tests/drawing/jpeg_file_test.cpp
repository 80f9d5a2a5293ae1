// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <jpeglib.h>

#include <cstddef>
#include <cstdlib>
#include <string>

#include "drawing/decode.h"
#include "tests/support/damage.h"
#include "tests/support/fails_saying.h"
#include "tests/support/fails_with.h"
#include "tests/support/pictures.h"

namespace posespace {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

struct JpegKind {
  J_COLOR_SPACE space = JCS_RGB;
  bool progressive = false;
  int restart_interval = 0;
  Bytes exif = {};
  bool adobe_marker = true;  // with CMYK
};

// A JPEG of the image at best quality; CMYK is written inverted, as Photoshop does.
Bytes WriteJpeg(const Image& image, const JpegKind& kind = {}) {
  jpeg_compress_struct jpeg;
  jpeg_error_mgr errors;
  jpeg.err = jpeg_std_error(&errors);
  jpeg_create_compress(&jpeg);
  unsigned char* buffer = nullptr;
  unsigned long size = 0;
  jpeg_mem_dest(&jpeg, &buffer, &size);
  jpeg.image_width = image.width;
  jpeg.image_height = image.height;
  const bool cmyk = kind.space == JCS_CMYK || kind.space == JCS_YCCK;
  jpeg.in_color_space = cmyk ? JCS_CMYK : kind.space == JCS_GRAYSCALE ? JCS_GRAYSCALE : JCS_RGB;
  jpeg.input_components = cmyk ? 4 : kind.space == JCS_GRAYSCALE ? 1 : 3;
  jpeg_set_defaults(&jpeg);
  jpeg_set_colorspace(&jpeg, kind.space == JCS_RGB ? JCS_YCbCr : kind.space);
  jpeg.write_Adobe_marker = cmyk && kind.adobe_marker ? TRUE : FALSE;
  jpeg_set_quality(&jpeg, 100, TRUE);
  for (int c = 0; c < jpeg.num_components; ++c) {
    jpeg.comp_info[c].h_samp_factor = jpeg.comp_info[c].v_samp_factor = 1;
  }
  jpeg.restart_interval = kind.restart_interval;
  if (kind.progressive) jpeg_simple_progression(&jpeg);
  jpeg_start_compress(&jpeg, TRUE);
  if (!kind.exif.empty()) {
    jpeg_write_marker(&jpeg, JPEG_APP0 + 1, kind.exif.data(), kind.exif.size());
  }
  Bytes row;
  for (int y = 0; y < image.height; ++y) {
    row.clear();
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* p = image.at(x, y);
      row.insert(row.end(), p, p + std::min(3, jpeg.input_components));
      if (cmyk) row.push_back(255);  // inverted: no black
    }
    JSAMPROW samples = row.data();
    jpeg_write_scanlines(&jpeg, &samples, 1);
  }
  jpeg_finish_compress(&jpeg);
  jpeg_destroy_compress(&jpeg);
  const Bytes bytes(buffer, buffer + size);
  std::free(buffer);
  return bytes;
}

// What an APP1 marker holds that says one orientation, in either byte order.
Bytes Exif(int orientation, bool little_endian) {
  Bytes exif = {'E', 'x', 'i', 'f', 0, 0};
  const auto add = [&](std::uint32_t value, int length) {
    for (int k = 0; k < length; ++k) {
      const int shift = 8 * (little_endian ? k : length - 1 - k);
      exif.push_back(static_cast<std::uint8_t>(value >> shift));
    }
  };
  add(little_endian ? 0x4949 : 0x4d4d, 2);
  add(42, 2);
  add(8, 4);
  add(2, 2);  // entries
  add(0x010f, 2), add(2, 2), add(1, 4), add(0, 4);
  add(0x0112, 2), add(3, 2), add(1, 4), add(orientation, 2), add(0, 2);
  add(0, 4);
  return exif;
}

// Four plain quarters, each a multiple of 8 pixels, so that JPEG keeps them.
Image Quarters(Colour a, Colour b, Colour c, Colour d, int width = 32, int height = 16) {
  Image image = PictureOf(width, height, a);
  PaintBox(&image, width / 2, 0, width / 2, height / 2, b);
  PaintBox(&image, 0, height / 2, width / 2, height / 2, c);
  PaintBox(&image, width / 2, height / 2, width / 2, height / 2, d);
  return image;
}

// Which of the four a quarter shows: 'r', 'g', 'b', 'k'.
std::string ShownQuarters(const Image& image) {
  std::string shown;
  for (const auto& [u, v] : {std::pair(1, 1), std::pair(3, 1), std::pair(1, 3), std::pair(3, 3)}) {
    const std::uint8_t* p = image.at(image.width * u / 4, image.height * v / 4);
    shown += p[0] > 200 ? 'r' : p[1] > 200 ? 'g' : p[2] > 200 ? 'b' : 'k';
  }
  return shown;
}

int Difference(const Image& a, const Image& b) {
  int most = 0;
  for (std::size_t k = 0; k < a.rgba.size(); ++k) {
    most = std::max(most, std::abs(a.rgba[k] - b.rgba[k]));
  }
  return most;
}

TEST(ReadJpeg, ReadsBaselineAndProgressiveColour) {
  const Image drawn = Quarters(kRed, kGreen, kBlue, kBlack);
  for (const bool progressive : {false, true}) {
    const auto image = DecodeImage(WriteJpeg(drawn, {.progressive = progressive}));
    ASSERT_TRUE(image) << image.error().message;
    ASSERT_EQ(image->width, 32);
    ASSERT_EQ(image->height, 16);
    EXPECT_LE(Difference(*image, drawn), 3);
    EXPECT_THAT(image->warnings, IsEmpty());
  }
}

TEST(ReadJpeg, ReadsGrey) {
  Image drawn = PictureOf(24, 24, kWhite);
  PaintBox(&drawn, 8, 8, 8, 8, {90, 90, 90, 255});
  const auto image = DecodeImage(WriteJpeg(drawn, {.space = JCS_GRAYSCALE}));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_LE(Difference(*image, drawn), 3);
}

TEST(ReadJpeg, ConvertsCmykAndSaysSo) {
  const Image drawn = Quarters(kRed, kGreen, kBlue, kBlack);
  for (const J_COLOR_SPACE space : {JCS_CMYK, JCS_YCCK}) {
    const auto image = DecodeImage(WriteJpeg(drawn, {.space = space}));
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(ShownQuarters(*image), "rgbk");
    EXPECT_THAT(image->warnings, ElementsAre(HasSubstr("CMYK")));
  }
  // Without Adobe's marker large numbers are ink, and black ink covers all.
  const auto image = DecodeImage(WriteJpeg(drawn, {.space = JCS_CMYK, .adobe_marker = false}));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(ShownQuarters(*image), "kkkk");
}

TEST(ReadJpeg, TurnsThePictureAsItsExifOrientationSaysAndSaysSo) {
  const Image drawn = Quarters(kRed, kGreen, kBlue, kBlack);
  const char* shown[] = {"rgbk", "grkb", "kbgr", "bkrg", "rbgk", "brkg", "kgbr", "gkrb"};
  for (int orientation = 1; orientation <= 8; ++orientation) {
    for (const bool little_endian : {true, false}) {
      const auto image = DecodeImage(WriteJpeg(drawn, {.exif = Exif(orientation, little_endian)}));
      ASSERT_TRUE(image) << image.error().message;
      EXPECT_EQ(image->width, orientation < 5 ? 32 : 16) << orientation;
      EXPECT_EQ(ShownQuarters(*image), shown[orientation - 1]) << orientation;
      if (orientation == 1) {
        EXPECT_THAT(image->warnings, IsEmpty());
      } else {
        EXPECT_THAT(image->warnings, ElementsAre(HasSubstr("EXIF orientation")));
      }
    }
  }
}

TEST(ReadJpeg, TakesNonsenseInExifForUpright) {
  const Image drawn = Quarters(kRed, kGreen, kBlue, kBlack);
  Bytes far_directory = Exif(6, true), many_entries = Exif(6, true);
  far_directory[6 + 4] = far_directory[6 + 7] = 0xff;
  many_entries[6 + 8] = many_entries[6 + 9] = 0xff;
  many_entries[6 + 22] = 0;  // its orientation is another tag now
  for (const Bytes& exif : {Exif(0, true), Exif(9, false), far_directory, many_entries,
                            Bytes{'E', 'x', 'i', 'f', 0, 0, 'I', 'I'}}) {
    const auto image = DecodeImage(WriteJpeg(drawn, {.exif = exif}));
    ASSERT_TRUE(image) << image.error().message;
    EXPECT_EQ(ShownQuarters(*image), "rgbk");
  }
}

TEST(ReadJpeg, RefusesEveryTruncation) {
  const Image drawn = Quarters(kRed, kGreen, kBlue, kBlack, 64, 48);
  for (const JpegKind& kind :
       {JpegKind{}, JpegKind{.progressive = true}, JpegKind{.restart_interval = 2}}) {
    const Bytes whole = WriteJpeg(drawn, kind);
    ASSERT_TRUE(DecodeImage(whole));
    for (std::size_t length = 3; length < whole.size(); ++length) {
      const std::span<const std::uint8_t> prefix(whole.data(), length);
      EXPECT_THAT(DecodeImage(prefix),
                  FailsSaying(ErrorCode::kImageUndecodable, "JPEG file is cut short"))
          << length;
    }
  }
}

TEST(ReadJpeg, SaysThatAFileIsDamaged) {
  Bytes bytes = WriteJpeg(Quarters(kRed, kGreen, kBlue, kBlack, 64, 48));
  for (std::size_t k = 20; k + 1 < bytes.size(); ++k) {
    if (bytes[k] == 0xff && bytes[k + 1] == JPEG_APP0 - 0xe0 + 0xc4) bytes[k + 5] ^= 0xff;  // DHT
  }
  EXPECT_THAT(DecodeImage(bytes), FailsSaying(ErrorCode::kImageUndecodable, "damaged"));
}

TEST(ReadJpeg, ChecksTheSizeInTheHeaderBeforeDecoding) {
  Bytes bytes = WriteJpeg(PictureOf(40, 30, kRed));
  EXPECT_TRUE(DecodeImage(bytes, {.max_pixels = 1200}));
  EXPECT_THAT(DecodeImage(bytes, {.max_pixels = 1199}),
              FailsSaying(ErrorCode::kImageTooLarge, "40 x 30"));
  for (std::size_t k = 0; k + 8 < bytes.size(); ++k) {
    if (bytes[k] != 0xff || bytes[k + 1] != 0xc0) continue;  // the frame header
    bytes[k + 5] = 0x0f, bytes[k + 7] = 0x0f;                // 3870 x 3880
  }
  EXPECT_THAT(DecodeImage(bytes), FailsSaying(ErrorCode::kImageUndecodable, "cannot hold"));
}

TEST(ReadJpeg, RefusesScansWithoutEnd) {
  const Bytes whole = WriteJpeg(PictureOf(1000, 1000, kRed), {.progressive = true});
  std::size_t last_scan = 0;
  for (std::size_t k = 0; k + 1 < whole.size(); ++k) {
    if (whole[k] == 0xff && whole[k + 1] == 0xda) last_scan = k;
  }
  Bytes bytes(whole.begin(), whole.end() - 2);
  for (int k = 0; k < 2'000; ++k) {
    bytes.insert(bytes.end(), whole.begin() + static_cast<std::ptrdiff_t>(last_scan),
                 whole.end() - 2);
  }
  bytes.insert(bytes.end(), whole.end() - 2, whole.end());
  EXPECT_THAT(DecodeImage(bytes), FailsWith(ErrorCode::kImageUndecodable));
}

TEST(ReadJpeg, AnswersMutatedBytesWithAnErrorOrAnImage) {
  std::mt19937 random(11);
  const Image drawn = Quarters(kRed, kGreen, kBlue, kBlack, 64, 48);
  for (const JpegKind& kind :
       {JpegKind{}, JpegKind{.progressive = true}, JpegKind{.space = JCS_GRAYSCALE},
        JpegKind{.space = JCS_YCCK}, JpegKind{.exif = Exif(6, true)}}) {
    const Bytes whole = WriteJpeg(drawn, kind);
    for (int round = 0; round < 300; ++round) {
      ExpectAnImageOrARefusal(WithFlippedBits(whole, 1 + round % 8, &random));
    }
  }
}

}  // namespace
}  // namespace posespace
