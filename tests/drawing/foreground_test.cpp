// SPDX-License-Identifier: Apache-2.0
#include "drawing/foreground.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "drawing/outline.h"
#include "geometry/polygon.h"
#include "tests/support/fails_saying.h"
#include "tests/support/fails_with.h"
#include "tests/support/pictures.h"

namespace posespace {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double kRadius = 20.3;

// How much of a pixel a disc around the middle of a 64 x 64 picture covers.
double Coverage(int x, int y, double radius = kRadius) {
  int covered = 0;
  for (int k = 0; k < 256; ++k) {
    const double dx = x + (k % 16 + 0.5) / 16 - 32, dy = y + (k / 16 + 0.5) / 16 - 32;
    covered += dx * dx + dy * dy <= radius * radius ? 1 : 0;
  }
  return covered / 256.0;
}

Colour Mix(Colour a, Colour b, double share_of_b) {
  Colour mixed = {0, 0, 0, 255};
  for (int c = 0; c < 3; ++c) {
    mixed[c] = static_cast<std::uint8_t>(std::lround(a[c] + share_of_b * (b[c] - a[c])));
  }
  return mixed;
}

// An antialiased disc of one colour on a page of another.
Image DiscOn(Colour page, Colour ink) {
  Image image = PictureOf(64, 64);
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) PaintPixel(&image, x, y, Mix(page, ink, Coverage(x, y)));
  }
  return image;
}

Texture TextureOf(Image image) { return {std::move(image), Point::Zero(), 1.0}; }

Result<Cutout> CutOutOf(Image image, Foreground foreground, std::optional<int> threshold = {}) {
  return CutOut(TextureOf(std::move(image)), {foreground, threshold});
}

// That a cutout is the disc: its coverage is the alpha, and no pixel has kept the page's colour.
void ExpectDisc(const Image& cut, Colour ink) {
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      const std::uint8_t* pixel = cut.at(x, y);
      ASSERT_NEAR(pixel[3], 255 * Coverage(x, y), 8) << x << ", " << y;
      if (pixel[3] < 40) continue;  // too thin for its colour to be exact
      for (int c = 0; c < 3; ++c) ASSERT_NEAR(pixel[c], ink[c], 8) << x << ", " << y;
    }
  }
}

const Colour kCream = {250, 240, 225, 255}, kInkBlue = {30, 40, 90, 255};

TEST(CutOut, LeavesAPictureWithTransparencyAsItIs) {
  Image image = PictureOf(64, 64);
  PaintDisc(&image, 32, 32, 20, kRed);
  const auto cutout = CutOutOf(image, Foreground::kAlpha, 77);
  ASSERT_TRUE(cutout) << cutout.error().message;
  EXPECT_EQ(cutout->texture.image.rgba, image.rgba);
  EXPECT_EQ(cutout->threshold, 77);
  EXPECT_THAT(cutout->warnings, IsEmpty());
}

TEST(CutOut, MakesPaperTransparentWithSmoothEdgesAndSaysSo) {
  for (const auto& [page, ink] : {std::pair(kWhite, kBlack), std::pair(kCream, kInkBlue),
                                  std::pair(kBlack, kGreen), std::pair(kInkBlue, kCream)}) {
    const auto cutout = CutOutOf(DiscOn(page, ink), Foreground::kAlpha);
    ASSERT_TRUE(cutout) << cutout.error().message;
    ExpectDisc(cutout->texture.image, ink);
    EXPECT_THAT(cutout->warnings, ElementsAre(HasSubstr("its paper, of colour")));
  }
}

TEST(CutOut, KeepsPaperColourInsideTheDrawingAndReportsIt) {
  Image image = DiscOn(kWhite, kInkBlue);
  PaintBox(&image, 28, 26, 7, 5, kWhite);
  const auto cutout = CutOutOf(image, Foreground::kAlpha);
  ASSERT_TRUE(cutout) << cutout.error().message;
  EXPECT_EQ(cutout->texture.image.at(30, 28)[3], 255);
  EXPECT_EQ(cutout->texture.image.at(30, 28)[0], 255);
  ASSERT_EQ(cutout->warnings.size(), 2u);
  EXPECT_THAT(cutout->warnings[1], HasSubstr("inside the drawing, 7 x 5 pixels at (28, 26), was"));
}

TEST(CutOut, TakesAPictureForPaperOnlyWhenItIsASheetOfIt) {
  // A crate drawn to its borders with two colours; a crate with a clear margin; one plain colour.
  Image crate = PictureOf(64, 64, kRed);
  PaintBox(&crate, 0, 0, 64, 24, kBlue);
  PaintBox(&crate, 0, 0, 30, 64, kGreen);
  Image with_margin = PictureOf(64, 64);
  PaintBox(&with_margin, 6, 6, 52, 52, kRed);
  PaintBox(&with_margin, 20, 20, 20, 20, kBlue);
  for (const Image& image : {crate, with_margin, PictureOf(64, 64, kRed)}) {
    const auto cutout = CutOutOf(image, Foreground::kAlpha);
    ASSERT_TRUE(cutout) << cutout.error().message;
    EXPECT_EQ(cutout->texture.image.rgba, image.rgba);
    EXPECT_THAT(cutout->warnings, IsEmpty());
  }
}

TEST(CutOut, FindsPaperBesideADrawingThatTouchesTheFrame) {
  Image image = PictureOf(100, 100, kWhite);
  PaintBox(&image, 30, 0, 40, 80, kBlue);  // 39 of 396 pixels of the frame
  const auto cutout = CutOutOf(image, Foreground::kAlpha);
  ASSERT_TRUE(cutout) << cutout.error().message;
  EXPECT_EQ(cutout->texture.image.at(5, 50)[3], 0);
  EXPECT_EQ(cutout->texture.image.at(50, 0)[3], 255);
}

TEST(CutOut, CutsADarkDrawingFromALightPageAndALightOneFromADark) {
  for (const auto& [page, ink, foreground] : {std::tuple(kWhite, kBlack, Foreground::kDark),
                                              std::tuple(kCream, kInkBlue, Foreground::kDark),
                                              std::tuple(kBlack, kWhite, Foreground::kLight),
                                              std::tuple(kInkBlue, kCream, Foreground::kLight)}) {
    const auto cutout = CutOutOf(DiscOn(page, ink), foreground);
    ASSERT_TRUE(cutout) << cutout.error().message;
    EXPECT_EQ(cutout->threshold, 128);
    ExpectDisc(cutout->texture.image, ink);
    EXPECT_THAT(cutout->warnings, ElementsAre(HasSubstr("than the background, of colour")));
  }
}

TEST(CutOut, MakesTheBackgroundInsideADarkDrawingTransparentToo) {
  Image image = DiscOn(kWhite, kBlack);
  PaintBox(&image, 28, 26, 7, 5, kWhite);
  const auto cutout = CutOutOf(image, Foreground::kDark);
  ASSERT_TRUE(cutout) << cutout.error().message;
  EXPECT_EQ(cutout->texture.image.at(31, 28)[3], 0);
}

TEST(CutOut, PaintsExactlyWhatReachesTheThresholdOfBrightness) {
  Image image = PictureOf(40, 20, kWhite);
  PaintBox(&image, 5, 5, 10, 10, {0, 0, 0, 255});
  PaintBox(&image, 20, 5, 10, 10, {155, 155, 155, 255});  // a shadow, 100 below the page
  for (const auto& [threshold, shadow] : {std::pair(100, true), std::pair(101, false)}) {
    const auto cutout = CutOutOf(image, Foreground::kDark, threshold);
    ASSERT_TRUE(cutout) << cutout.error().message;
    for (int y = 0; y < 20; ++y) {
      for (int x = 0; x < 40; ++x) {
        const bool painted =
            y >= 5 && y < 15 && ((x >= 5 && x < 15) || (shadow && x >= 20 && x < 30));
        ASSERT_EQ(cutout->texture.image.at(x, y)[3] >= 128, painted) << x << ", " << y;
      }
    }
  }
}

TEST(CutOut, TakesATransparentPictureToLieOnPaper) {
  Image image = PictureOf(64, 64);
  PaintDisc(&image, 32, 32, 20, kBlack);
  const auto dark = CutOutOf(image, Foreground::kDark);
  ASSERT_TRUE(dark) << dark.error().message;
  EXPECT_EQ(dark->texture.image.at(32, 32)[3], 255);
  EXPECT_EQ(dark->texture.image.at(2, 2)[3], 0);
}

TEST(CutOut, RefusesAPageOnWhichNothingStandsOut) {
  EXPECT_THAT(CutOutOf(PictureOf(30, 30, kWhite), Foreground::kDark),
              FailsSaying(ErrorCode::kOutlineEmpty, "nothing is darker"));
  EXPECT_THAT(CutOutOf(DiscOn(kBlack, kWhite), Foreground::kDark),
              FailsSaying(ErrorCode::kOutlineEmpty, "brightness 0 of 255"));
  EXPECT_THAT(CutOutOf(DiscOn(kWhite, {200, 200, 200, 255}), Foreground::kDark, 56),
              FailsSaying(ErrorCode::kOutlineEmpty, "the most is 55"));
  EXPECT_TRUE(CutOutOf(DiscOn(kWhite, {200, 200, 200, 255}), Foreground::kDark, 55));
}

TEST(CutOut, TakesThresholdsOfOneTo255) {
  for (const Foreground foreground : {Foreground::kAlpha, Foreground::kLight, Foreground::kDark}) {
    for (const int refused : {0, 256, -1}) {
      EXPECT_THAT(CutOutOf(DiscOn(kWhite, kBlack), foreground, refused),
                  FailsWith(ErrorCode::kInvalidOption, "threshold"));
    }
  }
  EXPECT_TRUE(CutOutOf(DiscOn(kWhite, kBlack), Foreground::kDark, 255));
  EXPECT_TRUE(CutOutOf(DiscOn(kWhite, kBlack), Foreground::kDark, 1));
}

TEST(CutOut, SaysThatABackgroundIsNotPlain) {
  Image image = DiscOn(kWhite, kBlack);
  PaintBox(&image, 0, 0, 64, 4, {180, 190, 200, 255});
  PaintBox(&image, 0, 0, 4, 64, {140, 170, 200, 255});
  const auto cutout = CutOutOf(image, Foreground::kDark);
  ASSERT_TRUE(cutout) << cutout.error().message;
  ASSERT_EQ(cutout->warnings.size(), 2u);
  EXPECT_THAT(cutout->warnings[1], HasSubstr("not plain"));
}

TEST(CutOut, KeepsTheGrainOfAPageOutOfTheDrawing) {
  std::mt19937 random(3);
  Image image = DiscOn({235, 235, 235, 255}, kBlack);
  for (std::size_t k = 0; k < image.rgba.size(); ++k) {
    if (k % 4 == 3) continue;
    const int noisy = image.rgba[k] + static_cast<int>(random() % 17) - 8;
    image.rgba[k] = static_cast<std::uint8_t>(std::clamp(noisy, 0, 255));
  }
  for (const Foreground foreground : {Foreground::kAlpha, Foreground::kDark}) {
    const auto cutout = CutOutOf(image, foreground);
    ASSERT_TRUE(cutout) << cutout.error().message;
    for (int y = 0; y < 64; ++y) {
      for (int x = 0; x < 64; ++x) {
        if (Coverage(x, y, kRadius + 4) > 0.0) continue;
        ASSERT_EQ(cutout->texture.image.at(x, y)[3], 0) << x << ", " << y;
      }
    }
  }
}

TEST(CutOut, TakesThinPictures) {
  for (const auto& [width, height] : {std::pair(1, 1), std::pair(1, 500), std::pair(500, 1)}) {
    for (const Foreground foreground :
         {Foreground::kAlpha, Foreground::kLight, Foreground::kDark}) {
      Image image = PictureOf(width, height, kWhite);
      PaintPixel(&image, width / 2, height / 2, kBlack);
      const auto cutout = CutOutOf(image, foreground);
      if (!cutout) continue;
      EXPECT_EQ(cutout->texture.image.rgba.size(), image.rgba.size());
    }
  }
}

}  // namespace
}  // namespace posespace
