// SPDX-License-Identifier: Apache-2.0
#include "drawing/edge_distance.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/pictures.h"

namespace posespace {
namespace {

double At(const std::vector<std::int16_t>& distance, const Image& image, int x, int y) {
  return static_cast<double>(distance[static_cast<std::size_t>(y) * image.width + x]) /
         kEdgeDistanceUnits;
}

TEST(EdgeDistance, IsTheSignedDistanceFromAStraightEdge) {
  Image image = PictureOf(60, 200);
  PaintBox(&image, 0, 0, 30, 200, kBlack);
  const auto distance = EdgeDistance(image);
  for (int x = 20; x < 60; ++x) {  // farther left, the picture's own border is nearer
    const double inside = 30.0 - (x + 0.5);
    EXPECT_NEAR(At(distance, image, x, 100), inside, 0.05) << x;
  }
}

TEST(EdgeDistance, IsTheSignedDistanceFromADiscToAPixel) {
  Image image = PictureOf(100, 100);
  PaintDisc(&image, 50, 50, 30, kBlack);
  const auto distance = EdgeDistance(image);
  for (int y = 0; y < 100; ++y) {
    for (int x = 0; x < 100; ++x) {
      const double radius = std::hypot(x + 0.5 - 50, y + 0.5 - 50);
      EXPECT_NEAR(At(distance, image, x, y), 30 - radius, 1.0) << x << ", " << y;
    }
  }
}

TEST(EdgeDistance, CountsAlphaFrom128AsPainted) {
  for (const int alpha : {127, 128}) {
    const Image image = PictureOf(9, 9, {0, 0, 0, static_cast<std::uint8_t>(alpha)});
    EXPECT_EQ(At(EdgeDistance(image), image, 4, 4) > 0.0, alpha == 128);
  }
}

TEST(EdgeDistance, TakesWhatIsBeyondThePictureAsNotPainted) {
  const Image image = PictureOf(40, 40, kBlack);
  const auto distance = EdgeDistance(image);
  EXPECT_NEAR(At(distance, image, 20, 0), 0.5, 0.3);
  EXPECT_NEAR(At(distance, image, 20, 10), 10.5, 0.05);
}

TEST(EdgeDistance, StopsAt511Pixels) {
  const Image empty = PictureOf(5, 3), wide = PictureOf(2000, 1400, kBlack);
  EXPECT_NEAR(At(EdgeDistance(empty), empty, 2, 1), -510.5, 0.6);
  EXPECT_NEAR(At(EdgeDistance(wide), wide, 1000, 700), 510.5, 0.6);
}

TEST(EdgeDistance, OfNoPictureIsEmpty) { EXPECT_TRUE(EdgeDistance(Image{}).empty()); }

}  // namespace
}  // namespace posespace
