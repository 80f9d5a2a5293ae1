// SPDX-License-Identifier: Apache-2.0
#include "tests/support/program.h"

#include <gmock/gmock.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/security/credentials.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>
#include <vector>

#include "ops/config.h"
#include "ops/logging.h"
#include "ops/port_file.h"
#include "posespace/v1/pose_service.grpc.pb.h"
#include "posespace/v1/session_service.grpc.pb.h"
#include "tests/support/fails_saying.h"

namespace posespace {
namespace {

using namespace std::chrono_literals;
using ::testing::HasSubstr;
using ::testing::StartsWith;

int RunToEnd(std::vector<std::string> arguments, std::string* err = nullptr,
             std::vector<std::string> environment = {}) {
  Program program(std::move(arguments), std::move(environment));
  const int status = program.Wait();
  if (err != nullptr) *err = program.err();
  return status;
}

std::shared_ptr<grpc::Channel> ChannelTo(const std::string& address) {
  return grpc::CreateChannel(address, grpc::InsecureChannelCredentials());
}

std::unique_ptr<grpc::ClientContext> Context() {
  auto context = std::make_unique<grpc::ClientContext>();
  context->set_deadline(std::chrono::system_clock::now() + 60s);
  context->set_wait_for_ready(true);
  return context;
}

grpc::Status ListSessions(const std::string& address) {
  const auto stub = v1::SessionService::NewStub(ChannelTo(address));
  const auto context = Context();
  v1::ListSessionsResponse response;
  return stub->ListSessions(context.get(), {}, &response);
}

TEST(Program, SaysWhenItIsReadyAndEndsWellOnSigterm) {
  for (const int signal : {SIGTERM, SIGINT}) {
    Program program({"--listen", "127.0.0.1:0"});
    EXPECT_THAT(program.Address(), StartsWith("127.0.0.1:"));
    EXPECT_TRUE(ListSessions(program.Address()).ok());
    program.Signal(signal);
    EXPECT_EQ(program.Wait(), 0);
  }
}

TEST(Program, ReadsItsEnvironmentAndLetsFlagsPrevail) {
  Program program({"--max-stream-items", "7"},
                  {"POSESPACED_LISTEN=127.0.0.1:0", "POSESPACED_MAX_STREAM_SLOTS=5",
                   "POSESPACED_MAX_STREAM_ITEMS=6"});
  const auto stub = v1::PoseService::NewStub(ChannelTo(program.Address()));
  const auto context = Context();
  const auto call = stub->Play(context.get());
  v1::PlayResponse message;
  ASSERT_TRUE(call->Read(&message));
  EXPECT_EQ(message.welcome().max_slots(), 5u);
  EXPECT_EQ(message.welcome().max_items(), 7u);
  context->TryCancel();
}

TEST(Program, RefusesWhatItCannotDoInWords) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"--listen", "0.0.0.0:0"}, "--insecure"},
      {{"--listen", "127.0.0.1"}, "--listen"},
      {{"--listen", "127.0.0.1:99999"}, "--listen"},
      {{"--store", "postgres://host/db"}, "not in this version"},
      {{"--store", "sqlite:"}, "sqlite:PATH"},
      {{"--listen", "unix:/tmp/x", "--port-file", "y"}, "--port-file"},
      {{"--max-sessions", "0"}, "--max-sessions"},
      {{"--placement-fade", "-1"}, "--placement-fade"},
      {{"--log-level", "loud"}, "--log-level"},
      {{"--no-such-flag"}, "--no-such-flag"}};
  for (const auto& [arguments, text] : cases) {
    std::string err;
    EXPECT_EQ(RunToEnd(arguments, &err), 2) << arguments[0];
    EXPECT_THAT(err, HasSubstr(text));
  }
}

TEST(Program, SaysThatAPortIsTaken) {
  Program first({"--listen", "127.0.0.1:0"});
  std::string err;
  EXPECT_EQ(RunToEnd({"--listen", first.Address()}, &err), 1);
  EXPECT_THAT(err, HasSubstr("cannot listen on " + first.Address()));
  EXPECT_TRUE(ListSessions(first.Address()).ok());
}

TEST(Program, WritesItsPortWhenItAnswers) {
  const auto path =
      std::filesystem::temp_directory_path() / ("posespace-port-" + std::to_string(getpid()));
  Program program({"--listen", "127.0.0.1:0", "--port-file", path.string()});
  const std::string address = program.Address();
  std::ifstream file(path);
  std::string port;
  std::getline(file, port);
  EXPECT_EQ("127.0.0.1:" + port, address);
  std::filesystem::remove(path);
  std::string err;
  EXPECT_EQ(RunToEnd({"--listen", "127.0.0.1:0", "--port-file", "/no/such/place"}, &err), 1);
  EXPECT_THAT(err, HasSubstr("--port-file"));
}

TEST(Program, SurvivesGarbageOnItsPort) {
  Program program({"--listen", "127.0.0.1:0"});
  const std::string address = program.Address();
  const int port = std::stoi(address.substr(address.rfind(':') + 1));
  std::mt19937 random(1);
  const std::string preface = "PRI * HTTP/2.0\r\n\r\nSM\r\n\r\n";
  for (int round = 0; round < 40; ++round) {
    std::string bytes = round % 2 == 0 ? "" : preface;
    for (int k = 0; k < 2'000; ++k) bytes += static_cast<char>(random());
    const int connection = socket(AF_INET, SOCK_STREAM, 0);
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(static_cast<std::uint16_t>(port));
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ASSERT_EQ(connect(connection, reinterpret_cast<sockaddr*>(&to), sizeof(to)), 0);
    // The other side may have closed already.
    [[maybe_unused]] const auto sent = send(connection, bytes.data(), bytes.size(), MSG_NOSIGNAL);
    close(connection);
  }
  EXPECT_TRUE(ListSessions(address).ok());
  program.Signal(SIGTERM);
  EXPECT_EQ(program.Wait(), 0);
}

TEST(Program, OutlivesTheReaderOfItsLog) {
  int log[2];
  ASSERT_EQ(pipe2(log, O_CLOEXEC), 0);
  Program program({"--listen", "127.0.0.1:0", "--log-level", "debug"}, {}, log[1]);
  close(log[1]);
  const std::string address = program.Address();
  close(log[0]);
  for (int k = 0; k < 3; ++k) EXPECT_TRUE(ListSessions(address).ok());
  program.Signal(SIGTERM);
  EXPECT_EQ(program.Wait(), 0);
}

TEST(Program, LetsAStreamEndBeforeItEnds) {
  Program program({"--listen", "127.0.0.1:0", "--drain-grace", "30000"});
  const auto stub = v1::PoseService::NewStub(ChannelTo(program.Address()));
  const auto context = Context();
  const auto call = stub->Play(context.get());
  v1::PlayResponse message;
  ASSERT_TRUE(call->Read(&message));
  program.Signal(SIGTERM);
  ASSERT_TRUE(call->Read(&message));
  EXPECT_TRUE(message.has_draining());
  call->WritesDone();
  EXPECT_FALSE(call->Read(&message));
  EXPECT_TRUE(call->Finish().ok());
  EXPECT_EQ(program.Wait(), 0);
}

TEST(Program, ASecondSignalEndsTheWaiting) {
  Program program({"--listen", "127.0.0.1:0", "--drain-grace", "600000"});
  const auto stub = v1::PoseService::NewStub(ChannelTo(program.Address()));
  const auto context = Context();
  const auto call = stub->Play(context.get());
  v1::PlayResponse message;
  ASSERT_TRUE(call->Read(&message));
  program.Signal(SIGTERM);
  ASSERT_TRUE(call->Read(&message));
  program.Signal(SIGTERM);
  EXPECT_FALSE(call->Read(&message));
  EXPECT_FALSE(call->Finish().ok());
  EXPECT_EQ(program.Wait(), 0);
}

TEST(Program, EndsDuringABuild) {
  Program program({"--listen", "127.0.0.1:0"});
  const auto stub = v1::SessionService::NewStub(ChannelTo(program.Address()));
  v1::CreateSessionRequest create;
  create.set_session_id("slow");
  v1::CreateSessionResponse created;
  ASSERT_TRUE(stub->CreateSession(Context().get(), create, &created).ok());
  for (int pose = 0; pose < 24; ++pose) {
    v1::PutShapeRequest put;
    put.set_session_id("slow");
    put.set_shape_id("pose" + std::to_string(pose));
    auto& outer = *put.mutable_polygon()->mutable_outer();
    for (int k = 0; k < 400; ++k) {
      const double angle = 2.0 * M_PI * k / 400;
      const double radius = 100.0 + 30.0 * std::cos((3 + pose % 5) * angle);
      outer.add_coordinates(200.0 + radius * std::cos(angle));
      outer.add_coordinates(200.0 + radius * std::sin(angle));
    }
    v1::PutShapeResponse response;
    ASSERT_TRUE(stub->PutShape(Context().get(), put, &response).ok());
  }
  v1::StartBuildRequest build;
  build.set_session_id("slow");
  build.mutable_options()->set_tolerance(0.001);
  build.mutable_options()->set_target_edge_length(0.02);
  v1::StartBuildResponse started;
  ASSERT_TRUE(stub->StartBuild(Context().get(), build, &started).ok());
  v1::WatchBuildRequest watch;
  watch.set_session_id("slow");
  const auto context = Context();
  const auto reader = stub->WatchBuild(context.get(), watch);
  v1::WatchBuildResponse event;
  ASSERT_TRUE(reader->Read(&event));
  program.Signal(SIGTERM);
  while (reader->Read(&event)) {
  }
  EXPECT_EQ(event.build().state(), v1::BUILD_STATE_CANCELLED);
  reader->Finish();
  EXPECT_EQ(program.Wait(), 0);
}

TEST(Config, KnowsWhichAddressesStayOnThisMachine) {
  for (const std::string local :
       {"127.0.0.1:1", "127.9.9.9:1", "localhost:1", "[::1]:1", "unix:x"}) {
    EXPECT_TRUE(IsLocal(local)) << local;
  }
  for (const std::string wide : {"0.0.0.0:1", "[::]:1", "10.0.0.1:1", "*:1", "127.example.org:1"}) {
    EXPECT_FALSE(IsLocal(wide)) << wide;
  }
}

TEST(Config, AllowsPlainTextBeyondThisMachineOnlyWhenTold) {
  Config config;
  EXPECT_TRUE(CheckConfig(config));
  config.listen = "0.0.0.0:7433";
  EXPECT_THAT(CheckConfig(config), FailsSaying(ErrorCode::kInvalidOption, "--insecure"));
  config.insecure = true;
  EXPECT_TRUE(CheckConfig(config));
}

TEST(LogValue, CannotForgeALine) {
  EXPECT_EQ(LogValue("Blend"), "Blend");
  EXPECT_EQ(LogValue(""), "\"\"");
  EXPECT_EQ(LogValue("two words"), "\"two words\"");
  EXPECT_EQ(LogValue("a\nlevel=error \"x\" \\"), "\"a\\x0alevel=error \\\"x\\\" \\\\\"");
}

}  // namespace
}  // namespace posespace
