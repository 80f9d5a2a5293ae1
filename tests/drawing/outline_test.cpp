// SPDX-License-Identifier: Apache-2.0
#include "drawing/outline.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "geometry/polygon.h"
#include "tests/support/fails_saying.h"
#include "tests/support/fails_with.h"
#include "tests/support/pictures.h"

namespace posespace {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

bool IsPainted(const Image& image, int x, int y, int threshold = 128) {
  return x >= 0 && y >= 0 && x < image.width && y < image.height && image.at(x, y)[3] >= threshold;
}

// The first painted pixel whose centre is not strictly inside the ring, or "".  Only pixels beside
// an unpainted one are asked: a simple ring around them is around the others.
std::string FirstNotEnclosed(const Image& image, const Points& ring, int threshold = 128) {
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (!IsPainted(image, x, y, threshold)) continue;
      if (IsPainted(image, x - 1, y, threshold) && IsPainted(image, x + 1, y, threshold) &&
          IsPainted(image, x, y - 1, threshold) && IsPainted(image, x, y + 1, threshold)) {
        continue;
      }
      if (Locate({x + 0.5, y + 0.5}, ring) != 1) {
        return std::to_string(x) + ", " + std::to_string(y);
      }
    }
  }
  return "";
}

void ExpectSound(const Outline& outline, const OutlineOptions& options = {}) {
  EXPECT_TRUE(IsSimple(outline.outer));
  EXPECT_GT(SignedArea(outline.outer), 0.0);
  EXPECT_LE(outline.outer.rows(), options.max_points);
  for (const Points& hole : outline.holes) {
    EXPECT_TRUE(IsSimple(hole));
    EXPECT_LT(SignedArea(hole), 0.0);
  }
  EXPECT_EQ(outline.holes.size(), static_cast<std::size_t>(outline.holes_filled));
  ASSERT_EQ(outline.colours.rows(), outline.outer.rows());
  EXPECT_GE(outline.colours.minCoeff(), 0.0);
  EXPECT_LE(outline.colours.maxCoeff(), 1.0);
}

// A connected figure with a body, limbs of one pixel, and a notch; painted up to the border.
Image Figure(int width, int height) {
  Image image = PictureOf(width, height);
  const double size = std::min(width, height);
  PaintDisc(&image, 0.5 * width, 0.5 * height, 0.3 * size, kRed);
  PaintBox(&image, width / 2, 0, 1, height, kBlue);
  PaintBox(&image, 0, height / 2, width, 1, kGreen);
  for (int k = 0; k < static_cast<int>(size / 2); ++k) {  // a diagonal that touches at corners
    PaintPixel(&image, width / 2 + k, height / 2 + k, kBlack);
  }
  PaintBox(&image, width / 2 + 2, height / 2 - height / 4, 1, height / 4, kClear);
  return image;
}

TEST(TraceOutline, EnclosesThePaintedPixelsOfDrawingsOfEverySize) {
  for (const auto& [width, height] :
       {std::pair(8, 8), std::pair(40, 40), std::pair(61, 143), std::pair(100, 90),
        std::pair(256, 256), std::pair(300, 255), std::pair(511, 512), std::pair(513, 300),
        std::pair(777, 1033), std::pair(2000, 1900)}) {
    SCOPED_TRACE(std::to_string(width) + " x " + std::to_string(height));
    const Image image = Figure(width, height);
    const auto outline = TraceOutline(image);
    ASSERT_TRUE(outline) << outline.error().message;
    ExpectSound(*outline);
    EXPECT_EQ(FirstNotEnclosed(image, outline->outer), "");
  }
}

TEST(TraceOutline, StaysCloseToThePaint) {
  for (const int size : {40, 200, 1000}) {
    Image image = PictureOf(size + 20, size + 20);
    PaintBox(&image, 10, 10, size, size, kBlack);
    const auto outline = TraceOutline(image);
    ASSERT_TRUE(outline) << outline.error().message;
    const double working_pixel = size / 512.0;
    EXPECT_GE(outline->outer.minCoeff(), 10 - 2.51 * working_pixel);
    EXPECT_LE(outline->outer.maxCoeff(), 10 + size + 2.51 * working_pixel);
  }
}

TEST(TraceOutline, TakesDrawingsThatAreAllHairline) {
  Image horizontal = PictureOf(3000, 9);
  PaintBox(&horizontal, 0, 4, 3000, 1, kBlack);
  Image diagonal = PictureOf(1500, 1500);
  for (int k = 0; k < 1500; ++k) PaintPixel(&diagonal, k, k, kBlack);
  for (const Image& image : {horizontal, diagonal}) {
    const auto outline = TraceOutline(image);
    ASSERT_TRUE(outline) << outline.error().message;
    ExpectSound(*outline);
    EXPECT_EQ(FirstNotEnclosed(image, outline->outer), "");
  }
}

TEST(TraceOutline, IsSimpleForNoise) {
  std::mt19937 random(11);
  for (const int size : {24, 130, 512, 700}) {
    for (const double density : {0.05, 0.4, 0.7}) {
      SCOPED_TRACE(std::to_string(size) + " at " + std::to_string(density));
      Image image = PictureOf(size, size);
      PaintBox(&image, size / 2 - 6, size / 2 - 6, 12, 12, kBlack);
      for (int y = 0; y < size; ++y) {
        for (int x = 0; x < size; ++x) {
          if (random() < density * 4294967296.0) PaintPixel(&image, x, y, kRed);
        }
      }
      const auto outline = TraceOutline(image);
      ASSERT_TRUE(outline) << outline.error().message;
      ExpectSound(*outline);
    }
  }
}

TEST(TraceOutline, IsSimpleForCombsWhoseTeethNearlyTouch) {
  for (const int gap : {1, 2, 3, 4, 5, 6, 7}) {
    Image image = PictureOf(512, 120);
    PaintBox(&image, 0, 0, 512, 20, kBlack);
    for (int x = 0; x < 512; x += 9 + gap) {
      for (int y = 20; y < 120; ++y) PaintBox(&image, x + y / 15, y, 9, 1, kBlack);
    }
    const auto outline = TraceOutline(image);
    ASSERT_TRUE(outline) << outline.error().message;
    ExpectSound(*outline);
    EXPECT_EQ(FirstNotEnclosed(image, outline->outer), "") << gap;
  }
}

TEST(TraceOutline, MovesWithTheDrawing) {
  const Image image = Figure(90, 70);
  Image moved = PictureOf(300, 200);
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      const std::uint8_t* p = image.at(x, y);
      PaintPixel(&moved, x + 64, y + 32, {p[0], p[1], p[2], p[3]});
    }
  }
  const auto here = TraceOutline(image), there = TraceOutline(moved);
  ASSERT_TRUE(here && there);
  ASSERT_EQ(here->outer.rows(), there->outer.rows());
  const Points back = there->outer.rowwise() - Eigen::RowVector2d(64, 32);
  EXPECT_LT((back - here->outer).cwiseAbs().maxCoeff(), 1e-10);
  EXPECT_EQ(here->colours, there->colours);
}

TEST(TraceOutline, GivesEqualOutputForEqualInput) {
  const Image image = Figure(333, 222);
  const auto once = TraceOutline(image), again = TraceOutline(image);
  ASSERT_TRUE(once && again);
  EXPECT_EQ(once->outer, again->outer);
  EXPECT_EQ(once->colours, again->colours);
}

TEST(TraceOutline, FailsWhenNothingIsPainted) {
  EXPECT_THAT(TraceOutline(Image()), FailsWith(ErrorCode::kOutlineEmpty));
  EXPECT_THAT(TraceOutline(PictureOf(30, 20)), FailsSaying(ErrorCode::kOutlineEmpty, "30 x 20"));
  EXPECT_THAT(TraceOutline(PictureOf(30, 20, {255, 255, 255, 127})),
              FailsSaying(ErrorCode::kOutlineEmpty, "128"));
}

TEST(TraceOutline, FailsBelowSixteenPaintedPixels) {
  EXPECT_THAT(TraceOutline(PictureOf({"#"})),
              FailsSaying(ErrorCode::kOutlineTooSmall, "1 painted pixel "));
  Image image = PictureOf(20, 20);
  PaintBox(&image, 5, 5, 5, 3, kBlack);
  EXPECT_THAT(TraceOutline(image), FailsSaying(ErrorCode::kOutlineTooSmall, "at least 16"));
  PaintPixel(&image, 5, 8, kBlack);
  const auto outline = TraceOutline(image);
  ASSERT_TRUE(outline) << outline.error().message;
  EXPECT_EQ(FirstNotEnclosed(image, outline->outer), "");
}

TEST(TraceOutline, FailsWhenPointsOrOptionsAreBeyondTheirLimits) {
  const Image image = Figure(90, 70);
  EXPECT_THAT(TraceOutline(image, {.max_points = 20}),
              FailsSaying(ErrorCode::kOutlineTooLong, "at most 20"));
  EXPECT_THAT(TraceOutline(image, {.threshold = 0}),
              FailsSaying(ErrorCode::kInvalidOption, "threshold"));
  EXPECT_THAT(TraceOutline(image, {.threshold = 256}), FailsWith(ErrorCode::kInvalidOption));
  EXPECT_THAT(TraceOutline(image, {.working_size = 1 << 20}),
              FailsSaying(ErrorCode::kInvalidOption, "working_size"));
}

TEST(TraceOutline, KeepsPaintedShadowsBelowTheThresholdOut) {
  for (const int zoom : {1, 4, 20}) {
    Image image = PictureOf(60 * zoom, 40 * zoom);
    PaintBox(&image, 0, 0, 30 * zoom, 40 * zoom, kRed);
    PaintBox(&image, 30 * zoom, 0, 30 * zoom, 40 * zoom, {0, 0, 0, 127});
    const auto without = TraceOutline(image);
    ASSERT_TRUE(without) << without.error().message;
    EXPECT_LT(without->outer.col(0).maxCoeff(), 30.5 * zoom);
    const auto with = TraceOutline(image, {.threshold = 127});
    ASSERT_TRUE(with) << with.error().message;
    EXPECT_GT(with->outer.col(0).maxCoeff(), 60.0 * zoom);
  }
}

TEST(TraceOutline, JoinsDetachedPartsAndSaysSo) {
  Image image = PictureOf(200, 200);
  PaintBox(&image, 60, 60, 80, 80, kRed);
  PaintDisc(&image, 100, 25, 15, kBlue);
  const auto one = TraceOutline(image);
  ASSERT_TRUE(one) << one.error().message;
  EXPECT_THAT(one->warnings,
              ElementsAre("1 detached part was joined to the body by a thin bridge"));

  PaintDisc(&image, 180, 180, 12, kGreen);
  const auto two = TraceOutline(image);
  ASSERT_TRUE(two) << two.error().message;
  ExpectSound(*two);
  EXPECT_EQ(FirstNotEnclosed(image, two->outer), "");
  EXPECT_THAT(two->warnings,
              ElementsAre("2 detached parts were joined to the body by thin bridges"));
  EXPECT_EQ(Locate({100, 50}, two->outer), 1);  // the bridge runs straight up
  EXPECT_EQ(Locate({90, 50}, two->outer), -1);
}

TEST(TraceOutline, LeavesSpecksOutAndSaysWhere) {
  Image image = PictureOf(300, 300);
  PaintBox(&image, 100, 100, 180, 180, kRed);
  PaintBox(&image, 12, 30, 5, 4, kBlue);
  const auto outline = TraceOutline(image);
  ASSERT_TRUE(outline) << outline.error().message;
  EXPECT_THAT(outline->warnings,
              ElementsAre("a detached part of 5 x 4 pixels at (12, 30) was left out"));
  EXPECT_EQ(Locate({14, 32}, outline->outer), -1);

  for (int k = 0; k < 6; ++k) PaintBox(&image, 20 * k, 60, 2, 2, kGreen);
  const auto many = TraceOutline(image);
  ASSERT_TRUE(many) << many.error().message;
  ASSERT_EQ(many->warnings.size(), 4u);
  EXPECT_THAT(many->warnings[0], HasSubstr("5 x 4 pixels at (12, 30)"));
  EXPECT_EQ(many->warnings[3], "4 more, smaller detached parts were left out");
}

TEST(TraceOutline, KeepsSpecksThatWideningReaches) {
  Image image = PictureOf(512, 512);
  PaintBox(&image, 0, 100, 512, 412, kRed);
  PaintBox(&image, 250, 97, 2, 2, kBlue);  // one pixel above the body
  const auto outline = TraceOutline(image);
  ASSERT_TRUE(outline) << outline.error().message;
  EXPECT_THAT(outline->warnings, IsEmpty());
  EXPECT_EQ(FirstNotEnclosed(image, outline->outer), "");
}

TEST(TraceOutline, FillsHolesAndKeepsTheirRings) {
  Image image = PictureOf(200, 200);
  PaintDisc(&image, 100, 100, 90, kRed);
  PaintDisc(&image, 70, 80, 15, kClear);
  PaintDisc(&image, 130, 80, 15, kClear);
  PaintPixel(&image, 100, 150, kClear);  // too small to mention
  const auto outline = TraceOutline(image);
  ASSERT_TRUE(outline) << outline.error().message;
  ExpectSound(*outline);
  EXPECT_EQ(outline->holes_filled, 2);
  EXPECT_THAT(outline->warnings, ElementsAre("2 holes were filled; their transparency is kept"));
  EXPECT_EQ(Locate({70, 80}, outline->outer), 1);
  EXPECT_EQ(Locate({70, 80}, outline->holes[0]), 1);
  EXPECT_EQ(Locate({130, 80}, outline->holes[1]), 1);
  EXPECT_NEAR(-SignedArea(outline->holes[0]), M_PI * 15 * 15, 40.0);
}

TEST(TraceOutline, TakesAPictureOfWhichOnlyTheBorderIsPainted) {
  Image image = PictureOf(64, 48, kBlack);
  PaintBox(&image, 1, 1, 62, 46, kClear);
  const auto outline = TraceOutline(image);
  ASSERT_TRUE(outline) << outline.error().message;
  ExpectSound(*outline);
  EXPECT_EQ(FirstNotEnclosed(image, outline->outer), "");
  EXPECT_EQ(outline->holes_filled, 1);
}

TEST(TraceOutline, TakesAnOpaquePictureAsItsRectangleAndSaysSo) {
  const auto outline = TraceOutline(PictureOf(64, 48, kWhite));
  ASSERT_TRUE(outline) << outline.error().message;
  ExpectSound(*outline);
  EXPECT_NEAR(SignedArea(outline->outer), 64 * 48, 0.03 * 64 * 48);
  ASSERT_EQ(outline->warnings.size(), 1u);
  EXPECT_THAT(outline->warnings[0], HasSubstr("every pixel is opaque"));
}

TEST(TraceOutline, SeesTheColourJustInsideEachRow) {
  for (const int zoom : {1, 5, 20}) {
    Image image = PictureOf(64 * zoom, 32 * zoom, {0, 255, 0, 0});
    PaintBox(&image, 2 * zoom, 2 * zoom, 30 * zoom, 28 * zoom, kRed);
    PaintBox(&image, 32 * zoom, 2 * zoom, 30 * zoom, 28 * zoom, kBlue);
    const auto outline = TraceOutline(image);
    ASSERT_TRUE(outline) << outline.error().message;
    ExpectSound(*outline);
    for (int k = 0; k < outline->outer.rows(); ++k) {
      const double x = outline->outer(k, 0) / zoom;
      const Eigen::RowVector3d colour = outline->colours.row(k);
      EXPECT_LT(colour[1], 1e-6);  // transparent green never bleeds
      if (x < 28) {
        EXPECT_GT(colour[0], 0.99) << x;
      } else if (x > 36) {
        EXPECT_GT(colour[2], 0.99) << x;
      }
    }
  }
}

TEST(TraceOutline, HasRowsAlongStraightEdgesForTheColoursBetween) {
  const auto outline = TraceOutline(PictureOf(512, 512, kRed));
  ASSERT_TRUE(outline) << outline.error().message;
  for (int k = 0; k < outline->outer.rows(); ++k) {
    const int next = (k + 1) % static_cast<int>(outline->outer.rows());
    EXPECT_LE((outline->outer.row(next) - outline->outer.row(k)).norm(), 16.0 + 1e-9);
  }
}

}  // namespace
}  // namespace posespace
