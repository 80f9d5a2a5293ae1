// SPDX-License-Identifier: Apache-2.0
#include "rpc/convert.h"

#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "tests/support/fails_saying.h"
#include "tests/support/fails_with.h"

namespace posespace {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

void SetRing(std::initializer_list<double> coordinates, v1::Ring* ring) {
  ring->mutable_coordinates()->Assign(coordinates.begin(), coordinates.end());
}

TEST(ShapeSource, IsRefusedWhenMissing) {
  EXPECT_THAT(ShapeSourceFromProto({}), FailsWith(ErrorCode::kShapeSourceMissing));
}

TEST(ShapeSource, KeepsTheBytesAndTheDefaultThreshold) {
  v1::PutShapeRequest request;
  request.mutable_image()->set_data(std::string("\x89PN\0G", 5));
  const auto source = ShapeSourceFromProto(request);
  ASSERT_TRUE(source);
  const ImageSource& image = std::get<ImageSource>(*source);
  EXPECT_THAT(image.data, ElementsAre(0x89, 'P', 'N', 0, 'G'));
  EXPECT_EQ(image.options.foreground, Foreground::kAlpha);
  EXPECT_EQ(image.options.threshold, std::nullopt);
}

TEST(ShapeSource, TellsWhichPixelsAreTheDrawing) {
  v1::PutShapeRequest request;
  request.mutable_image()->set_threshold(40);
  for (const auto& [sent, read] : {std::pair(v1::FOREGROUND_ALPHA, Foreground::kAlpha),
                                   std::pair(v1::FOREGROUND_LIGHT, Foreground::kLight),
                                   std::pair(v1::FOREGROUND_DARK, Foreground::kDark)}) {
    request.mutable_image()->set_foreground(sent);
    const auto source = ShapeSourceFromProto(request);
    ASSERT_TRUE(source);
    EXPECT_EQ(std::get<ImageSource>(*source).options.foreground, read);
    EXPECT_EQ(std::get<ImageSource>(*source).options.threshold, 40);
  }
}

TEST(ShapeSource, RefusesAForegroundItDoesNotKnow) {
  v1::PutShapeRequest request;
  request.mutable_image()->set_foreground(static_cast<v1::Foreground>(77));
  EXPECT_THAT(ShapeSourceFromProto(request),
              FailsSaying(ErrorCode::kInvalidOption, "image.foreground"));
}

TEST(ShapeSource, ReadsRingsAsRowsOfXAndY) {
  v1::PutShapeRequest request;
  SetRing({0, 1, 2, 3, 4, 5}, request.mutable_polygon()->mutable_outer());
  SetRing({6, 7}, request.mutable_polygon()->add_holes());
  const auto source = ShapeSourceFromProto(request);
  ASSERT_TRUE(source);
  const PolygonSource& polygon = std::get<PolygonSource>(*source);
  EXPECT_EQ(polygon.outer, (Points(3, 2) << 0, 1, 2, 3, 4, 5).finished());
  ASSERT_EQ(polygon.holes.size(), 1u);
  EXPECT_EQ(polygon.holes[0], (Points(1, 2) << 6, 7).finished());
}

TEST(ShapeSource, RefusesAnOddNumberOfCoordinates) {
  v1::PutShapeRequest request;
  SetRing({0, 1, 2, 3, 4, 5}, request.mutable_polygon()->mutable_outer());
  SetRing({6, 7, 8}, request.mutable_polygon()->add_holes());
  EXPECT_THAT(ShapeSourceFromProto(request),
              FailsSaying(ErrorCode::kInvalidOption, "polygon.holes[0]"));
}

TEST(Correspondences, AreReadWhole) {
  v1::SetCorrespondencesRequest request;
  auto& points = *request.add_tuples()->mutable_points();
  points["walk"].set_x(1.5);
  points["run"].set_y(-2.0);
  const auto tuples = CorrespondencesFromProto(request);
  ASSERT_EQ(tuples.size(), 1u);
  EXPECT_EQ(tuples[0].at("walk"), Point(1.5, 0.0));
  EXPECT_EQ(tuples[0].at("run"), Point(0.0, -2.0));
}

TEST(Placements, AreReadByShape) {
  v1::SetPlacementsRequest request;
  auto* const placement = request.add_placements();
  placement->set_shape_id("walk");
  placement->mutable_at()->set_x(3.0);
  const auto placements = PlacementsFromProto(request);
  ASSERT_TRUE(placements);
  EXPECT_EQ(placements->at("walk"), Point(3.0, 0.0));
}

TEST(Placements, RefuseAMissingPlaceAndAShapePlacedTwice) {
  v1::SetPlacementsRequest request;
  request.add_placements()->set_shape_id("walk");
  EXPECT_THAT(PlacementsFromProto(request),
              FailsWith(ErrorCode::kInvalidOption, "placements['walk'].at"));
  request.mutable_placements(0)->mutable_at();
  *request.add_placements() = request.placements(0);
  EXPECT_THAT(PlacementsFromProto(request),
              FailsWith(ErrorCode::kInvalidOption, "placements['walk']"));
}

TEST(BuildOptions, AreTheDefaultsWhereAbsent) {
  EXPECT_EQ(BuildRequestFromProto({})->tolerance, 0.03);
  EXPECT_EQ(BuildRequestFromProto({})->target_edge_length, 0.08);
  EXPECT_TRUE(BuildRequestFromProto({})->align);
  EXPECT_EQ(BuildRequestFromProto({})->rotation, Rotation::kUpright);
  EXPECT_EQ(BuildRequestFromProto({})->max_vertices, std::nullopt);
  v1::BuildOptions options;
  options.set_tolerance(0.05);
  options.set_target_edge_length(0.5);
  EXPECT_EQ(BuildRequestFromProto(options)->tolerance, 0.05);
  EXPECT_EQ(BuildRequestFromProto(options)->target_edge_length, 0.5);
  options.set_align(false);
  options.set_max_vertices(100);
  EXPECT_EQ(BuildRequestFromProto(options)->max_vertices, 100);
  EXPECT_FALSE(BuildRequestFromProto(options)->align);
  options.set_rotation(v1::ROTATION_ANY);
  EXPECT_EQ(BuildRequestFromProto(options)->rotation, Rotation::kAny);
  options.set_rotation(static_cast<v1::Rotation>(7));
  EXPECT_THAT(BuildRequestFromProto(options),
              FailsWith(ErrorCode::kInvalidOption, "options.rotation"));
}

TEST(SessionView, TravelsWhole) {
  SessionView view;
  view.id = "tux";
  view.labels = {{"k", "v"}};
  view.shape_ids = {"b", "a"};
  view.correspondences = {{{"a", Point(1, 2)}}};
  view.placements = {{"a", Point(0, 1)}, {"b", Point(2, 3)}};
  view.placements_are_default = false;
  view.etag = "7";
  view.created = std::chrono::system_clock::time_point(std::chrono::milliseconds(1'500));
  BuildStatus build;
  build.id = "one";
  build.state = BuildState::kFailed;
  build.sequence = 9;
  build.error = Error{ErrorCode::kOutlineNotSimple, "edges cross", {{"shapes['a']", "crosses"}}};
  view.build = build;

  v1::Session session;
  ToProto(view, &session);
  EXPECT_EQ(session.id(), "tux");
  EXPECT_EQ(session.labels().at("k"), "v");
  EXPECT_THAT(session.shape_ids(), ElementsAre("b", "a"));
  EXPECT_EQ(session.correspondences(0).points().at("a").y(), 2.0);
  ASSERT_EQ(session.placements_size(), 2);
  EXPECT_EQ(session.placements(0).shape_id(), "b");  // in the order of upload
  EXPECT_EQ(session.placements(0).at().x(), 2.0);
  EXPECT_FALSE(session.placements_are_default());
  EXPECT_EQ(session.create_time().seconds(), 1);
  EXPECT_EQ(session.create_time().nanos(), 500'000'000);
  EXPECT_EQ(session.build().state(), v1::BUILD_STATE_FAILED);
  EXPECT_EQ(session.build().sequence(), 9);
  EXPECT_EQ(session.build().error().reason(), "OUTLINE_SELF_INTERSECTS");
  EXPECT_THAT(session.build().error().fields(), ElementsAre("shapes['a']"));
}

}  // namespace
}  // namespace posespace
