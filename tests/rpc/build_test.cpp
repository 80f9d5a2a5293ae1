// SPDX-License-Identifier: Apache-2.0
#include <google/protobuf/util/message_differencer.h>

#include <algorithm>

#include "tests/rpc/service_fixture.h"

namespace posespace {
namespace {

using grpc::StatusCode;

class BuildTest : public ServiceTest {
 protected:
  // A session whose build takes a while: many drawings, a fine mesh.
  void DrawMany(const std::string& session) {
    Create(session);
    for (int k = 0; k < 24; ++k) {
      Put(PutImage(session, "pose" + std::to_string(k), PngOf(40 + 2 * k, 90 - 2 * k, kRed)));
    }
  }
  v1::StartBuildRequest Fine(const std::string& session, double tolerance = 0.002) {
    v1::StartBuildRequest request;
    request.set_session_id(session);
    request.mutable_options()->set_tolerance(tolerance);
    request.mutable_options()->set_target_edge_length(0.03);
    return request;
  }
};

TEST_F(BuildTest, IsFollowedFromItsBeginningToItsResult) {
  Create("tux");
  Draw("tux");
  StartBuild("tux");
  const auto events = Watch("tux");
  ASSERT_FALSE(events.empty());
  EXPECT_TRUE(std::is_sorted(events.begin(), events.end(), [](const auto& a, const auto& b) {
    return a.sequence() < b.sequence();
  }));
  EXPECT_TRUE(std::is_sorted(events.begin(), events.end(), [](const auto& a, const auto& b) {
    return a.fraction() < b.fraction();
  }));
  const v1::Build& last = events.back();
  EXPECT_EQ(last.state(), v1::BUILD_STATE_SUCCEEDED);
  EXPECT_EQ(last.fraction(), 1.0);
  EXPECT_GT(last.report().vertices(), 8);
  EXPECT_GT(last.report().triangles(), 8);
  EXPECT_GT(last.report().min_angle(), 0.0);
  EXPECT_EQ(last.report().confidence_size(), 2);
  EXPECT_EQ(last.report().levels_size(), 1);
  EXPECT_TRUE(last.report().seconds().contains("matching"));

  v1::GetSessionRequest get;
  get.set_session_id("tux");
  v1::GetSessionResponse got;
  ASSERT_THAT(client_.Call(&SessionStub::GetSession, get, &got), Succeeds());
  EXPECT_EQ(got.session().revision(), last.report().revision());
  EXPECT_TRUE(google::protobuf::util::MessageDifferencer::Equals(got.session().build(), last));
}

TEST_F(BuildTest, SameInputsReturnTheFinishedBuild) {
  const std::string revision = Built("tux");
  const v1::Build again = StartBuild("tux");
  EXPECT_EQ(again.state(), v1::BUILD_STATE_SUCCEEDED);
  EXPECT_EQ(again.report().revision(), revision);
}

TEST_F(BuildTest, AlignsInsidesUnlessToldNotToAndSaysWhatItGained) {
  // A disc with a spot that lies elsewhere in each drawing.
  const auto spotted = [](double x) {
    Image image = PictureOf(200, 200);
    PaintDisc(&image, 100, 100, 80, kRed);
    PaintDisc(&image, x, 100, 20, kWhite);
    const auto png = EncodePng(image);
    return std::string(png.begin(), png.end());
  };
  Create("dice");
  Put(PutImage("dice", "left", spotted(90)));
  Put(PutImage("dice", "right", spotted(110)));
  StartBuild("dice");
  const v1::BuildReport aligned = Watch("dice").back().report();
  EXPECT_GT(aligned.ghost_loss().before(), 0.1);
  EXPECT_LT(aligned.ghost_loss().after(), 0.5 * aligned.ghost_loss().before());
  ASSERT_EQ(aligned.ghost_losses_size(), 2);
  EXPECT_LT(aligned.ghost_losses().at("left").after(), aligned.ghost_losses().at("left").before());
  EXPECT_TRUE(aligned.seconds().contains("alignment"));

  v1::StartBuildRequest plain;
  plain.set_session_id("dice");
  plain.mutable_options()->set_align(false);
  v1::StartBuildResponse started;
  ASSERT_THAT(client_.Call(&SessionStub::StartBuild, plain, &started), Succeeds());
  const v1::BuildReport unaligned = Watch("dice").back().report();
  EXPECT_FALSE(unaligned.has_ghost_loss());
  EXPECT_EQ(unaligned.ghost_losses_size(), 0);
  EXPECT_FALSE(unaligned.seconds().contains("alignment"));
  EXPECT_NE(unaligned.revision(), aligned.revision());
}

TEST_F(BuildTest, AReconnectLosesAndRepeatsNothing) {
  Built("tux");
  const auto all = Watch("tux");
  ASSERT_FALSE(all.empty());
  const std::int64_t last = all.back().sequence();
  const auto rest = Watch("tux", last - 1);
  ASSERT_EQ(rest.size(), 1u);
  EXPECT_EQ(rest[0].state(), v1::BUILD_STATE_SUCCEEDED);
  EXPECT_TRUE(Watch("tux", last).empty());
  EXPECT_EQ(Watch("tux", last + 1'000).size(), 1u) << "a number of no build of this session";
}

TEST_F(BuildTest, NeedsDrawingsAndOptionsInRange) {
  Create("tux");
  v1::StartBuildRequest request;
  request.set_session_id("tux");
  v1::StartBuildResponse response;
  EXPECT_THAT(client_.Call(&SessionStub::StartBuild, request, &response),
              Refuses(StatusCode::FAILED_PRECONDITION, "NO_SHAPES"));
  request.mutable_options()->set_tolerance(0.5);
  const auto refused = client_.Call(&SessionStub::StartBuild, request, &response);
  EXPECT_THAT(refused, Refuses(StatusCode::INVALID_ARGUMENT, "INVALID_OPTION"));
  EXPECT_THAT(FieldsOf(refused), ::testing::ElementsAre("options.tolerance"));
}

TEST_F(BuildTest, CannotBeWatchedBeforeItWasStarted) {
  Create("tux");
  v1::WatchBuildRequest request;
  v1::WatchBuildResponse event;
  for (const auto& [id, reason] :
       {std::pair("tux", "BUILD_NOT_FOUND"), std::pair("nobody", "SESSION_NOT_FOUND")}) {
    request.set_session_id(id);
    const auto context = Client::Context();
    const auto reader = client_.sessions->WatchBuild(context.get(), request);
    EXPECT_FALSE(reader->Read(&event));
    EXPECT_THAT(reader->Finish(), Refuses(StatusCode::NOT_FOUND, reason));
  }
}

TEST_F(BuildTest, CancellingEndsItForEveryWatcher) {
  DrawMany("many");
  v1::StartBuildResponse started;
  ASSERT_THAT(client_.Call(&SessionStub::StartBuild, Fine("many"), &started), Succeeds());
  v1::WatchBuildRequest watch;
  watch.set_session_id("many");
  const auto context = Client::Context();
  const auto reader = client_.sessions->WatchBuild(context.get(), watch);
  v1::WatchBuildResponse event;
  ASSERT_TRUE(reader->Read(&event));

  v1::CancelBuildRequest cancel;
  cancel.set_session_id("many");
  v1::CancelBuildResponse cancelled;
  ASSERT_THAT(client_.Call(&SessionStub::CancelBuild, cancel, &cancelled), Succeeds());
  while (reader->Read(&event)) {
  }
  EXPECT_THAT(reader->Finish(), Succeeds());
  EXPECT_EQ(event.build().state(), v1::BUILD_STATE_CANCELLED);
  EXPECT_EQ(event.build().error().reason(), "CANCELLED");
}

TEST_F(BuildTest, SaysWhetherABuildWasThereAlreadyAndCancelsOnlyTheOneNamed) {
  DrawMany("many");
  v1::StartBuildResponse first, second;
  ASSERT_THAT(client_.Call(&SessionStub::StartBuild, Fine("many"), &first), Succeeds());
  ASSERT_THAT(client_.Call(&SessionStub::StartBuild, Fine("many"), &second), Succeeds());
  EXPECT_FALSE(first.attached());
  EXPECT_TRUE(second.attached());
  EXPECT_EQ(first.build().id(), second.build().id());

  v1::CancelBuildRequest cancel;
  cancel.set_session_id("many");
  cancel.set_build_id("another");
  v1::CancelBuildResponse response;
  ASSERT_THAT(client_.Call(&SessionStub::CancelBuild, cancel, &response), Succeeds());
  EXPECT_NE(response.build().state(), v1::BUILD_STATE_CANCELLED);
  cancel.set_build_id(first.build().id());
  ASSERT_THAT(client_.Call(&SessionStub::CancelBuild, cancel, &response), Succeeds());
  EXPECT_EQ(Watch("many").back().state(), v1::BUILD_STATE_CANCELLED);
}

TEST_F(BuildTest, CancellingWithoutABuildHasNoEffect) {
  Create("tux");
  v1::CancelBuildRequest cancel;
  cancel.set_session_id("tux");
  v1::CancelBuildResponse cancelled;
  ASSERT_THAT(client_.Call(&SessionStub::CancelBuild, cancel, &cancelled), Succeeds());
  EXPECT_FALSE(cancelled.has_build());
}

TEST_F(BuildTest, OtherInputsReplaceARunningBuild) {
  DrawMany("many");
  v1::StartBuildResponse first, second;
  ASSERT_THAT(client_.Call(&SessionStub::StartBuild, Fine("many"), &first), Succeeds());
  v1::WatchBuildRequest watch;
  watch.set_session_id("many");
  const auto context = Client::Context();
  const auto reader = client_.sessions->WatchBuild(context.get(), watch);
  v1::WatchBuildResponse event;
  ASSERT_TRUE(reader->Read(&event));
  ASSERT_THAT(client_.Call(&SessionStub::StartBuild, Fine("many", 0.1), &second), Succeeds());
  EXPECT_NE(first.build().id(), second.build().id());
  while (reader->Read(&event)) {
  }
  EXPECT_THAT(reader->Finish(), Succeeds());
  EXPECT_EQ(event.build().id(), first.build().id());
  EXPECT_EQ(event.build().state(), v1::BUILD_STATE_CANCELLED);
}

TEST_F(BuildTest, WatchersThatVanishHarmNobody) {
  DrawMany("many");
  v1::StartBuildResponse started;
  ASSERT_THAT(client_.Call(&SessionStub::StartBuild, Fine("many"), &started), Succeeds());
  v1::WatchBuildRequest watch;
  watch.set_session_id("many");
  for (int k = 0; k < 20; ++k) {
    const auto context = Client::Context();
    const auto reader = client_.sessions->WatchBuild(context.get(), watch);
    v1::WatchBuildResponse event;
    if (k % 2 == 0) reader->Read(&event);
    context->TryCancel();
    while (reader->Read(&event)) {
    }
    reader->Finish();
  }
  v1::DeleteSessionRequest drop;
  drop.set_session_id("many");
  v1::DeleteSessionResponse dropped;
  EXPECT_THAT(client_.Call(&SessionStub::DeleteSession, drop, &dropped), Succeeds());
  Built("tux");
}

TEST_F(BuildTest, MovingPlacementsGivesANewRevisionOfTheSameMesh) {
  const std::string before = Built("tux");
  const v1::Session moved = Place("tux", 2.0);
  EXPECT_NE(moved.revision(), before);
  v1::GetMeshRequest request;
  request.set_session_id("tux");
  request.set_revision(moved.revision());
  v1::GetMeshResponse response;
  EXPECT_THAT(client_.Call(&PoseStub::GetMesh, request, &response), Succeeds());
  request.set_revision(before);
  EXPECT_THAT(client_.Call(&PoseStub::GetMesh, request, &response),
              Refuses(StatusCode::NOT_FOUND, "REVISION_NOT_FOUND"));
}

}  // namespace
}  // namespace posespace
