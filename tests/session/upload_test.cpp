// SPDX-License-Identifier: Apache-2.0
#include "session/upload.h"

#include <gtest/gtest.h>

#include "drawing/png_file.h"
#include "geometry/polygon.h"
#include "tests/session/sample_drawings.h"
#include "tests/support/fails_saying.h"
#include "tests/support/fails_with.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

TEST(ReadDrawing, KeepsThePictureAndItsOutline) {
  const auto drawing = ReadDrawing("walk", CreaturePicture(0.1), Limits());
  ASSERT_THAT(drawing, Succeeds());
  EXPECT_EQ(drawing->id, "walk");
  EXPECT_EQ(drawing->width, 128);
  EXPECT_EQ(drawing->height, 128);
  EXPECT_EQ(drawing->texture.image.width, 128);
  EXPECT_EQ(drawing->texture.scale, 1.0);
  EXPECT_GT(SignedArea(drawing->outline.outer), 0.0);
  EXPECT_EQ(Locate(Point(64, 64), drawing->outline.outer), 1);
}

TEST(ReadDrawing, PaintsAPolygonThatHasNoPicture) {
  const PolygonSource source{PointsOf("10 20, 50 20, 50 40, 10 40"), {}, {}};
  const auto drawing = ReadDrawing("box", source, Limits());
  ASSERT_THAT(drawing, Succeeds());
  EXPECT_EQ(drawing->width, 40);
  EXPECT_EQ(drawing->height, 20);
  const Point middle = (Point(30, 30) - drawing->texture.origin) * drawing->texture.scale;
  EXPECT_EQ(
      drawing->texture.image.at(static_cast<int>(middle.x()), static_cast<int>(middle.y()))[3],
      255);
}

TEST(ReadDrawing, TakesAPolygonsPicturePixelByPixel) {
  const auto picture = std::get<ImageSource>(CreaturePicture(0.0));
  const PolygonSource source{PointsOf("10 20, 50 20, 50 40, 10 40"), {}, picture.data};
  const auto drawing = ReadDrawing("box", source, Limits());
  ASSERT_THAT(drawing, Succeeds());
  EXPECT_EQ(drawing->width, 128);
  EXPECT_EQ(drawing->texture.origin, Point(0, 0));
  EXPECT_EQ(drawing->texture.scale, 1.0);
}

TEST(ReadDrawing, NamesTheShapeThatIsAtFault) {
  const ImageSource damaged{{1, 2, 3}};
  const auto undecodable = ReadDrawing("walk", damaged, Limits());
  EXPECT_THAT(undecodable, FailsWith(ErrorCode::kImageUndecodable, "image.data"));
  EXPECT_EQ(undecodable.error().message.find("shape 'walk': "), 0u);

  const ImageSource blank{EncodePng(Image{8, 8, std::vector<std::uint8_t>(8 * 8 * 4)})};
  EXPECT_THAT(ReadDrawing("walk", blank, Limits()),
              FailsWith(ErrorCode::kOutlineEmpty, "image.data"));

  const PolygonSource far_point{PointsOf("0 0, 1e9 10, 10 0, 0 10"), {}, {}};
  EXPECT_THAT(ReadDrawing("walk", far_point, Limits()),
              FailsWith(ErrorCode::kInvalidOption, "polygon.outer[1]"));
  const PolygonSource far_hole{
      PointsOf("0 0, 10 0, 10 10"), {PointsOf("1 0, 2 0, 2 1"), PointsOf("0 0, 1 1, 0 1e9")}, {}};
  EXPECT_THAT(ReadDrawing("walk", far_hole, Limits()),
              FailsWith(ErrorCode::kInvalidOption, "polygon.holes[1][2]"));

  const PolygonSource badly_painted{PointsOf("0 0, 10 0, 10 10"), {}, {1, 2, 3}};
  EXPECT_THAT(ReadDrawing("walk", badly_painted, Limits()),
              FailsWith(ErrorCode::kImageUndecodable, "polygon.texture"));
}

TEST(ReadDrawing, AsksForASource) {
  EXPECT_THAT(ReadDrawing("walk", ImageSource{}, Limits()),
              FailsWith(ErrorCode::kShapeSourceMissing));
  EXPECT_THAT(ReadDrawing("walk", PolygonSource{}, Limits()),
              FailsWith(ErrorCode::kShapeSourceMissing));
}

TEST(ReadDrawing, KeepsToTheLimitsOnBothSides) {
  Limits limits;
  limits.max_image_pixels = 128 * 128;
  EXPECT_THAT(ReadDrawing("walk", CreaturePicture(0.0, 128), limits), Succeeds());
  EXPECT_THAT(ReadDrawing("walk", CreaturePicture(0.0, 129), limits),
              FailsWith(ErrorCode::kImageTooLarge));
  EXPECT_THAT(ReadDrawing("walk", CreaturePicture(0.0, 128), limits, 128 * 128), Succeeds());
  EXPECT_THAT(ReadDrawing("walk", CreaturePicture(0.0, 128), limits, 128 * 128 - 1),
              FailsSaying(ErrorCode::kImageTooLarge, "have taken the rest of 64000000"));
  limits.max_outline_points = 60;
  EXPECT_THAT(ReadDrawing("walk", CreaturePolygon(0.0, 60), limits), Succeeds());
  EXPECT_THAT(ReadDrawing("walk", CreaturePolygon(0.0, 61), limits),
              FailsWith(ErrorCode::kOutlineTooLong));
}

TEST(SourceDigest, DependsOnEveryPartOfASource) {
  const PolygonSource base{PointsOf("0 0, 9 0, 9 9"), {PointsOf("5 2, 7 2, 7 4")}, {1, 2}};
  PolygonSource other_ring = base, other_hole = base, no_hole = base, other_texture = base;
  other_ring.outer(0, 0) = 1e-300;
  other_hole.holes[0](0, 0) = 5.5;
  no_hole.holes.clear();
  other_texture.texture = {1};
  EXPECT_EQ(SourceDigest(base), SourceDigest(PolygonSource(base)));
  for (const PolygonSource& other : {other_ring, other_hole, no_hole, other_texture}) {
    EXPECT_NE(SourceDigest(base), SourceDigest(other));
  }
  EXPECT_NE(SourceDigest(ImageSource{{1, 2}, {Foreground::kAlpha, 128}}),
            SourceDigest(ImageSource{{1, 2}, {Foreground::kAlpha, 127}}));
  EXPECT_NE(SourceDigest(ImageSource{{1, 2}, {Foreground::kAlpha, 128}}),
            SourceDigest(ImageSource{{1}, {Foreground::kAlpha, 128}}));
  EXPECT_NE(SourceDigest(ImageSource{{1, 2}, {Foreground::kAlpha, 128}}),
            SourceDigest(ImageSource{{1, 2}, {Foreground::kDark, 128}}));
}

}  // namespace
}  // namespace posespace
