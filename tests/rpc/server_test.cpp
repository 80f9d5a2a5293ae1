// SPDX-License-Identifier: Apache-2.0
#include "rpc/server.h"

#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>
#include <unistd.h>

#include <condition_variable>
#include <filesystem>
#include <mutex>
#include <thread>

#include "tests/rpc/service_fixture.h"
#include "tests/support/fails_saying.h"

namespace posespace {
namespace {

using namespace std::chrono_literals;
using grpc::StatusCode;

// What the health service answers for a name: SERVING is 1, NOT_SERVING 2; -1 for an error.
int HealthOf(const std::shared_ptr<grpc::Channel>& channel, const std::string& name) {
  std::string request;
  if (!name.empty()) request = std::string("\x0a") + static_cast<char>(name.size()) + name;
  const grpc::Slice slice(request);
  const grpc::ByteBuffer bytes(&slice, 1);
  grpc::ByteBuffer answer;
  grpc::Status status;
  std::mutex mutex;
  std::condition_variable answered;
  bool done = false;
  const auto context = Client::Context();
  grpc::GenericStub stub(channel);
  stub.UnaryCall(context.get(), "/grpc.health.v1.Health/Check", {}, &bytes, &answer,
                 [&](const grpc::Status& outcome) {
                   const std::scoped_lock lock(mutex);
                   status = outcome;
                   done = true;
                   answered.notify_one();
                 });
  std::unique_lock lock(mutex);
  answered.wait(lock, [&] { return done; });
  grpc::Slice whole;
  if (!status.ok() || !answer.DumpToSingleSlice(&whole).ok() || whole.size() != 2) return -1;
  return whole.begin()[1];
}

class ServerTest : public ServiceTest {};

TEST_F(ServerTest, SaysThatItIsHealthyUntilItDrains) {
  const std::vector<std::string> names = {"", "posespace.v1.SessionService",
                                          "posespace.v1.PoseService"};
  for (const std::string& name : names) EXPECT_EQ(HealthOf(client_.channel, name), 1) << name;
  EXPECT_EQ(HealthOf(client_.channel, "posespace.v1.NoService"), -1);
  server_->BeginDrain(1s);
  for (const std::string& name : names) EXPECT_EQ(HealthOf(client_.channel, name), 2) << name;
}

TEST_F(ServerTest, RefusesNewStreamsAndBuildsWhileItDrainsButAnswersOtherCalls) {
  Built("tux");
  Create("raw");
  Draw("raw");
  server_->BeginDrain(1s);
  const auto context = Client::Context();
  const auto call = client_.poses->Play(context.get());
  v1::PlayResponse message;
  EXPECT_FALSE(call->Read(&message));
  EXPECT_THAT(call->Finish(), Refuses(StatusCode::UNAVAILABLE, "DRAINING"));
  v1::StartBuildRequest build;
  build.set_session_id("raw");
  v1::StartBuildResponse started;
  EXPECT_THAT(client_.Call(&SessionStub::StartBuild, build, &started),
              Refuses(StatusCode::UNAVAILABLE, "DRAINING"));
  v1::BlendResponse blended;
  EXPECT_THAT(client_.Call(&PoseStub::Blend, BlendAt("tux", {0.5}), &blended), Succeeds());
}

TEST_F(ServerTest, TellsOpenStreamsThatItEnds) {
  const auto context = Client::Context();
  const auto call = client_.poses->Play(context.get());
  v1::PlayResponse message;
  ASSERT_TRUE(call->Read(&message));
  server_->BeginDrain(60s);
  ASSERT_TRUE(call->Read(&message));
  EXPECT_EQ(message.draining().stop_sending_in().seconds(), 60);
  call->WritesDone();
  EXPECT_FALSE(call->Read(&message));
  EXPECT_THAT(call->Finish(), Succeeds());
}

TEST_F(ServerTest, CutsOffStreamsThatOutstayTheDraining) {
  const auto context = Client::Context();
  const auto call = client_.poses->Play(context.get());
  v1::PlayResponse message;
  ASSERT_TRUE(call->Read(&message));
  server_->BeginDrain(0s);
  ASSERT_TRUE(call->Read(&message));
  EXPECT_FALSE(call->Read(&message));
  EXPECT_THAT(call->Finish(), Refuses(StatusCode::UNAVAILABLE, "DRAINING"));
}

TEST_F(ServerTest, ShutsDownWithStreamsOpenAndBuildsRunning) {
  Built("tux");
  Create("slow");
  for (int k = 0; k < 12; ++k) {
    Put(PutImage("slow", "pose" + std::to_string(k), PngOf(40 + 3 * k, 80 - 3 * k, kRed)));
  }
  StartBuild("slow");
  v1::WatchBuildRequest watch;
  watch.set_session_id("slow");
  const auto watch_context = Client::Context(), play_context = Client::Context();
  const auto watcher = client_.sessions->WatchBuild(watch_context.get(), watch);
  const auto player = client_.poses->Play(play_context.get());
  v1::PlayResponse message;
  ASSERT_TRUE(player->Read(&message));
  server_->BeginDrain(0s);
  server_->Shutdown(0s);
  while (player->Read(&message)) {
  }
  EXPECT_FALSE(player->Finish().ok());
  v1::WatchBuildResponse event;
  while (watcher->Read(&event)) {
  }
  watcher->Finish();
}

TEST_F(ServerTest, TakesMetadataOfAFewKibibytesAndNoMore) {
  v1::ListSessionsResponse response;
  for (const auto& [bytes, code] :
       {std::pair(4'000, StatusCode::OK), std::pair(20'000, StatusCode::RESOURCE_EXHAUSTED)}) {
    const auto context = Client::Context();
    context->AddMetadata("note", std::string(static_cast<std::size_t>(bytes), 'x'));
    EXPECT_EQ(client_.sessions->ListSessions(context.get(), {}, &response).error_code(), code);
  }
}

TEST_F(ServerTest, DoesNotShareItsPort) {
  EXPECT_THAT(Server::Start(server_->address(), {}),
              FailsSaying(ErrorCode::kInvalidOption, server_->address()));
}

TEST(Server, ListensOnAUnixSocket) {
  const auto directory =
      std::filesystem::temp_directory_path() / ("posespace-" + std::to_string(getpid()));
  std::filesystem::create_directories(directory);
  {
    const auto server = Server::Start("unix:" + (directory / "socket").string(), {});
    ASSERT_TRUE(server);
    EXPECT_EQ((*server)->port(), 0);
    const Client client((*server)->address());
    EXPECT_EQ(HealthOf(client.channel, ""), 1);
  }
  std::filesystem::remove_all(directory);
}

TEST_F(ServerTest, GivesEachStreamItsBeatWithoutBeingAsked) {
  Built("tux");
  const auto context = Client::Context();
  const auto call = client_.poses->Play(context.get());
  v1::PlayRequest bind;
  bind.mutable_bind()->set_session_id("tux");
  call->Write(bind);
  v1::PlayResponse message;
  ASSERT_TRUE(call->Read(&message));
  ASSERT_TRUE(call->Read(&message));
  for (const double distance : {2.0, 3.0, 4.0}) {
    const std::string revision = Place("tux", distance).revision();
    ASSERT_TRUE(call->Read(&message));
    EXPECT_EQ(message.revision_changed().revision(), revision);
  }
  context->TryCancel();
  call->Finish();
}

class FewStreamsTest : public ServiceTest {
 protected:
  static Limits Few() {
    Limits limits;
    limits.max_streams = 2;
    return limits;
  }
  FewStreamsTest() : ServiceTest(Few()) {}
};

TEST_F(FewStreamsTest, OpensAsManyStreamsAsAllowedAndNoMore) {
  using Call = std::unique_ptr<grpc::ClientReaderWriter<v1::PlayRequest, v1::PlayResponse>>;
  v1::PlayResponse message;
  const auto context1 = Client::Context(), context2 = Client::Context(),
             context3 = Client::Context(), context4 = Client::Context();
  const Call first = client_.poses->Play(context1.get());
  const Call second = client_.poses->Play(context2.get());
  ASSERT_TRUE(first->Read(&message));
  ASSERT_TRUE(second->Read(&message));
  const Call third = client_.poses->Play(context3.get());
  EXPECT_FALSE(third->Read(&message));
  EXPECT_THAT(third->Finish(), Refuses(StatusCode::RESOURCE_EXHAUSTED, "STREAM_LIMIT"));
  first->WritesDone();
  EXPECT_FALSE(first->Read(&message));
  EXPECT_THAT(first->Finish(), Succeeds());
  while (server_->open_streams() > 1) std::this_thread::sleep_for(1ms);
  const Call fourth = client_.poses->Play(context4.get());
  EXPECT_TRUE(fourth->Read(&message));
  context2->TryCancel();
  second->Finish();
  context4->TryCancel();
  fourth->Finish();
}

}  // namespace
}  // namespace posespace
