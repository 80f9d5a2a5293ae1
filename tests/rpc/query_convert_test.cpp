// SPDX-License-Identifier: Apache-2.0
#include "rpc/query_convert.h"

#include <gmock/gmock.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "tests/rpc/sample_shapes.h"
#include "tests/support/fails_saying.h"
#include "tests/support/fails_with.h"

namespace posespace {
namespace {

using ::testing::ElementsAre;
using ::testing::Field;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

v1::Query At(double x, double y) {
  v1::Query query;
  query.mutable_at()->set_x(x);
  query.mutable_at()->set_y(y);
  return query;
}

std::shared_ptr<const PoseSpace> TwoEllipses() {
  BuildInputs inputs;
  for (const auto& [id, ring] :
       {std::pair("wide", EllipseOf(80, 40)), std::pair("tall", EllipseOf(40, 80))}) {
    auto drawing = std::make_shared<Drawing>();
    drawing->id = id;
    drawing->digest = id;
    drawing->outline = *OutlineFromRings(ring, {});
    drawing->texture = PaintRings(ring, {});
    inputs.drawings.push_back(std::move(drawing));
  }
  inputs.placements = (Points(2, 2) << 0, 0, 0, 1).finished();
  return *PoseSpace::Build(inputs);
}

TEST(Query, HasTheDefaultsOfTheContract) {
  const auto query = QueryFromProto(At(1, 2));
  ASSERT_TRUE(query);
  EXPECT_EQ(std::get<Point>(query->position), Point(1, 2));
  EXPECT_EQ(query->options.method, BlendMethod::kRigid);
  EXPECT_EQ(query->options.shear_limit, ShearLimit::kBand);
  EXPECT_EQ(query->options.refits, 3);
  EXPECT_EQ(query->sigma, 0.0);
}

TEST(Query, UsesTheShearLimitOfItsMethodUnlessTold) {
  v1::Query query = At(0, 0);
  query.mutable_options()->set_method(v1::BLEND_METHOD_PAPER);
  EXPECT_EQ(QueryFromProto(query)->options.shear_limit, ShearLimit::kHermite);
  query.mutable_options()->set_shear_limit(v1::SHEAR_LIMIT_OFF);
  EXPECT_EQ(QueryFromProto(query)->options.shear_limit, ShearLimit::kOff);
  query.mutable_options()->set_method(v1::BLEND_METHOD_LINEAR);
  EXPECT_EQ(QueryFromProto(query)->options.method, BlendMethod::kLinear);
}

TEST(Query, SaysHowStretchIsMixedAndWhetherToRepair) {
  v1::Query query = At(0, 0);
  EXPECT_EQ(QueryFromProto(query)->options.stretch, StretchBlend::kLinear);
  EXPECT_FALSE(QueryFromProto(query)->options.repair);
  for (const auto& [value, stretch] : {std::pair(v1::STRETCH_BLEND_LINEAR, StretchBlend::kLinear),
                                       {v1::STRETCH_BLEND_LOG, StretchBlend::kLog},
                                       {v1::STRETCH_BLEND_METRIC, StretchBlend::kMetric}}) {
    query.mutable_options()->set_stretch(value);
    EXPECT_EQ(QueryFromProto(query)->options.stretch, stretch);
  }
  query.mutable_options()->set_repair(true);
  EXPECT_TRUE(QueryFromProto(query)->options.repair);
}

TEST(Query, TakesAnAnchorInItsTriangleAndNowhereElse) {
  v1::Query query = At(0, 0);
  EXPECT_FALSE(QueryFromProto(query)->options.anchor);
  v1::MeshPoint& anchor = *query.mutable_options()->mutable_anchor();
  anchor.set_triangle(7);
  for (const auto& [b, c] : {std::pair(0.0, 0.0), {1.0, 0.0}, {0.0, 1.0}, {0.25, 0.5}}) {
    anchor.set_b(b);
    anchor.set_c(c);
    EXPECT_EQ(QueryFromProto(query)->options.anchor, (MeshPoint{7, b, c}));
  }
  for (const auto& [b, c] : {std::pair(-0.001, 0.5), {0.5, -0.001}, {0.5, 0.501}, {kNan, 0.0}}) {
    anchor.set_b(b);
    anchor.set_c(c);
    EXPECT_THAT(QueryFromProto(query), FailsSaying(ErrorCode::kInvalidOption, "options.anchor"));
  }
}

TEST(Query, IsRefusedForEnumsItDoesNotKnow) {
  v1::Query query = At(0, 0);
  query.mutable_options()->set_method(static_cast<v1::BlendMethod>(9));
  EXPECT_THAT(QueryFromProto(query), FailsSaying(ErrorCode::kInvalidOption, "options.method"));
  query.mutable_options()->clear_method();
  query.mutable_options()->set_shear_limit(static_cast<v1::ShearLimit>(-1));
  EXPECT_THAT(QueryFromProto(query), FailsSaying(ErrorCode::kInvalidOption, "options.shear_limit"));
  query.mutable_options()->clear_shear_limit();
  query.mutable_options()->set_stretch(static_cast<v1::StretchBlend>(4));
  EXPECT_THAT(QueryFromProto(query), FailsSaying(ErrorCode::kInvalidOption, "options.stretch"));
}

TEST(Query, TakesRefitsAndSigmaToTheEndsOfTheirRangesAndNoFarther) {
  v1::Query query = At(0, 0);
  for (const int refits : {0, 3}) {
    query.mutable_options()->set_refits(refits);
    EXPECT_EQ(QueryFromProto(query)->options.refits, refits);
  }
  for (const int refits : {-1, 4, std::numeric_limits<int>::max()}) {
    query.mutable_options()->set_refits(refits);
    EXPECT_THAT(QueryFromProto(query), FailsSaying(ErrorCode::kInvalidOption, "options.refits"));
  }
  query.mutable_options()->clear_refits();
  for (const double sigma : {0.0, 1.0}) {
    query.mutable_options()->set_sigma(sigma);
    EXPECT_EQ(QueryFromProto(query)->sigma, sigma);
  }
  for (const double sigma : {-0.001, 1.001, kNan}) {
    query.mutable_options()->set_sigma(sigma);
    EXPECT_THAT(QueryFromProto(query), FailsSaying(ErrorCode::kInvalidOption, "options.sigma"));
  }
}

TEST(Query, NeedsAFinitePosition) {
  EXPECT_THAT(QueryFromProto({}), FailsSaying(ErrorCode::kInvalidOption, "position"));
  EXPECT_THAT(QueryFromProto(At(0, kNan)), FailsWith(ErrorCode::kPoseNotFinite));
  EXPECT_THAT(QueryFromProto(At(HUGE_VAL, 0)), FailsWith(ErrorCode::kPoseNotFinite));
  v1::Query query;
  query.mutable_weights()->add_values(kNan);
  EXPECT_THAT(QueryFromProto(query), FailsWith(ErrorCode::kWeightsNotFinite));
}

TEST(BlendQuery, NamesTheQueryInEveryError) {
  const auto pose_space = TwoEllipses();
  v1::Query few, uneven;
  few.mutable_weights()->add_values(1.0);
  uneven.mutable_weights()->add_values(1.0);
  uneven.mutable_weights()->add_values(1.0);
  const auto blend = [&](const v1::Query& query) {
    return BlendQuery(*pose_space, query, "queries[3]", /*weights_only=*/false);
  };
  EXPECT_THAT(blend(few), FailsSaying(ErrorCode::kWeightsCountMismatch, "queries[3]"));
  EXPECT_THAT(blend(few).error().where,
              ElementsAre(Field(&Violation::field, "queries[3].weights")));
  EXPECT_THAT(blend(uneven), FailsSaying(ErrorCode::kWeightsSumNotOne, "queries[3]"));
  EXPECT_THAT(blend(At(kNan, 0)).error().where,
              ElementsAre(Field(&Violation::field, "queries[3].at")));
}

TEST(BlendQueries, KeepsEachAnswerAtItsPlaceAmongErrors) {
  const auto pose_space = TwoEllipses();
  std::vector<v1::Query> queries{At(0, 0.2), At(kNan, 0), At(0, 0.7), {}, At(0, 1)};
  queries[2].mutable_options()->set_refits(1);  // is solved apart from the others
  std::vector<NamedQuery> named;
  for (const v1::Query& query : queries)
    named.push_back({&query, QueryField(static_cast<int>(named.size()))});
  const auto frames = BlendQueries(*pose_space, named, /*weights_only=*/false);
  ASSERT_EQ(frames.size(), 5u);
  EXPECT_THAT(frames[1], FailsSaying(ErrorCode::kPoseNotFinite, "queries[1]"));
  EXPECT_THAT(frames[3], FailsSaying(ErrorCode::kInvalidOption, "queries[3]"));
  for (const int k : {0, 2, 4}) {
    ASSERT_TRUE(frames[k]);
    const auto alone = BlendQuery(*pose_space, queries[k], "query", /*weights_only=*/false);
    EXPECT_EQ(frames[k]->vertices, alone->vertices);
    EXPECT_EQ(frames[k]->weights, alone->weights);
  }
}

TEST(BlendQuery, GivesWeightsAloneWhenAsked) {
  const auto frame = BlendQuery(*TwoEllipses(), At(0, 1), "queries[0]", /*weights_only=*/true);
  ASSERT_TRUE(frame);
  EXPECT_EQ(frame->vertices.rows(), 0);
  EXPECT_NEAR(frame->weights(1), 1.0, 1e-9);
}

TEST(Frame, TravelsAsLittleEndianFloats) {
  Frame frame;
  frame.vertices = (FloatPoints(2, 2) << 1.5f, -2.0f, 1e30f, 0.0f).finished();
  frame.weights = Eigen::Vector2d(0.25, 0.75);
  frame.texture_weights = Eigen::Vector2d(0.5, 0.5);
  frame.folds = 3;
  frame.mended = 2;
  v1::Frame out;
  ToProto(frame, /*with_weights=*/false, &out);
  ASSERT_EQ(out.vertices().size(), 16u);
  EXPECT_EQ(out.vertices().substr(0, 8), std::string("\0\0\xc0\x3f\0\0\0\xc0", 8));
  EXPECT_EQ(out.folds(), 3);
  EXPECT_EQ(out.mended(), 2);
  EXPECT_EQ(out.weights_size(), 0);
  ToProto(frame, /*with_weights=*/true, &out);
  EXPECT_THAT(out.weights(), ElementsAre(0.25, 0.75));
  EXPECT_THAT(out.texture_weights(), ElementsAre(0.5, 0.5));
}

TEST(QueryCount, IsOneToTheLimit) {
  EXPECT_THAT(CheckQueryCount(0, 256), FailsWith(ErrorCode::kInvalidOption));
  EXPECT_TRUE(CheckQueryCount(1, 256));
  EXPECT_TRUE(CheckQueryCount(256, 256));
  EXPECT_THAT(CheckQueryCount(257, 256), FailsWith(ErrorCode::kTooManyQueries));
}

TEST(View, ShowsTheBoxOrThePoseSpacesOwn) {
  const auto pose_space = TwoEllipses();
  v1::RenderRequest request;
  request.set_width(100);
  request.set_height(50);
  ASSERT_TRUE(ViewFromProto(request, *pose_space, 4'096));
  request.mutable_view()->set_x(10);
  request.mutable_view()->set_width(20);
  request.mutable_view()->set_height(10);
  const auto view = ViewFromProto(request, *pose_space, 4'096);
  ASSERT_TRUE(view);
  EXPECT_DOUBLE_EQ(view->scale, 5.0);
  EXPECT_DOUBLE_EQ(view->origin.x(), 10.0);
}

TEST(View, HasCrispEdgesUnlessToldOtherwiseAndRefusesUnknownOnes) {
  EXPECT_EQ(EdgesFromProto(v1::EDGES_UNSPECIFIED).value(), PaintEdges::kCrisp);
  EXPECT_EQ(EdgesFromProto(v1::EDGES_CRISP).value(), PaintEdges::kCrisp);
  EXPECT_EQ(EdgesFromProto(v1::EDGES_SOFT).value(), PaintEdges::kSoft);
  EXPECT_THAT(EdgesFromProto(static_cast<v1::Edges>(7)), FailsWith(ErrorCode::kInvalidOption));
}

TEST(View, RefusesSizesFormatsAndBoxesThatCannotBe) {
  const auto pose_space = TwoEllipses();
  const auto refused = [&](auto&& change) {
    v1::RenderRequest request;
    request.set_width(16);
    request.set_height(16);
    EXPECT_TRUE(ViewFromProto(request, *pose_space, 64));
    change(request);
    EXPECT_THAT(ViewFromProto(request, *pose_space, 64), FailsWith(ErrorCode::kInvalidOption));
  };
  refused([](auto& request) { request.set_width(0); });
  refused([](auto& request) { request.set_width(-5); });
  refused([](auto& request) { request.set_height(65); });
  refused([](auto& request) { request.set_format(static_cast<v1::ImageFormat>(12)); });
  refused([](auto& request) { request.mutable_view(); });
  for (const double bad : {kNan, HUGE_VAL, -HUGE_VAL, 1e300}) {
    refused([&](auto& request) {
      request.mutable_view()->set_width(bad);
      request.mutable_view()->set_height(1);
    });
    refused([&](auto& request) {
      request.mutable_view()->set_y(bad);
      request.mutable_view()->set_width(1);
      request.mutable_view()->set_height(1);
    });
  }
}

}  // namespace
}  // namespace posespace
