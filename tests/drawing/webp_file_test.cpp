// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <webp/encode.h>

#include "drawing/decode.h"
#include "tests/support/damage.h"
#include "tests/support/fails_saying.h"
#include "tests/support/fails_with.h"
#include "tests/support/pictures.h"

namespace posespace {
namespace {

using Bytes = std::vector<std::uint8_t>;

Image SoftDisc(int size) {
  Image image = PictureOf(size, size);
  PaintDisc(&image, 0.5 * size, 0.5 * size, 0.4 * size, kRed);
  PaintDisc(&image, 0.5 * size, 0.4 * size, 0.2 * size, {20, 200, 60, 130});
  return image;
}

Bytes WriteWebp(const Image& image, bool lossless) {
  std::uint8_t* file = nullptr;
  const std::size_t size = lossless ? WebPEncodeLosslessRGBA(image.rgba.data(), image.width,
                                                             image.height, 4 * image.width, &file)
                                    : WebPEncodeRGBA(image.rgba.data(), image.width, image.height,
                                                     4 * image.width, 95, &file);
  const Bytes bytes(file, file + size);
  WebPFree(file);
  return bytes;
}

TEST(ReadWebp, ReadsLosslessPixelByPixel) {
  const Image drawn = SoftDisc(61);
  const auto image = DecodeImage(WriteWebp(drawn, true));
  ASSERT_TRUE(image) << image.error().message;
  ASSERT_EQ(image->width, 61);
  for (std::size_t k = 0; k < drawn.rgba.size(); k += 4) {
    ASSERT_EQ(image->rgba[k + 3], drawn.rgba[k + 3]);
    if (drawn.rgba[k + 3] == 0) continue;  // its colour is free
    ASSERT_EQ(image->rgba[k], drawn.rgba[k]);
  }
}

TEST(ReadWebp, ReadsLossyColourWithItsAlpha) {
  const auto image = DecodeImage(WriteWebp(SoftDisc(64), false));
  ASSERT_TRUE(image) << image.error().message;
  EXPECT_EQ(image->at(0, 0)[3], 0);
  EXPECT_EQ(image->at(32, 50)[3], 255);
  EXPECT_GT(image->at(32, 50)[0], 230);
  EXPECT_EQ(image->at(32, 26)[3], 130);
}

TEST(ReadWebp, RefusesEveryTruncation) {
  for (const bool lossless : {false, true}) {
    const Bytes whole = WriteWebp(SoftDisc(48), lossless);
    ASSERT_TRUE(DecodeImage(whole));
    for (std::size_t length = 12; length < whole.size(); ++length) {
      const std::span<const std::uint8_t> prefix(whole.data(), length);
      EXPECT_THAT(DecodeImage(prefix),
                  FailsSaying(ErrorCode::kImageUndecodable, "WebP file is cut short"))
          << length;
    }
  }
}

TEST(ReadWebp, ChecksTheSizeInTheHeaderBeforeDecoding) {
  const Bytes bytes = WriteWebp(SoftDisc(48), true);
  EXPECT_TRUE(DecodeImage(bytes, {.max_pixels = 48 * 48}));
  EXPECT_THAT(DecodeImage(bytes, {.max_pixels = 48 * 48 - 1}),
              FailsSaying(ErrorCode::kImageTooLarge, "48 x 48"));
}

TEST(ReadWebp, RefusesAnAnimation) {
  // An extended header that says animation, and one frame of it.
  const Bytes frame = WriteWebp(SoftDisc(16), true);
  Bytes bytes = {'R', 'I', 'F', 'F', 0, 0,    0, 0, 'W', 'E', 'B', 'P', 'V', 'P', '8',
                 'X', 10,  0,   0,   0, 0x12, 0, 0, 0,   15,  0,   0,   15,  0,   0};
  const Bytes animation = {'A', 'N', 'I', 'M', 6,   0,  0, 0, 0,   0, 0, 0, 0,
                           0,   'A', 'N', 'M', 'F', 0,  0, 0, 0,   0, 0, 0, 0,
                           0,   0,   15,  0,   0,   15, 0, 0, 100, 0, 0, 0};
  bytes.insert(bytes.end(), animation.begin(), animation.end());
  const std::size_t payload = frame.size() - 12;
  bytes[bytes.size() - 20] = static_cast<std::uint8_t>((payload + 16) & 255);
  bytes[bytes.size() - 19] = static_cast<std::uint8_t>((payload + 16) >> 8);
  bytes.insert(bytes.end(), frame.begin() + 12, frame.end());
  const std::size_t riff = bytes.size() - 8;
  bytes[4] = static_cast<std::uint8_t>(riff & 255);
  bytes[5] = static_cast<std::uint8_t>(riff >> 8);
  EXPECT_THAT(DecodeImage(bytes), FailsSaying(ErrorCode::kImageUndecodable, "animation"));
}

TEST(ReadWebp, AnswersMutatedBytesWithAnErrorOrAnImage) {
  std::mt19937 random(13);
  for (const bool lossless : {false, true}) {
    const Bytes whole = WriteWebp(SoftDisc(48), lossless);
    for (int round = 0; round < 500; ++round) {
      ExpectAnImageOrARefusal(WithFlippedBits(whole, 1 + round % 8, &random));
    }
  }
}

}  // namespace
}  // namespace posespace
