// SPDX-License-Identifier: Apache-2.0
#include <limits>

#include "tests/rpc/service_fixture.h"

namespace posespace {
namespace {

using grpc::StatusCode;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class SessionServiceTest : public ServiceTest {};

TEST_F(SessionServiceTest, MakesFindsListsAndForgetsSessions) {
  v1::CreateSessionRequest create;
  create.set_session_id("tux");
  create.set_display_name("Tux");
  (*create.mutable_labels())["team"] = "penguins";
  v1::CreateSessionResponse created;
  ASSERT_THAT(client_.Call(&SessionStub::CreateSession, create, &created), Succeeds());
  EXPECT_EQ(created.session().id(), "tux");
  EXPECT_EQ(created.session().display_name(), "Tux");
  EXPECT_EQ(created.session().labels().at("team"), "penguins");
  EXPECT_GT(created.session().create_time().seconds(), 0);
  EXPECT_FALSE(created.session().has_build());
  Create("anna");

  v1::ListSessionsRequest list;
  list.set_page_size(1);
  v1::ListSessionsResponse page;
  ASSERT_THAT(client_.Call(&SessionStub::ListSessions, list, &page), Succeeds());
  ASSERT_EQ(page.sessions_size(), 1);
  EXPECT_EQ(page.sessions(0).id(), "anna");
  list.set_page_token(page.next_page_token());
  page.Clear();
  ASSERT_THAT(client_.Call(&SessionStub::ListSessions, list, &page), Succeeds());
  EXPECT_EQ(page.sessions(0).id(), "tux");
  EXPECT_EQ(page.next_page_token(), "");

  v1::DeleteSessionRequest drop;
  drop.set_session_id("tux");
  drop.set_etag("stale");
  v1::DeleteSessionResponse dropped;
  EXPECT_THAT(client_.Call(&SessionStub::DeleteSession, drop, &dropped),
              Refuses(StatusCode::ABORTED, "ETAG_MISMATCH"));
  drop.set_etag(created.session().etag());
  EXPECT_THAT(client_.Call(&SessionStub::DeleteSession, drop, &dropped), Succeeds());
  EXPECT_THAT(client_.Call(&SessionStub::DeleteSession, drop, &dropped),
              Refuses(StatusCode::NOT_FOUND, "SESSION_NOT_FOUND"));
  drop.set_allow_missing(true);
  EXPECT_THAT(client_.Call(&SessionStub::DeleteSession, drop, &dropped), Succeeds());
}

TEST_F(SessionServiceTest, RefusesATakenIdUnlessItIsARetry) {
  v1::CreateSessionRequest request;
  request.set_session_id("tux");
  request.set_request_id("first");
  v1::CreateSessionResponse response;
  ASSERT_THAT(client_.Call(&SessionStub::CreateSession, request, &response), Succeeds());
  EXPECT_THAT(client_.Call(&SessionStub::CreateSession, request, &response), Succeeds());
  request.set_request_id("second");
  EXPECT_THAT(client_.Call(&SessionStub::CreateSession, request, &response),
              Refuses(StatusCode::ALREADY_EXISTS, "SESSION_EXISTS"));
}

TEST_F(SessionServiceTest, ChoosesUnguessableIds) {
  const std::string one = Create("").id(), other = Create("").id();
  EXPECT_GE(one.size(), 16u);
  EXPECT_NE(one, other);
}

TEST_F(SessionServiceTest, RefusesBadIdsPagesAndLabels) {
  v1::CreateSessionRequest create;
  v1::CreateSessionResponse created;
  for (const std::string id : {"-tux", "a b", "ünder", "../etc"}) {
    create.set_session_id(id);
    EXPECT_THAT(client_.Call(&SessionStub::CreateSession, create, &created),
                Refuses(StatusCode::INVALID_ARGUMENT, "INVALID_ID"));
  }
  create.set_session_id("good");
  (*create.mutable_labels())["k"] = std::string(257, 'v');
  EXPECT_THAT(client_.Call(&SessionStub::CreateSession, create, &created),
              Refuses(StatusCode::INVALID_ARGUMENT, "INVALID_OPTION"));
  v1::ListSessionsRequest list;
  v1::ListSessionsResponse page;
  for (const int size : {-1, 1'001, std::numeric_limits<int>::min()}) {
    list.set_page_size(size);
    EXPECT_THAT(client_.Call(&SessionStub::ListSessions, list, &page),
                Refuses(StatusCode::INVALID_ARGUMENT, "INVALID_OPTION"));
  }
  v1::GetSessionRequest get;
  v1::GetSessionResponse got;
  EXPECT_THAT(client_.Call(&SessionStub::GetSession, get, &got),
              Refuses(StatusCode::INVALID_ARGUMENT, "INVALID_ID"));
}

TEST_F(SessionServiceTest, SaysHowADrawingWasUnderstood) {
  Create("tux");
  const v1::Shape shape = Put(PutImage("tux", "wide", PngOf(80, 40, kRed)));
  EXPECT_EQ(shape.id(), "wide");
  EXPECT_EQ(shape.width(), 200);
  EXPECT_EQ(shape.height(), 200);
  ASSERT_EQ(shape.outline_size(), 1);
  EXPECT_GE(shape.outline(0).coordinates_size(), 2 * 8);
  EXPECT_EQ(shape.texture().width(), 200);
  EXPECT_EQ(shape.texture().scale(), 1.0);

  v1::GetShapeRequest get;
  get.set_session_id("tux");
  get.set_shape_id("wide");
  v1::GetShapeResponse got;
  ASSERT_THAT(client_.Call(&SessionStub::GetShape, get, &got), Succeeds());
  EXPECT_EQ(got.shape().SerializeAsString(), shape.SerializeAsString());
  v1::ListShapesRequest list;
  list.set_session_id("tux");
  v1::ListShapesResponse listed;
  ASSERT_THAT(client_.Call(&SessionStub::ListShapes, list, &listed), Succeeds());
  ASSERT_EQ(listed.shapes_size(), 1);
  EXPECT_EQ(listed.shapes(0).SerializeAsString(), shape.SerializeAsString());
}

TEST_F(SessionServiceTest, ReplacesADrawingOnlyWhenTold) {
  Create("tux");
  auto request = PutImage("tux", "wide", PngOf(80, 40, kRed));
  v1::PutShapeResponse first, response;
  ASSERT_THAT(client_.Call(&SessionStub::PutShape, request, &first), Succeeds());
  ASSERT_THAT(client_.Call(&SessionStub::PutShape, request, &response), Succeeds());
  EXPECT_EQ(response.etag(), first.etag()) << "the same drawing again changes nothing";
  request.mutable_image()->set_data(PngOf(70, 40, kRed));
  EXPECT_THAT(client_.Call(&SessionStub::PutShape, request, &response),
              Refuses(StatusCode::ALREADY_EXISTS, "SHAPE_EXISTS"));
  request.set_replace(true);
  ASSERT_THAT(client_.Call(&SessionStub::PutShape, request, &response), Succeeds());
  EXPECT_NE(response.etag(), first.etag());
}

TEST_F(SessionServiceTest, RefusesDrawingsThatCannotBeUsed) {
  Create("tux");
  v1::PutShapeResponse response;
  v1::PutShapeRequest nothing;
  nothing.set_session_id("tux");
  nothing.set_shape_id("walk");
  EXPECT_THAT(client_.Call(&SessionStub::PutShape, nothing, &response),
              Refuses(StatusCode::INVALID_ARGUMENT, "SHAPE_SOURCE_MISSING"));
  EXPECT_THAT(client_.Call(&SessionStub::PutShape, PutImage("tux", "walk", "GIF89a"), &response),
              Refuses(StatusCode::INVALID_ARGUMENT, "IMAGE_UNDECODABLE"));
  const auto clear = client_.Call(&SessionStub::PutShape,
                                  PutImage("tux", "walk", PngOf(80, 40, kClear)), &response);
  EXPECT_THAT(clear, Refuses(StatusCode::INVALID_ARGUMENT, "OUTLINE_EMPTY"));
  EXPECT_THAT(clear.error_message(), HasSubstr("walk"));
  v1::PutShapeRequest pierced;  // its hole reaches beyond it
  pierced.set_session_id("tux");
  pierced.set_shape_id("walk");
  for (const double c : {0., 0., 10., 0., 10., 10., 0., 10.}) {
    pierced.mutable_polygon()->mutable_outer()->add_coordinates(c);
  }
  for (const double c : {5., 5., 15., 5., 5., 8.}) {
    if (pierced.polygon().holes().empty()) pierced.mutable_polygon()->add_holes();
    pierced.mutable_polygon()->mutable_holes(0)->add_coordinates(c);
  }
  EXPECT_THAT(client_.Call(&SessionStub::PutShape, pierced, &response),
              Refuses(StatusCode::INVALID_ARGUMENT, "OUTLINE_SELF_INTERSECTS"));
}

TEST_F(SessionServiceTest, RemovesADrawing) {
  Create("tux");
  Draw("tux");
  v1::DeleteShapeRequest drop;
  drop.set_session_id("tux");
  drop.set_shape_id("wide");
  v1::DeleteShapeResponse dropped;
  ASSERT_THAT(client_.Call(&SessionStub::DeleteShape, drop, &dropped), Succeeds());
  EXPECT_THAT(client_.Call(&SessionStub::DeleteShape, drop, &dropped),
              Refuses(StatusCode::NOT_FOUND, "SHAPE_NOT_FOUND"));
  v1::GetSessionRequest get;
  get.set_session_id("tux");
  v1::GetSessionResponse got;
  ASSERT_THAT(client_.Call(&SessionStub::GetSession, get, &got), Succeeds());
  EXPECT_THAT(got.session().shape_ids(), ElementsAre("tall"));
}

TEST_F(SessionServiceTest, KeepsCorrespondencesAndNamesEveryOneAtFault) {
  Create("tux");
  Draw("tux");
  v1::SetCorrespondencesRequest request;
  request.set_session_id("tux");
  auto& points = *request.add_tuples()->mutable_points();
  points["wide"].set_x(20);
  points["wide"].set_y(100);
  points["tall"].set_x(60);
  points["tall"].set_y(100);
  v1::SetCorrespondencesResponse response;
  ASSERT_THAT(client_.Call(&SessionStub::SetCorrespondences, request, &response), Succeeds());
  ASSERT_EQ(response.session().correspondences_size(), 1);
  EXPECT_EQ(response.session().correspondences(0).points().at("tall").x(), 60);

  for (int k = 0; k < 2; ++k) {
    (*request.add_tuples()->mutable_points())["wide"].set_x(-1'000);
  }
  const auto far = client_.Call(&SessionStub::SetCorrespondences, request, &response);
  EXPECT_THAT(far, Refuses(StatusCode::INVALID_ARGUMENT, "LANDMARK_OFF_OUTLINE"));
  EXPECT_THAT(FieldsOf(far), ElementsAre("tuples[1].points['wide']", "tuples[2].points['wide']"));
  request.mutable_tuples()->DeleteSubrange(1, 2);
  request.set_etag("stale");
  EXPECT_THAT(client_.Call(&SessionStub::SetCorrespondences, request, &response),
              Refuses(StatusCode::ABORTED, "ETAG_MISMATCH"));
}

TEST_F(SessionServiceTest, RefusesPlacementsThatCoincide) {
  Create("tux");
  Draw("tux");
  v1::SetPlacementsRequest request;
  request.set_session_id("tux");
  for (const std::string id : {"wide", "tall"}) {
    request.add_placements()->set_shape_id(id);
    request.mutable_placements(request.placements_size() - 1)->mutable_at();
  }
  v1::SetPlacementsResponse response;
  EXPECT_THAT(client_.Call(&SessionStub::SetPlacements, request, &response),
              Refuses(StatusCode::INVALID_ARGUMENT, "PLACEMENTS_COINCIDE"));
}

// Limits that a test can reach.
class SmallLimitsTest : public ServiceTest {
 protected:
  static Limits Small() {
    Limits limits;
    limits.max_sessions = 2;
    limits.max_shapes = 1;
    limits.max_image_pixels = 150 * 150;
    limits.max_request_bytes = 100'000;
    return limits;
  }
  SmallLimitsTest() : ServiceTest(Small()) {}
};

TEST_F(SmallLimitsTest, AreHeldOnBothSides) {
  Create("a");
  Create("b");
  v1::CreateSessionRequest create;
  v1::CreateSessionResponse created;
  EXPECT_THAT(client_.Call(&SessionStub::CreateSession, create, &created),
              Refuses(StatusCode::RESOURCE_EXHAUSTED, "SESSION_LIMIT"));

  v1::PutShapeResponse response;
  EXPECT_THAT(
      client_.Call(&SessionStub::PutShape, PutImage("a", "large", PngOf(80, 40, kRed)), &response),
      Refuses(StatusCode::INVALID_ARGUMENT, "IMAGE_TOO_LARGE"));
  EXPECT_EQ(
      client_
          .Call(&SessionStub::PutShape, PutImage("a", "long", std::string(100'001, 'x')), &response)
          .error_code(),
      StatusCode::RESOURCE_EXHAUSTED);

  v1::PutShapeRequest polygon;
  polygon.set_session_id("a");
  polygon.set_shape_id("one");
  const Points ring = EllipseOf(80, 40);
  polygon.mutable_polygon()->mutable_outer()->mutable_coordinates()->Assign(
      ring.data(), ring.data() + ring.size());
  ASSERT_THAT(client_.Call(&SessionStub::PutShape, polygon, &response), Succeeds());
  polygon.set_shape_id("two");
  EXPECT_THAT(client_.Call(&SessionStub::PutShape, polygon, &response),
              Refuses(StatusCode::INVALID_ARGUMENT, "TOO_MANY_SHAPES"));
}

}  // namespace
}  // namespace posespace
