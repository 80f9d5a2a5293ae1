// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <limits>
#include <thread>

#include "drawing/decode.h"
#include "tests/rpc/service_fixture.h"

namespace posespace {
namespace {

using grpc::StatusCode;
using ::testing::ElementsAre;

class PoseServiceTest : public ServiceTest {
 protected:
  using ServiceTest::ServiceTest;

  v1::Mesh Mesh(const std::string& session) {
    v1::GetMeshRequest request;
    request.set_session_id(session);
    v1::GetMeshResponse response;
    EXPECT_THAT(client_.Call(&PoseStub::GetMesh, request, &response), Succeeds());
    return response.mesh();
  }

  static v1::PlayRequest Bind(std::uint32_t slot, const std::string& session) {
    v1::PlayRequest request;
    request.mutable_bind()->set_slot(slot);
    request.mutable_bind()->set_session_id(session);
    return request;
  }

  static v1::PlayRequest Tick(std::uint64_t frame_id, std::uint32_t slot, int items,
                              double y = 0.5) {
    v1::PlayRequest request;
    request.mutable_tick()->set_frame_id(frame_id);
    for (int k = 0; k < items; ++k) {
      auto* const item = request.mutable_tick()->add_items();
      item->set_slot(slot);
      item->set_tag(static_cast<std::uint32_t>(k));
      item->mutable_query()->mutable_at()->set_y(y);
    }
    return request;
  }
};

using PlayCall = grpc::ClientReaderWriter<v1::PlayRequest, v1::PlayResponse>;

// The next message that is no heartbeat.
v1::PlayResponse Next(PlayCall& call) {
  v1::PlayResponse response;
  while (call.Read(&response)) {
    if (!response.has_heartbeat()) return response;
  }
  ADD_FAILURE() << "the stream has ended";
  return {};
}

TEST_F(PoseServiceTest, GivesAMeshWhoseTrianglesArePositiveInEveryPose) {
  const std::string revision = Built("tux");
  const v1::Mesh mesh = Mesh("tux");
  EXPECT_EQ(mesh.revision(), revision);
  ASSERT_EQ(mesh.poses_size(), 2);
  EXPECT_EQ(mesh.poses(0).shape_id(), "wide");
  EXPECT_EQ(mesh.triangles_size(), 3 * mesh.report().triangles());
  for (const v1::PoseMesh& pose : mesh.poses()) {
    ASSERT_EQ(pose.vertices_size(), 2 * mesh.report().vertices());
    EXPECT_EQ(pose.outlines_size(), 1);
    EXPECT_EQ(pose.texture().width(), 200);
    const Points points =
        Eigen::Map<const Points>(pose.vertices().data(), pose.vertices_size() / 2, 2);
    for (int t = 0; t < mesh.triangles_size(); t += 3) {
      const Point a = points.row(mesh.triangles(t)), b = points.row(mesh.triangles(t + 1)),
                  c = points.row(mesh.triangles(t + 2));
      EXPECT_GT(Cross(a, b, c), 0.0);
    }
  }
  ASSERT_EQ(mesh.boundary_size(), 1);
}

TEST_F(PoseServiceTest, GivesTexturesAsPng) {
  Built("tux");
  v1::GetTextureRequest request;
  request.set_session_id("tux");
  request.set_shape_id("tall");
  v1::GetTextureResponse response;
  ASSERT_THAT(client_.Call(&PoseStub::GetTexture, request, &response), Succeeds());
  const auto image = DecodeImage(
      {reinterpret_cast<const std::uint8_t*>(response.png().data()), response.png().size()});
  ASSERT_TRUE(image);
  EXPECT_EQ(image->width, 200);
  EXPECT_EQ(image->at(100, 100)[2], 255) << "blue";
  EXPECT_EQ(response.placement().height(), 200);
  request.set_shape_id("nobody");
  EXPECT_THAT(client_.Call(&PoseStub::GetTexture, request, &response),
              Refuses(StatusCode::NOT_FOUND, "SHAPE_NOT_FOUND"));
}

TEST_F(PoseServiceTest, BlendsToEachPoseAtItsPlace) {
  const std::string revision = Built("tux");
  const v1::Mesh mesh = Mesh("tux");
  v1::BlendResponse response;
  ASSERT_THAT(client_.Call(&PoseStub::Blend, BlendAt("tux", {0.0, 1.0, 0.5}), &response),
              Succeeds());
  EXPECT_EQ(response.revision(), revision);
  ASSERT_EQ(response.frames_size(), 3);
  for (int k = 0; k < 2; ++k) {
    const auto& pose = mesh.poses(k).vertices();
    const Points expected = Eigen::Map<const Points>(pose.data(), pose.size() / 2, 2);
    EXPECT_LT((VerticesOf(response.frames(k)) - expected).cwiseAbs().maxCoeff(), 1e-3);
    EXPECT_NEAR(response.frames(k).weights(k), 1.0, 1e-9);
    EXPECT_EQ(response.frames(k).folds(), 0);
  }
  EXPECT_NEAR(response.frames(2).weights(0) + response.frames(2).weights(1), 1.0, 1e-9);
}

TEST_F(PoseServiceTest, GivesTheSameFramesOneByOneAndTogether) {
  Built("tux");
  v1::BlendResponse together, single;
  const std::vector<double> places = {-1.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 3.0};
  ASSERT_THAT(client_.Call(&PoseStub::Blend, BlendAt("tux", places), &together), Succeeds());
  for (std::size_t k = 0; k < places.size(); ++k) {
    ASSERT_THAT(client_.Call(&PoseStub::Blend, BlendAt("tux", {places[k]}), &single), Succeeds());
    EXPECT_EQ(single.frames(0).SerializeAsString(),
              together.frames(static_cast<int>(k)).SerializeAsString());
  }
}

TEST_F(PoseServiceTest, LeavesVerticesOutWhenOnlyWeightsAreWanted) {
  Built("tux");
  auto request = BlendAt("tux", {0.0, 0.5});
  request.set_weights_only(true);
  v1::BlendResponse response;
  ASSERT_THAT(client_.Call(&PoseStub::Blend, request, &response), Succeeds());
  EXPECT_EQ(response.frames(1).vertices().size(), 0u);
  EXPECT_EQ(response.frames(1).weights_size(), 2);
}

TEST_F(PoseServiceTest, NamesTheQueryAtFaultAndBlendsNone) {
  Built("tux");
  auto request = BlendAt("tux", {0.0, 0.1, 0.2, std::numeric_limits<double>::quiet_NaN()});
  v1::BlendResponse response;
  const auto refused = client_.Call(&PoseStub::Blend, request, &response);
  EXPECT_THAT(refused, Refuses(StatusCode::INVALID_ARGUMENT, "POSE_NOT_FINITE"));
  EXPECT_THAT(FieldsOf(refused), ElementsAre("queries[3].at"));
  EXPECT_EQ(response.frames_size(), 0);
}

TEST_F(PoseServiceTest, RefusesWhatCannotBeBlended) {
  Built("tux");
  Create("raw");
  v1::BlendResponse response;
  EXPECT_THAT(client_.Call(&PoseStub::Blend, BlendAt("nobody", {0.0}), &response),
              Refuses(StatusCode::NOT_FOUND, "SESSION_NOT_FOUND"));
  EXPECT_THAT(client_.Call(&PoseStub::Blend, BlendAt("raw", {0.0}), &response),
              Refuses(StatusCode::FAILED_PRECONDITION, "SESSION_NOT_BUILT"));
  EXPECT_THAT(client_.Call(&PoseStub::Blend, BlendAt("tux", {}), &response),
              Refuses(StatusCode::INVALID_ARGUMENT, "INVALID_OPTION"));
  EXPECT_THAT(client_.Call(&PoseStub::Blend, BlendAt("tux", std::vector<double>(257)), &response),
              Refuses(StatusCode::INVALID_ARGUMENT, "TOO_MANY_QUERIES"));
  EXPECT_THAT(client_.Call(&PoseStub::Blend, BlendAt("tux", std::vector<double>(256)), &response),
              Succeeds());
  auto other = BlendAt("tux", {0.0});
  other.set_revision("another");
  EXPECT_THAT(client_.Call(&PoseStub::Blend, other, &response),
              Refuses(StatusCode::NOT_FOUND, "REVISION_NOT_FOUND"));
}

TEST_F(PoseServiceTest, PlaysWhatBlendGives) {
  Built("tux");
  v1::BlendResponse blended;
  ASSERT_THAT(client_.Call(&PoseStub::Blend, BlendAt("tux", {0.3}), &blended), Succeeds());

  const auto context = Client::Context();
  const auto call = client_.poses->Play(context.get());
  EXPECT_EQ(Next(*call).welcome().max_items(), 256u);
  ASSERT_TRUE(call->Write(Bind(3, "tux")));
  EXPECT_EQ(Next(*call).bound().reason(), "");
  for (int k = 0; k < 50; ++k) {
    ASSERT_TRUE(call->Write(Tick(k, 3, 1 + k, 0.3)));
    const auto result = Next(*call).frame_result();
    EXPECT_EQ(result.frame_id(), static_cast<std::uint64_t>(k));
    ASSERT_EQ(result.items_size(), 1 + k);
    EXPECT_EQ(result.items(k).frame().vertices(), blended.frames(0).vertices());
  }
  call->WritesDone();
  v1::PlayResponse rest;
  EXPECT_FALSE(call->Read(&rest));
  EXPECT_THAT(call->Finish(), Succeeds());
}

TEST_F(PoseServiceTest, PlayAnswersInOrderHoweverFastItIsAsked) {
  Built("tux");
  const auto context = Client::Context();
  const auto call = client_.poses->Play(context.get());
  call->Write(Bind(0, "tux"));
  constexpr int kFrames = 400;
  std::thread writer([&] {
    for (int k = 0; k < kFrames; ++k) call->Write(Tick(k, 0, k % 7 == 0 ? 40 : 1));
    call->WritesDone();
  });
  Next(*call);
  Next(*call);
  for (int k = 0; k < kFrames; ++k) {
    ASSERT_EQ(Next(*call).frame_result().frame_id(), static_cast<std::uint64_t>(k));
  }
  writer.join();
  EXPECT_THAT(call->Finish(), Succeeds());
}

TEST_F(PoseServiceTest, PlayEndsByAProtocolBreach) {
  const auto context = Client::Context();
  const auto call = client_.poses->Play(context.get());
  Next(*call);
  call->Write({});
  v1::PlayResponse rest;
  EXPECT_FALSE(call->Read(&rest));
  EXPECT_THAT(call->Finish(), Refuses(StatusCode::INVALID_ARGUMENT, "PROTOCOL_BREACH"));
}

TEST_F(PoseServiceTest, ASlowReaderCostsOnlyItself) {
  Built("tux");
  Client slow_client(server_->address());
  const auto slow_context = Client::Context();
  const auto slow = slow_client.poses->Play(slow_context.get());
  slow->Write(Bind(0, "tux"));
  std::thread writer([&] {  // stuck once the stream's credits and the transport are full
    for (int k = 0; k < 2'000 && slow->Write(Tick(k, 0, 256)); ++k) {
    }
  });
  const auto context = Client::Context();
  const auto call = client_.poses->Play(context.get());
  Next(*call);
  call->Write(Bind(0, "tux"));
  Next(*call);
  for (int k = 0; k < 100; ++k) {
    call->Write(Tick(k, 0, 1));
    ASSERT_EQ(Next(*call).frame_result().frame_id(), static_cast<std::uint64_t>(k));
  }
  slow_context->TryCancel();
  writer.join();
  EXPECT_FALSE(slow->Finish().ok());
}

TEST_F(PoseServiceTest, ClientsThatVanishMidStreamLeaveNothingBehind) {
  Built("tux");
  for (int k = 0; k < 30; ++k) {
    Client vanishing(server_->address());
    const auto context = Client::Context();
    const auto call = vanishing.poses->Play(context.get());
    call->Write(Bind(0, "tux"));
    for (int frame = 0; frame < k % 5; ++frame) call->Write(Tick(frame, 0, 64));
    if (k % 3 == 0) Next(*call);
    context->TryCancel();
    call->Finish();
  }
  while (server_->open_streams() > 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  v1::BlendResponse response;
  EXPECT_THAT(client_.Call(&PoseStub::Blend, BlendAt("tux", {0.5}), &response), Succeeds());
}

TEST_F(PoseServiceTest, RendersPicturesInOrder) {
  const std::string revision = Built("tux");
  v1::RenderRequest request;
  request.set_session_id("tux");
  for (const double y : {0.0, 0.25, 0.5, 0.75, 1.0}) {
    request.add_queries()->mutable_at()->set_y(y);
  }
  request.set_width(64);
  request.set_height(48);
  for (const auto format : {v1::IMAGE_FORMAT_UNSPECIFIED, v1::IMAGE_FORMAT_RGBA}) {
    request.set_format(format);
    const auto context = Client::Context();
    const auto reader = client_.poses->Render(context.get(), request);
    int count = 0;
    for (v1::RenderResponse picture; reader->Read(&picture); ++count) {
      EXPECT_EQ(picture.index(), count);
      EXPECT_EQ(picture.revision(), revision);
      EXPECT_EQ(picture.frame().vertices().size(), 0u);
      EXPECT_EQ(picture.frame().weights_size(), 2);
      std::vector<std::uint8_t> rgba(picture.image().begin(), picture.image().end());
      if (format != v1::IMAGE_FORMAT_RGBA) rgba = DecodeImage(rgba).value().rgba;
      ASSERT_EQ(rgba.size(), 64u * 48u * 4u);
      EXPECT_EQ(rgba[3], 0) << "clear in the corner";
      const std::uint8_t* const centre = &rgba[4 * (24 * 64 + 32)];
      EXPECT_EQ(centre[3], 255) << "painted in the middle";
      if (count == 0) {
        EXPECT_EQ(centre[0], 255) << "red at the first pose";
      }
      if (count == 4) {
        EXPECT_EQ(centre[2], 255) << "blue at the second";
      }
    }
    EXPECT_EQ(count, 5);
    EXPECT_THAT(reader->Finish(), Succeeds());
  }
}

TEST_F(PoseServiceTest, RefusesToRenderBeforeTheFirstPicture) {
  Built("tux");
  v1::RenderRequest request;
  request.set_session_id("tux");
  request.add_queries()->mutable_at();
  request.add_queries();
  request.set_width(64);
  request.set_height(64);
  const auto outcome = [&] {
    const auto context = Client::Context();
    const auto reader = client_.poses->Render(context.get(), request);
    v1::RenderResponse picture;
    EXPECT_FALSE(reader->Read(&picture));
    return reader->Finish();
  };
  const auto no_position = outcome();
  EXPECT_THAT(no_position, Refuses(StatusCode::INVALID_ARGUMENT, "INVALID_OPTION"));
  EXPECT_THAT(FieldsOf(no_position), ElementsAre("queries[1].position"));
  request.mutable_queries()->RemoveLast();
  request.set_width(4'097);
  EXPECT_THAT(FieldsOf(outcome()), ElementsAre("width"));
}

class FewPicturesTest : public PoseServiceTest {
 protected:
  // One stream of 64 x 64 pictures at a time: two may wait to be read.
  FewPicturesTest()
      : PoseServiceTest([] {
          Limits limits;
          limits.max_picture_bytes = 2 * 4 * 64 * 64;
          return limits;
        }()) {}
};

TEST_F(FewPicturesTest, PicturesThatNobodyReadsAreBounded) {
  Built("tux");
  v1::RenderRequest request;
  request.set_session_id("tux");
  for (int k = 0; k < 256; ++k) request.add_queries()->mutable_at()->set_y(k / 256.0);
  request.set_width(64);
  request.set_height(64);
  request.set_format(v1::IMAGE_FORMAT_RGBA);
  v1::RenderResponse picture;
  const auto context = Client::Context();
  const auto unread = client_.poses->Render(context.get(), request);
  ASSERT_TRUE(unread->Read(&picture));

  const auto render = [&] {
    const auto one = Client::Context();
    const auto reader = client_.poses->Render(one.get(), request);
    while (reader->Read(&picture)) {
    }
    return reader->Finish();
  };
  EXPECT_THAT(render(), Refuses(StatusCode::RESOURCE_EXHAUSTED, "COMPUTE_QUEUE_FULL"));
  context->TryCancel();
  unread->Finish();
  grpc::Status status = render();
  for (int k = 0; k < 1'000 && !status.ok(); ++k) {  // the server hears of the end a little later
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
    status = render();
  }
  EXPECT_THAT(status, Succeeds());
}

TEST_F(PoseServiceTest, ReadersThatVanishStopTheDrawing) {
  Built("tux");
  v1::RenderRequest request;
  request.set_session_id("tux");
  for (int k = 0; k < 200; ++k) request.add_queries()->mutable_at()->set_y(k / 200.0);
  request.set_width(256);
  request.set_height(256);
  for (int k = 0; k < 10; ++k) {
    const auto context = Client::Context();
    const auto reader = client_.poses->Render(context.get(), request);
    v1::RenderResponse picture;
    if (k % 2 == 0) {
      EXPECT_TRUE(reader->Read(&picture));
    }
    context->TryCancel();
    reader->Finish();
  }
  while (server_->open_streams() > 0) std::this_thread::sleep_for(std::chrono::milliseconds(5));
}

TEST_F(PoseServiceTest, TwoClientsSeeEachOthersWork) {
  Built("tux");
  Client other(server_->address());
  v1::BlendResponse response;
  EXPECT_THAT(other.Call(&PoseStub::Blend, BlendAt("tux", {0.5}), &response), Succeeds());
}

}  // namespace
}  // namespace posespace
