// SPDX-License-Identifier: Apache-2.0
#include "drawing/render.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "tests/support/pictures.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

struct Grid {
  Triangles triangles;
  Points vertices;
};

// cells x cells squares over a box, each of two triangles, the inner vertices moved at random by
// less than a third of a cell.
Grid GridOver(const Point& low, const Point& high, int cells, unsigned seed = 0) {
  std::mt19937 random(seed);
  Grid grid;
  grid.vertices.resize((cells + 1) * (cells + 1), 2);
  grid.triangles.resize(2 * cells * cells, 3);
  for (int j = 0; j <= cells; ++j) {
    for (int i = 0; i <= cells; ++i) {
      Eigen::Array2d place(i, j);
      if (seed != 0 && i > 0 && j > 0 && i < cells && j < cells) {
        place += (Eigen::Array2d(random() % 1000, random() % 1000) / 1000.0 - 0.5) * 0.6;
      }
      grid.vertices.row(j * (cells + 1) + i) =
          (low.array() + (high - low).array() * place / cells).matrix().transpose();
    }
  }
  for (int j = 0, t = 0; j < cells; ++j) {
    for (int i = 0; i < cells; ++i) {
      const int a = j * (cells + 1) + i, b = a + 1, c = a + cells + 1, d = c + 1;
      grid.triangles.row(t++) << a, b, d;
      grid.triangles.row(t++) << a, d, c;
    }
  }
  return grid;
}

Image ColourfulPicture(int width, int height) {
  std::mt19937 random(3);
  Image image = PictureOf(width, height);
  for (std::uint8_t& value : image.rgba) value = static_cast<std::uint8_t>(random());
  return image;
}

Image RenderOne(const Grid& grid, const Texture& texture, const View& view) {
  const RenderTexture prepared(texture);
  const RenderLayer layer{&grid.vertices, &prepared, 1.0};
  return Render(grid.triangles, grid.vertices, {&layer, 1}, view);
}

View ViewOf(int width, int height, double scale = 1.0) {
  return {Point::Zero(), scale, width, height};
}

int LargestDifference(const Image& a, const Image& b) {
  int largest = 0;
  for (std::size_t k = 0; k < a.rgba.size(); ++k) {
    largest = std::max(largest, std::abs(a.rgba[k] - b.rgba[k]));
  }
  return largest;
}

TEST(Render, ReproducesThePictureAtThePose) {
  Image image = ColourfulPicture(60, 44);
  const Grid grid = GridOver({0, 0}, {60, 44}, 1);
  const Image rendered = RenderOne(grid, {image}, ViewOf(60, 44));
  ASSERT_EQ(rendered.rgba.size(), image.rgba.size());
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      if (image.at(x, y)[3] == 0) PaintPixel(&image, x, y, kClear);  // has no colour any more
    }
  }
  EXPECT_LE(LargestDifference(rendered, image), 1);
}

TEST(Render, ReproducesAnOpaquePictureThroughAnIrregularMesh) {
  Image image = PictureOf(64, 64);  // smooth, since vertices are rounded to 1/1024 pixel
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x) {
      PaintPixel(&image, x, y,
                 {static_cast<std::uint8_t>(4 * x), static_cast<std::uint8_t>(4 * y), 90, 255});
    }
  }
  const Image rendered = RenderOne(GridOver({-3, -3}, {67, 67}, 9, 5), {image}, ViewOf(64, 64));
  EXPECT_LE(LargestDifference(rendered, image), 1);
}

TEST(Render, DrawsEveryInnerPixelExactlyOnce) {
  // At half opacity a pixel left out would show 0 and one drawn twice 192.
  const Texture texture{PictureOf(1, 1, {255, 255, 255, 128}), {-1e5, -1e5}, 0.5e-5};
  const Grid on_centres = GridOver({0.5, 0.5}, {40.5, 40.5}, 40);  // ties everywhere
  const Grid coarse = GridOver({0.5, 0.5}, {40.5, 40.5}, 5);       // diagonals through centres
  const Grid fine = GridOver({0.5, 0.5}, {40.5, 40.5}, 150, 1);    // smaller than pixels
  const Grid irregular = GridOver({0.5, 0.5}, {40.5, 40.5}, 13, 2);
  for (const Grid& grid : {on_centres, coarse, fine, irregular}) {
    const RenderTexture prepared(texture);
    // Every triangle shows the texel in the middle, where all is one colour.
    const Points middle = Points::Zero(grid.vertices.rows(), 2);
    const RenderLayer layer{&middle, &prepared, 1.0};
    const Image rendered = Render(grid.triangles, grid.vertices, {&layer, 1}, ViewOf(42, 42));
    for (int y = 0; y < 42; ++y) {
      for (int x = 0; x < 42; ++x) {
        const bool inside = x < 40 && y < 40;  // the left and top edges own their centres
        ASSERT_EQ(rendered.at(x, y)[3], inside ? 128 : 0) << x << ", " << y;
      }
    }
  }
}

TEST(Render, HasNoSeamsAtAnyScale) {
  const Texture texture{PictureOf(64, 64, {200, 30, 90, 255})};
  const Grid grid = GridOver({8, 8}, {56, 56}, 12, 4);
  for (const double scale : {0.37, 1.0, 3.3, 17.0}) {
    const int size = static_cast<int>(48 * scale);
    const Image rendered = RenderOne(grid, texture, {{8, 8}, scale, size, size});
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        ASSERT_EQ(Colour({rendered.at(x, y)[0], rendered.at(x, y)[1], rendered.at(x, y)[2],
                          rendered.at(x, y)[3]}),
                  Colour({200, 30, 90, 255}))
            << scale << ": " << x << ", " << y;
      }
    }
  }
}

TEST(Render, TwoHalvesOfATextureMakeTheWhole) {
  const Texture texture{ColourfulPicture(50, 50)};
  const Grid grid = GridOver({2, 3}, {47, 49}, 6, 8);
  const RenderTexture prepared(texture);
  const RenderLayer halves[] = {{&grid.vertices, &prepared, 0.5}, {&grid.vertices, &prepared, 0.5}};
  const Image whole = RenderOne(grid, texture, ViewOf(50, 50));
  const Image both = Render(grid.triangles, grid.vertices, halves, ViewOf(50, 50));
  EXPECT_LE(LargestDifference(whole, both), 1);
}

TEST(Render, MixesInLinearLight) {
  const RenderTexture black({PictureOf(8, 8, kBlack)}), white({PictureOf(8, 8, kWhite)});
  const Grid grid = GridOver({0, 0}, {8, 8}, 1);
  const RenderLayer layers[] = {{&grid.vertices, &black, 0.5}, {&grid.vertices, &white, 0.5}};
  const Image mixed = Render(grid.triangles, grid.vertices, layers, ViewOf(8, 8));
  EXPECT_EQ(mixed.at(4, 4)[0], 188);  // half the light, not half the number
  EXPECT_EQ(mixed.at(4, 4)[3], 255);
}

TEST(Render, TakesEachPosesTexelAtTheSameBarycentricPlace) {
  Image left = PictureOf(20, 10, kRed);
  PaintBox(&left, 10, 0, 10, 10, kBlue);
  const RenderTexture prepared({left});
  const Grid pose = GridOver({0, 0}, {20, 10}, 1);
  Grid turned = pose;  // a quarter turn: (x, y) -> (10 - y, x)
  for (int k = 0; k < pose.vertices.rows(); ++k) {
    turned.vertices.row(k) << 10 - pose.vertices(k, 1), pose.vertices(k, 0);
  }
  const RenderLayer layer{&pose.vertices, &prepared, 1.0};
  const Image rendered = Render(pose.triangles, turned.vertices, {&layer, 1}, ViewOf(10, 20));
  EXPECT_EQ(rendered.at(5, 4)[0], 255);
  EXPECT_EQ(rendered.at(5, 15)[2], 255);
  EXPECT_EQ(rendered.at(5, 15)[0], 0);
}

TEST(Render, DoesNotBleedColoursOfTransparentTexels) {
  Image image = PictureOf(16, 16, {0, 0, 255, 0});
  PaintBox(&image, 0, 0, 8, 16, kRed);
  const Grid grid = GridOver({0, 0}, {16, 16}, 4);
  for (const double scale : {0.2, 0.5, 1.0, 4.0, 7.7}) {
    const int size = static_cast<int>(16 * scale);
    const Image rendered = RenderOne(grid, {image}, ViewOf(size, size, scale));
    int partial = 0;
    for (int y = 0; y < size; ++y) {
      for (int x = 0; x < size; ++x) {
        const std::uint8_t* p = rendered.at(x, y);
        if (p[3] == 0) continue;
        if (p[3] < 255) ++partial;
        EXPECT_EQ(p[0], 255) << scale;
        EXPECT_EQ(p[2], 0) << scale;
      }
    }
    EXPECT_TRUE(scale < 2 || partial > 0);  // the edge is soft, and still red
  }
}

TEST(Render, LaysLaterTrianglesOnTopAndLetsThemShowWhatIsBelow) {
  Image image = PictureOf(30, 10, kClear);
  PaintBox(&image, 0, 0, 10, 10, kRed);
  PaintBox(&image, 10, 0, 10, 10, kBlue);
  const RenderTexture prepared({image});
  const Points pose = PointsOf("1 1, 9 1, 1 9, 11 1, 19 1, 11 9, 21 1, 29 1, 21 9");
  const Points drawn = PointsOf("0 0, 8 0, 0 8, 0 0, 8 0, 0 8, 0 0, 8 0, 0 8");
  const RenderLayer layer{&pose, &prepared, 1.0};
  Triangles triangles(3, 3);
  triangles << 0, 1, 2, 3, 4, 5, 6, 7, 8;  // red, blue on top, then a transparent one
  EXPECT_EQ(Render(triangles, drawn, {&layer, 1}, ViewOf(8, 8)).at(2, 2)[2], 255);
  triangles << 3, 4, 5, 0, 1, 2, 6, 7, 8;
  const Image red = Render(triangles, drawn, {&layer, 1}, ViewOf(8, 8));
  EXPECT_EQ(red.at(2, 2)[0], 255);
  EXPECT_EQ(red.at(2, 2)[2], 0);
}

TEST(Render, SkipsSlightLayersWithoutLosingOpacity) {
  const RenderTexture red({PictureOf(8, 8, kRed)}), blue({PictureOf(8, 8, kBlue)});
  const Grid grid = GridOver({0, 0}, {8, 8}, 1);
  std::vector<RenderLayer> layers = {{&grid.vertices, &red, 1.0 - 8 * 0.0019}};
  for (int k = 0; k < 8; ++k) layers.push_back({&grid.vertices, &blue, 0.0019});
  const Image rendered = Render(grid.triangles, grid.vertices, layers, ViewOf(8, 8));
  EXPECT_EQ(rendered.at(3, 3)[0], 255);
  EXPECT_EQ(rendered.at(3, 3)[2], 0);
  EXPECT_EQ(rendered.at(3, 3)[3], 255);
}

TEST(Render, AveragesDetailSmallerThanAPixel) {
  Image checks = PictureOf(512, 512, kBlack);
  for (int y = 0; y < 512; ++y) {
    for (int x = y % 2; x < 512; x += 2) PaintPixel(&checks, x, y, kWhite);
  }
  const Grid grid = GridOver({0, 0}, {512, 512}, 7, 3);
  for (const double scale : {1.0 / 5.0, 1.0 / 8.0, 1.0 / 30.0}) {
    const int size = static_cast<int>(512 * scale);
    const Image rendered = RenderOne(grid, {checks}, ViewOf(size, size, scale));
    for (int y = 1; y + 1 < size; ++y) {
      for (int x = 1; x + 1 < size; ++x) EXPECT_NEAR(rendered.at(x, y)[0], 188, 1) << scale;
    }
  }
}

TEST(Render, TakesFoldedFlatAndFarTriangles) {
  const RenderTexture red({PictureOf(8, 8, kRed)});
  const Points pose = PointsOf("1 1, 7 1, 1 7");
  const RenderLayer layer{&pose, &red, 1.0};
  Triangles triangle(1, 3);
  triangle << 0, 1, 2;
  const auto drawn = [&](const char* vertices) {
    const Image image = Render(triangle, PointsOf(vertices), {&layer, 1}, ViewOf(8, 8));
    int painted = 0;
    for (std::size_t k = 3; k < image.rgba.size(); k += 4) painted += image.rgba[k] == 255;
    return painted;
  };
  EXPECT_EQ(drawn("0 0, 0 8, 8 0"), drawn("0 0, 8 0, 0 8"));  // folded: its back shows
  EXPECT_EQ(drawn("0 0, 4 4, 8 8"), 0);
  EXPECT_EQ(drawn("3 3, 3 3, 3 3"), 0);
  EXPECT_EQ(drawn("100 100, 200 100, 100 200"), 0);
  EXPECT_EQ(drawn("-1e4 -1e4, 1e5 -1e4, -1e4 1e5"), 64);
  EXPECT_EQ(drawn("-1e300 -1e300, 1e300 -1e300, 0 1e300"), 64);
}

TEST(Render, GivesAnEmptyPictureForNothingToDrawOrNowhereToDrawIt) {
  const Grid grid = GridOver({0, 0}, {8, 8}, 1);
  const RenderTexture red({PictureOf(8, 8, kRed)}), none{Texture{}};
  const Image nothing = Render(grid.triangles, grid.vertices, {}, ViewOf(5, 4));
  EXPECT_EQ(nothing.rgba, std::vector<std::uint8_t>(5 * 4 * 4, 0));
  const RenderLayer empty{&grid.vertices, &none, 1.0}, full{&grid.vertices, &red, 1.0};
  EXPECT_EQ(Render(grid.triangles, grid.vertices, {&empty, 1}, ViewOf(5, 4)).rgba, nothing.rgba);
  EXPECT_TRUE(Render(grid.triangles, grid.vertices, {&full, 1}, ViewOf(0, 4)).rgba.empty());
  const double not_a_number = std::nan("");
  for (const double scale : {0.0, -1.0, not_a_number, std::numeric_limits<double>::infinity()}) {
    EXPECT_EQ(Render(grid.triangles, grid.vertices, {&full, 1}, ViewOf(5, 4, scale)).rgba,
              nothing.rgba);
  }
}

TEST(RenderTexture, IsBilinearBetweenTexelCentresAndTransparentOutside) {
  Image image = PictureOf(2, 1, kBlack);
  PaintPixel(&image, 1, 0, kWhite);
  const RenderTexture texture({image, {10, 20}, 0.5});  // texels of 2 x 2 drawing pixels
  EXPECT_NEAR(texture.At({11, 21})[0], 0.0, 1e-6);
  EXPECT_NEAR(texture.At({13, 21})[0], 1.0, 1e-6);
  EXPECT_NEAR(texture.At({12, 21})[0], 0.5, 1e-6);
  EXPECT_NEAR(texture.At({12, 21})[3], 1.0, 1e-6);
  EXPECT_NEAR(texture.At({14, 21})[3], 0.5, 1e-6);
  EXPECT_NEAR(texture.At({9.5, 21})[3], 0.25, 1e-6);
  for (const Point& far : {Point(0, 21), Point(12, 40), Point(1e300, 0), Point(std::nan(""), 21)}) {
    EXPECT_EQ(texture.At(far)[3], 0.0f);
  }
}

TEST(FitView, CentresTheBoxAndKeepsItsAspect) {
  const View view = FitView({10, 20}, {30, 60}, 100, 100);
  EXPECT_DOUBLE_EQ(view.scale, 2.5);
  const auto distance = [&](const Point& p, const Point& pixel) {
    return ((p - view.origin) * view.scale - pixel).norm();
  };
  EXPECT_LT(distance({20, 40}, {50, 50}), 1e-12);
  EXPECT_LT(distance({10, 20}, {25, 0}), 1e-12);
  EXPECT_LT(distance({30, 60}, {75, 100}), 1e-12);
}

TEST(FitView, ShowsABoxWithoutSizeAtScaleOne) {
  const View view = FitView({5, 7}, {5, 7}, 10, 20);
  EXPECT_DOUBLE_EQ(view.scale, 1.0);
  EXPECT_EQ(view.origin, Point(0, -3));
}

}  // namespace
}  // namespace posespace
