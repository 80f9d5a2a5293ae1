// SPDX-License-Identifier: Apache-2.0
#include "session/flip.h"

#include <gtest/gtest.h>

#include "drawing/decode.h"
#include "drawing/png_file.h"
#include "geometry/polygon.h"
#include "session/session.h"
#include "tests/session/sample_drawings.h"
#include "tests/support/fails_with.h"
#include "tests/support/points.h"

namespace posespace {
namespace {

Drawing Read(const ShapeSource& source) {
  return std::move(ReadDrawing("a", source, Limits())).value();
}

Drawing FlippedOf(const ShapeSource& source) {
  const Drawing drawing = Read(source);
  return Flipped(drawing, MirrorSum(source, drawing));
}

// The alpha of a drawing's texture at a point of the drawing.
int AlphaAt(const Drawing& drawing, const Point& p) {
  const Point texel = (p - drawing.texture.origin) * drawing.texture.scale;
  return drawing.texture.image.at(static_cast<int>(texel.x()), static_cast<int>(texel.y()))[3];
}

TEST(Flipped, GivesThePixelsAndOutlineOfAMirroredFile) {
  const auto picture = std::get<ImageSource>(CreaturePicture(0.3));
  Image image = std::move(DecodeImage(picture.data)).value();
  Image mirrored = image;
  for (int y = 0; y < image.height; ++y) {
    for (int x = 0; x < image.width; ++x) {
      std::copy_n(image.at(x, y), 4, mirrored.at(image.width - 1 - x, y));
    }
  }
  ImageSource source = picture;
  source.data = EncodePng(mirrored);
  const Drawing expected = Read(source), flipped = FlippedOf(picture);
  EXPECT_EQ(flipped.texture.image.rgba, expected.texture.image.rgba);
  EXPECT_EQ(flipped.texture.origin, Point(0, 0));
  EXPECT_GT(SignedArea(flipped.outline.outer), 0.0);
  EXPECT_NEAR(SignedArea(flipped.outline.outer), SignedArea(expected.outline.outer), 60.0);
  EXPECT_LT((AreaCentroid(flipped.outline.outer) - AreaCentroid(expected.outline.outer)).norm(),
            0.2);
  EXPECT_TRUE(flipped.flipped);
  EXPECT_NE(flipped.digest, Read(picture).digest);
}

TEST(Flipped, MirrorsRingsWithinTheirBoxWithTheirPaint) {
  const PolygonSource source{PointsOf("10 0, 50 0, 50 80"), {}, {}};
  const Drawing flipped = FlippedOf(source);
  const Points& ring = flipped.outline.outer;
  EXPECT_EQ(ring.col(0).minCoeff(), 10.0);
  EXPECT_EQ(ring.col(0).maxCoeff(), 50.0);
  EXPECT_GT(SignedArea(ring), 0.0);
  EXPECT_EQ(Locate(Point(15, 40), ring), 1);
  EXPECT_EQ(AlphaAt(flipped, Point(15, 40)), 255);
  EXPECT_EQ(AlphaAt(flipped, Point(45, 40)), 0);
}

TEST(Flipped, KeepsColoursWithTheirRows) {
  const ShapeSource source = CreaturePicture(0.2);
  const Drawing drawing = Read(source), flipped = FlippedOf(source);
  const auto last = drawing.outline.outer.rows() - 1;
  EXPECT_EQ(flipped.outline.outer(0, 0), drawing.width - drawing.outline.outer(last, 0));
  EXPECT_EQ(flipped.outline.colours.row(0), drawing.outline.colours.row(last));
}

class FlipInSession : public testing::Test {
 protected:
  // Puts "a" with its longest arm up or down, as it is or in a mirror.
  Result<std::shared_ptr<const Drawing>> Put(double lift, bool flip) {
    return session_.PutShape("a", CreaturePolygon(lift), true, flip);
  }
  Point MarkOfA() const { return session_.View().correspondences[0].at("a"); }

  Session session_{"tux", "", {}, Limits()};
};

TEST_F(FlipInSession, MovesTheMarksOfADrawingThatIsOnlyFlipped) {
  ASSERT_THAT(Put(0.0, false), Succeeds());
  const Points ring = CreatureRing(0.0);
  const Point mark = ring.row(7);
  ASSERT_THAT(session_.SetCorrespondences({{{"a", mark}}}, ""), Succeeds());
  ASSERT_THAT(Put(0.0, true), Succeeds());
  const double sum = ring.col(0).minCoeff() + ring.col(0).maxCoeff();
  EXPECT_LT((MarkOfA() - Point(sum - mark.x(), mark.y())).norm(), 1e-9);
  ASSERT_THAT(Put(0.0, false), Succeeds());
  EXPECT_LT((MarkOfA() - mark).norm(), 1e-9);
}

TEST_F(FlipInSession, LeavesMarksWhenTheDrawingIsAnotherOne) {
  ASSERT_THAT(Put(0.0, false), Succeeds());
  const Point mark = CreatureRing(0.0).row(7);
  ASSERT_THAT(session_.SetCorrespondences({{{"a", mark}}}, ""), Succeeds());
  ASSERT_THAT(Put(0.3, true), Succeeds());
  EXPECT_EQ(MarkOfA(), mark);
}

TEST_F(FlipInSession, TakesAFlippedDrawingForAnotherOne) {
  ASSERT_THAT(session_.PutShape("a", CreaturePolygon(0.0), false, false), Succeeds());
  EXPECT_THAT(session_.PutShape("a", CreaturePolygon(0.0), false, true),
              FailsWith(ErrorCode::kShapeExists, "shape_id"));
  const auto flipped = Put(0.0, true);
  ASSERT_THAT(flipped, Succeeds());
  EXPECT_EQ(*session_.PutShape("a", CreaturePolygon(0.0), false, true), *flipped);
  EXPECT_TRUE((*session_.FindShape("a"))->flipped);
}

}  // namespace
}  // namespace posespace
