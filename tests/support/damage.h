// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_SUPPORT_DAMAGE_H_
#define POSESPACE_TESTS_SUPPORT_DAMAGE_H_

#include <gtest/gtest.h>

#include <cstdint>
#include <random>
#include <vector>

#include "drawing/decode.h"

namespace posespace {

// A copy with a few bits turned over.
inline std::vector<std::uint8_t> WithFlippedBits(std::vector<std::uint8_t> bytes, int flips,
                                                 std::mt19937* random) {
  for (int k = 0; k < flips; ++k) {
    bytes[(*random)() % bytes.size()] ^= static_cast<std::uint8_t>(1u << ((*random)() % 8));
  }
  return bytes;
}

// Whatever the bytes are, they are answered with an image or with one of the two refusals.
inline void ExpectAnImageOrARefusal(const std::vector<std::uint8_t>& bytes) {
  const auto image = DecodeImage(bytes, {.max_pixels = 1'000'000});
  if (image) {
    EXPECT_EQ(image->rgba.size(), 4u * image->width * image->height);
  } else {
    EXPECT_TRUE(image.error().code == ErrorCode::kImageUndecodable ||
                image.error().code == ErrorCode::kImageTooLarge)
        << image.error().message;
  }
}

}  // namespace posespace

#endif  // POSESPACE_TESTS_SUPPORT_DAMAGE_H_
