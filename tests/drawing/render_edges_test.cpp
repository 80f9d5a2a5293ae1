// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drawing/render.h"
#include "tests/support/pictures.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

constexpr int kSide = 64;

// Two drawings on the same square mesh, mixed.
Image Mix(const Image& first, const Image& second, double share_of_second, PaintEdges edges,
          double magnification = 1.0) {
  const RenderTexture a({first}), b({second});
  Points square(4, 2);
  square << 0, 0, kSide, 0, kSide, kSide, 0, kSide;
  Triangles triangles(2, 3);
  triangles << 0, 1, 2, 0, 2, 3;
  const RenderLayer layers[] = {{&square, &a, 1.0 - share_of_second},
                                {&square, &b, share_of_second}};
  const int side = static_cast<int>(kSide * magnification);
  return Render(triangles, square, layers, {{0, 0}, magnification, side, side}, edges);
}

// A vertical stroke in the middle.
Image Stroke(int width, Colour colour = kBlack) {
  Image image = PictureOf(kSide, kSide);
  PaintBox(&image, (kSide - width) / 2, 0, width, kSide, colour);
  return image;
}

// Opacity of the middle row.
std::vector<double> Row(const Image& image) {
  std::vector<double> row;
  for (int x = 0; x < image.width; ++x) {
    row.push_back(image.at(x, image.height / 2)[3] / 255.0);
  }
  return row;
}

double WidthOf(const std::vector<double>& row) {
  double width = 0.0;
  for (const double each : row) width += each;
  return width;
}

// Pixels that are neither painted nor clear.
int Faint(const std::vector<double>& row) {
  return static_cast<int>(
      std::count_if(row.begin(), row.end(), [](double a) { return a > 0.02 && a < 0.98; }));
}

TEST(CrispEdges, GiveAStrokeBetweenThinAndThickTheMeanWidth) {
  for (const double share : {0.1, 0.25, 0.5, 0.75, 0.9}) {
    const std::vector<double> row = Row(Mix(Stroke(4), Stroke(24), share, PaintEdges::kCrisp));
    EXPECT_NEAR(WidthOf(row), 4 + 20 * share, 0.5) << share;
    EXPECT_LE(Faint(row), 2) << share;
  }
}

TEST(CrispEdges, StaySharpInAMagnifiedPictureOfALargerOne) {
  const std::vector<double> row = Row(Mix(Stroke(4), Stroke(24), 0.5, PaintEdges::kCrisp, 4.0));
  EXPECT_NEAR(WidthOf(row), 4 * 14, 2.0);
  EXPECT_LE(Faint(row), 2 * 4);  // a texel on either side
}

TEST(CrispEdges, AreSoftOnRequest) {
  const std::vector<double> row = Row(Mix(Stroke(4), Stroke(24), 0.5, PaintEdges::kSoft));
  EXPECT_GE(Faint(row), 18);
}

TEST(CrispEdges, PaintInTheMeanColourAlsoWhereOneDrawingIsNotPainted) {
  const Image mixed = Mix(Stroke(4, kRed), Stroke(24, kBlue), 0.5, PaintEdges::kCrisp);
  const std::uint8_t* beside = mixed.at(kSide / 2 + 5, kSide / 2);
  const std::uint8_t* within = mixed.at(kSide / 2, kSide / 2);
  EXPECT_NEAR(within[0], 188, 1);  // half the light
  EXPECT_NEAR(beside[0], within[0], 3);
  EXPECT_NEAR(beside[2], within[2], 3);
  EXPECT_EQ(beside[3], 255);
}

TEST(CrispEdges, ChangeNothingWhereDrawingsAgree) {
  Image shaded = PictureOf(kSide, kSide);
  PaintDisc(&shaded, 32, 32, 28, {90, 60, 30, 60});  // a shade, fainter than an edge
  PaintDisc(&shaded, 32, 32, 20, {10, 200, 30, 255});
  PaintDisc(&shaded, 32, 32, 10, {200, 20, 30, 180});
  const Image crisp = Mix(shaded, shaded, 0.4, PaintEdges::kCrisp);
  const Image soft = Mix(shaded, shaded, 0.4, PaintEdges::kSoft);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      EXPECT_NEAR(crisp.at(x, y)[3], soft.at(x, y)[3], 1) << x << ", " << y;
    }
  }
}

// Half and half of two pictures whose columns left of `strip` are shown `shown` pixels wide, and
// the others as they are.
Image MixReshaped(const Image& a, const Image& b, double strip, double shown) {
  const RenderTexture first({a}), second({b});
  Points pose(6, 2), vertices(6, 2);
  pose << 0, 0, strip, 0, kSide, 0, 0, kSide, strip, kSide, kSide, kSide;
  vertices = pose;
  for (const int v : {1, 2, 4, 5}) vertices(v, 0) += shown - strip;
  Triangles triangles(4, 3);
  triangles << 0, 1, 4, 0, 4, 3, 1, 2, 5, 1, 5, 4;
  const RenderLayer layers[] = {{&pose, &first, 0.5}, {&pose, &second, 0.5}};
  const int width = static_cast<int>(kSide - strip + shown);
  return Render(triangles, vertices, layers, {{0, 0}, 1.0, width, kSide});
}

// Painted left of an edge that runs from `top` to `bottom`, antialiased.
Image LeftOf(double top, double bottom) {
  Image image = PictureOf(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    const double edge = top + (bottom - top) * (y + 0.5) / kSide;
    for (int x = 0; x < kSide; ++x) {
      image.at(x, y)[3] = static_cast<std::uint8_t>(255 * std::clamp(edge - x, 0.0, 1.0));
    }
  }
  return image;
}

TEST(CrispEdges, StaySharpWhereTheDrawingIsShownStretched) {
  const Image mixed = MixReshaped(LeftOf(6, 6), LeftOf(10, 10), 16, 128);
  const std::vector<double> row = Row(mixed);
  EXPECT_NEAR(WidthOf(row), 8 * 8, 4.0);
  EXPECT_LE(Faint(row), 4);
}

TEST(CrispEdges, AreAntialiasedWhereTheDrawingIsShownSqueezed) {
  constexpr double kStrip = 32.0, kShown = 6.0;
  const Image mixed = MixReshaped(LeftOf(10, 18), LeftOf(14, 22), kStrip, kShown);
  for (int y = 4; y < kSide - 4; ++y) {
    const double edge = (12.0 + 8.0 * (y + 0.5) / kSide) * kShown / kStrip;  // pixels
    for (int x = 0; x < 6; ++x) {
      EXPECT_NEAR(mixed.at(x, y)[3] / 255.0, std::clamp(edge - x, 0.0, 1.0), 0.15)
          << x << ", " << y;
    }
  }
}

// A disc in the middle, antialiased.
Image SmoothDisc(double radius) {
  Image image = PictureOf(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double inside = radius - std::hypot(x + 0.5 - kSide / 2, y + 0.5 - kSide / 2);
      image.at(x, y)[3] = static_cast<std::uint8_t>(255 * std::clamp(inside + 0.5, 0.0, 1.0));
    }
  }
  return image;
}

TEST(CrispEdges, LeaveNoFaintLineWhereTheEdgeOfOneDrawingRunsInsideTheOther) {
  for (const double magnification : {0.7, 1.0, 1.6}) {
    const Image mixed =
        Mix(SmoothDisc(6.3), SmoothDisc(24.6), 0.5, PaintEdges::kCrisp, magnification);
    for (int y = 0; y < mixed.height; ++y) {
      for (int x = 0; x < mixed.width; ++x) {
        const double centre = 0.5 * mixed.width;
        const double radius = std::hypot(x + 0.5 - centre, y + 0.5 - centre) / magnification;
        const int alpha = mixed.at(x, y)[3];
        EXPECT_TRUE(radius > 13.5 || alpha >= 250) << x << ", " << y << ": " << alpha;
        // Antialiasing of the larger edge may count as a shade.
        EXPECT_TRUE(radius < 17.5 || alpha <= 12) << x << ", " << y << ": " << alpha;
      }
    }
  }
}

TEST(CrispEdges, BecomeThoseOfADrawingAsItsWeightGrows) {
  Image disc = PictureOf(kSide, kSide);
  for (int y = 0; y < kSide; ++y) {
    for (int x = 0; x < kSide; ++x) {
      const double inside = 17.3 - std::hypot(x + 0.5 - 30, y + 0.5 - 34);
      disc.at(x, y)[3] = static_cast<std::uint8_t>(255 * std::clamp(inside + 0.5, 0.0, 1.0));
    }
  }
  const Image alone = Mix(disc, Stroke(9), 0.0, PaintEdges::kCrisp);
  const double perimeter = 2 * 3.14 * 17.3;
  for (const double share : {0.1, 0.03, 0.01, 0.003}) {
    const Image mixed = Mix(disc, Stroke(9), share, PaintEdges::kCrisp);
    double difference = 0.0;
    for (int y = 0; y < kSide; ++y) {
      for (int x = 0; x < kSide; ++x) {
        difference += std::abs(mixed.at(x, y)[3] - alone.at(x, y)[3]) / 255.0;
      }
    }
    // An edge moves by a share of the way to the other drawing's, and no two lie 30 pixels apart.
    EXPECT_LT(difference, (30 * share + 0.01) * perimeter) << share;
    EXPECT_GT(difference, 0.0) << share;
  }
}

TEST(CrispEdges, LeaveNothingOfADrawingThatIsEmptyElsewhere) {
  const Image nothing = PictureOf(kSide, kSide);
  for (const double share : {0.3, 0.7}) {
    const std::vector<double> row = Row(Mix(Stroke(10), nothing, share, PaintEdges::kCrisp));
    EXPECT_LE(Faint(row), 2);
    EXPECT_EQ(WidthOf(row), 0.0);
  }
}

TEST(CrispEdges, TakeATextureWithoutTexelsAsNotPainted) {
  const std::vector<double> row = Row(Mix(Stroke(10), Image{}, 0.5, PaintEdges::kCrisp));
  EXPECT_EQ(WidthOf(row), 0.0);
}

}  // namespace
}  // namespace posespace
