// SPDX-License-Identifier: Apache-2.0
#include "tests/rpc/service_fixture.h"

namespace posespace {
namespace {

using grpc::StatusCode;

class SuggestTest : public ServiceTest {
 protected:
  explicit SuggestTest(const Limits& limits = {}) : ServiceTest(limits) {}

  grpc::Status Suggest(const std::string& session) {
    v1::SuggestCorrespondencesRequest request;
    request.set_session_id(session);
    response_.Clear();
    return client_.Call(&SessionStub::SuggestCorrespondences, request, &response_);
  }

  v1::SuggestCorrespondencesResponse response_;
};

TEST_F(SuggestTest, ShowsTheSamePlacesInTheOrderOfUpload) {
  const v1::Session empty = Create("tux");
  Draw("tux");
  ASSERT_THAT(Suggest("tux"), Succeeds());
  ASSERT_EQ(response_.shapes_size(), 2);
  EXPECT_EQ(response_.shapes(0).shape_id(), "wide");
  EXPECT_EQ(response_.shapes(1).shape_id(), "tall");
  for (const v1::ShapeSuggestion& shape : response_.shapes()) {
    EXPECT_EQ(shape.arc().coordinates_size(), 2 * 64);
    EXPECT_GT(shape.confidence(), 0.0);
    EXPECT_FALSE(shape.flip());
  }
  EXPECT_EQ(response_.flip_gain(), 1.0);
  EXPECT_NE(response_.etag(), empty.etag());
}

TEST_F(SuggestTest, RefusesWhatCannotBeMatched) {
  EXPECT_THAT(Suggest("nobody"), Refuses(StatusCode::NOT_FOUND, "SESSION_NOT_FOUND"));
  Create("empty");
  EXPECT_THAT(Suggest("empty"), Refuses(StatusCode::FAILED_PRECONDITION, "NO_SHAPES"));
}

TEST_F(SuggestTest, AnswersNobodyOnceTheServiceEnds) {
  Create("tux");
  Draw("tux");
  server_->BeginDrain(std::chrono::milliseconds(0));
  EXPECT_THAT(Suggest("tux"), Refuses(StatusCode::UNAVAILABLE, "DRAINING"));
}

class HurriedSuggestTest : public SuggestTest {
 protected:
  HurriedSuggestTest() : SuggestTest({.build_timeout = std::chrono::seconds(0)}) {}
};

TEST_F(HurriedSuggestTest, TakesNoLongerThanABuildMay) {
  Create("tux");
  Draw("tux");
  EXPECT_THAT(Suggest("tux"), Refuses(StatusCode::DEADLINE_EXCEEDED, "BUILD_TIMEOUT"));
}

}  // namespace
}  // namespace posespace
