// SPDX-License-Identifier: Apache-2.0
// Services that die, hang, end or come back.
#include <chrono>
#include <csignal>
#include <filesystem>
#include <optional>
#include <thread>

#include "tests/client_cpp/live_service.h"

namespace posespace {
namespace {

using namespace std::chrono_literals;
using ::testing::AllOf;
using ::testing::AnyOf;
using ::testing::HasSubstr;

constexpr auto kTimeout = 1s;  // of clients that are to give up
constexpr auto kSlack = 20s;   // that a busy machine may add to it

std::string SocketPath() {
  static int count = 0;
  return "unix:" + (std::filesystem::temp_directory_path() /
                    ("posespace-" + std::to_string(getpid()) + "-" + std::to_string(++count)))
                       .string();
}

// A service that can be ended and started again at the same address.
class RestartableService {
 public:
  explicit RestartableService(std::vector<std::string> flags = {}) : flags_(std::move(flags)) {
    Start();
  }
  ~RestartableService() { std::filesystem::remove(address_.substr(5)); }

  void Start() {
    std::vector<std::string> arguments = {"--listen", address_, "--log-level", "error"};
    arguments.insert(arguments.end(), flags_.begin(), flags_.end());
    program_.emplace(arguments);
    EXPECT_EQ(program_->Address(), address_);
  }
  void Kill() {
    program_->Signal(SIGKILL);
    program_->Wait();
    program_.reset();
    std::filesystem::remove(address_.substr(5));
  }

  Program& program() { return *program_; }
  const std::string& address() const { return address_; }

 private:
  const std::string address_ = SocketPath();
  const std::vector<std::string> flags_;
  std::optional<Program> program_;
};

// Through a client that has time.
Session MakeStarsAt(const std::string& address, const std::string& id = {}) {
  return MakeStars(Client(address, {.timeout = 60s}), id);
}

// Waits until the connection's own pause before another attempt is over.
void Reach(const Client& client) {
  for (int k = 0; k < 600; ++k) {
    try {
      return client.Ping();
    } catch (const Error&) {
      std::this_thread::sleep_for(100ms);
    }
  }
  FAIL() << "the service is not reached";
}

template <typename Call>
std::chrono::steady_clock::duration TimeOf(const Call& call) {
  const auto start = std::chrono::steady_clock::now();
  call();
  return std::chrono::steady_clock::now() - start;
}

TEST(Faults, AServiceKilledUnderAPlayerIsSaidWithinTheTimeout) {
  RestartableService service;
  const Client client(service.address(), {.timeout = kTimeout});
  const Session session = client.Session(MakeStarsAt(service.address()).id());
  Player player = session.Play();
  player.Ask(0, 0, {0, 0});
  player.Tick();
  service.Kill();
  const auto spent = TimeOf([&] {
    player.Ask(0, 0, {0, 0});
    const Error error = ErrorOf([&] { player.Tick(); });
    EXPECT_THAT(error.code(), AnyOf(ErrorCode::kUnavailable, ErrorCode::kDeadlineExceeded));
    EXPECT_THAT(error.what(), HasSubstr(service.address()));
    EXPECT_EQ(player.under_way(), 0u);
  });
  EXPECT_LT(spent, kTimeout + kSlack);
  const Error error = ErrorOf([&] { session.Blend({0, 0}); });
  EXPECT_EQ(error.code(), ErrorCode::kUnavailable);
  EXPECT_THAT(error.what(), HasSubstr(service.address()));
}

TEST(Faults, AServiceThatHangsIsGivenUpAfterTheTimeoutAndFoundAgain) {
  RestartableService service;
  const Client client(service.address(), {.timeout = kTimeout});
  const Session session = client.Session(MakeStarsAt(service.address()).id());
  Player player = session.Play();
  service.program().Stop();
  player.Ask(0, 0, {0, 0});
  EXPECT_THAT([&] { player.Tick(); }, Refuses(ErrorCode::kDeadlineExceeded, ""));
  EXPECT_THAT([&] { session.Blend({0, 0}); }, Refuses(ErrorCode::kDeadlineExceeded, ""));
  service.program().Signal(SIGCONT);
  player.Ask(0, 7, {0, 0});
  EXPECT_EQ(player.Tick()[0].tag, 7u);
  EXPECT_EQ(player.times_opened(), 2);
}

TEST(Faults, APlayerFindsAServiceThatCameBackAndAsksAgainWhatHadNoAnswer) {
  RestartableService service;
  const Client client(service.address(), {.timeout = 60s});
  Session session = MakeStars(client, "stars");
  const Frame expected = session.Blend({0.4, 0.2});
  Player player = session.Play();
  const std::uint32_t other = player.Bind(MakeStars(client, "others"));
  service.program().Stop();  // so that it answers nothing of this
  for (int tick = 0; tick < 6; ++tick) {
    for (std::uint32_t k = 0; k < 300; ++k) player.Ask(k % 2 == 0 ? 0 : other, k, {0.4, 0.2});
    player.Send();
  }
  service.Kill();
  service.Start();
  MakeStarsAt(service.address(), "stars");
  for (int tick = 0; tick < 6; ++tick) {
    const auto answers = player.Receive();
    ASSERT_EQ(answers.size(), 300u);
    for (std::uint32_t k = 0; k < 300; ++k) {
      EXPECT_EQ(answers[k].tag, k);
      if (k % 2 == 0) {
        ASSERT_EQ(answers[k].error, nullptr) << answers[k].error->what();
        EXPECT_EQ(Distance(answers[k].vertices, expected.vertices), 0.0);
      } else {  // the service has forgotten it
        ASSERT_NE(answers[k].error, nullptr);
        EXPECT_EQ(answers[k].error->code(), ErrorCode::kNotFound);
        EXPECT_EQ(answers[k].error->reason(), "SESSION_NOT_FOUND");
      }
    }
  }
  EXPECT_EQ(player.times_opened(), 2);
}

TEST(Faults, APlayerGoesOnWhenAServiceThatKeepsItsSessionsComesBack) {
  const auto store = std::filesystem::temp_directory_path() /
                     ("posespace-store-" + std::to_string(getpid()) + ".db");
  RestartableService service({"--store", "sqlite:" + store.string()});
  const Client client(service.address(), {.timeout = 60s});
  Player player = MakeStars(client).Play();
  player.Ask(0, 0, {0.4, 0.2});
  const auto before = player.Tick()[0];
  const std::vector<float> vertices(before.vertices.begin(), before.vertices.end());
  const std::string revision = before.session->revision;
  service.Kill();
  service.Start();
  player.Ask(0, 0, {0.4, 0.2});
  const auto answers = player.Tick();
  ASSERT_EQ(answers[0].error, nullptr) << answers[0].error->what();
  EXPECT_EQ(answers[0].session->revision, revision);
  EXPECT_EQ(Distance(answers[0].vertices, vertices), 0.0);
  EXPECT_EQ(player.times_opened(), 2);
  for (const char* const suffix : {"", "-wal", "-shm", "-lock"}) {
    std::filesystem::remove(store.string() + suffix);
  }
}

TEST(Faults, APlayerOutlivesItsStreamsWithoutLosingAnAvatar) {
  RestartableService service({"--max-stream-age", "1"});
  const Client client(service.address(), {.timeout = 60s});
  Player player = MakeStars(client).Play();
  const auto give_up = std::chrono::steady_clock::now() + 60s;
  for (std::uint32_t tag = 0; player.times_opened() < 3; ++tag) {
    ASSERT_LT(std::chrono::steady_clock::now(), give_up);
    player.Ask(0, tag, {0.4, 0.2});
    const auto answers = player.Tick();
    ASSERT_EQ(answers.size(), 1u);
    ASSERT_EQ(answers[0].error, nullptr) << answers[0].error->what();
    EXPECT_EQ(answers[0].tag, tag);
  }
}

TEST(Faults, APlayerThatFailedCanBeUsedOnceTheServiceIsBack) {
  RestartableService service;
  const Client client(service.address(), {.timeout = kTimeout});
  MakeStarsAt(service.address(), "stars");
  Player player = client.Session("stars").Play();
  service.Kill();
  player.Ask(0, 1, {0, 0});
  EXPECT_THROW(player.Tick(), Error);
  service.Start();
  Reach(client);
  MakeStarsAt(service.address(), "stars");
  player.Ask(0, 2, {0, 0});
  const auto answers = player.Tick();
  ASSERT_EQ(answers.size(), 1u);
  EXPECT_EQ(answers[0].tag, 2u);
  EXPECT_EQ(answers[0].error, nullptr);
}

TEST(Faults, AnIdlePlayerDoesNotHoldAServiceThatEnds) {
  RestartableService service({"--drain-grace", "600000"});
  const Client client(service.address(), {.timeout = kTimeout});
  Player player = client.Session(MakeStarsAt(service.address()).id()).Play();
  service.program().Signal(SIGTERM);
  EXPECT_EQ(service.program().Wait(), 0);
}

TEST(Faults, APlayerMovesToTheServiceThatTakesThePlaceOfOneThatEnds) {
  RestartableService service({"--drain-grace", "600000"});
  const Client client(service.address(), {.timeout = 30s});
  MakeStars(client, "stars");
  Player player = client.Session("stars").Play();
  for (int tick = 0; tick < 20; ++tick) {
    player.Ask(0, 0, {0, 0});
    ASSERT_EQ(player.Tick()[0].error, nullptr);
  }
  service.program().Signal(SIGTERM);
  EXPECT_EQ(service.program().Wait(), 0);
  service.Start();
  MakeStarsAt(service.address(), "stars");
  player.Ask(0, 3, {0, 0});
  const auto answers = player.Tick();
  EXPECT_EQ(answers[0].error, nullptr);
  EXPECT_EQ(answers[0].tag, 3u);
  EXPECT_FALSE(player.draining());
  EXPECT_EQ(player.times_opened(), 2);
}

TEST(Faults, ManyAvatarsAreAnsweredWhileTheServiceEnds) {
  RestartableService service({"--drain-grace", "600000"});
  const Client client(service.address(), {.timeout = kTimeout});
  Player player = client.Session(MakeStarsAt(service.address()).id()).Play();
  service.program().Signal(SIGTERM);
  try {
    for (;;) {
      for (std::uint32_t k = 0; k < 64; ++k) player.Ask(0, k, {0, 0});
      for (const Answer& answer : player.Tick()) ASSERT_EQ(answer.error, nullptr);
    }
  } catch (const Error& error) {  // what the next stream is refused with
    EXPECT_EQ(error.code(), ErrorCode::kUnavailable) << error.what();
  }
  EXPECT_EQ(service.program().Wait(), 0);
}

TEST(Faults, AFullQueueIsTriedAgainUntilTheTimeout) {
  RestartableService service({"--max-streams", "1"});
  const Client client(service.address(), {.timeout = kTimeout});
  const Session session = client.Session(MakeStarsAt(service.address()).id());
  std::optional<Player> first = session.Play();
  EXPECT_THAT([&] { session.Play(); }, Refuses(ErrorCode::kResourceExhausted, "STREAM_LIMIT"));
  const std::jthread later([&] {
    std::this_thread::sleep_for(500ms);
    first.reset();
  });
  const Client patient(service.address(), {.timeout = 30s});
  EXPECT_NO_THROW(patient.Session(session.id()).Play());
}

TEST(Faults, LimitsOfTheServiceAreKeptOnBothSides) {
  RestartableService service({"--max-stream-items", "4", "--max-stream-slots", "2"});
  const Client client(service.address(), {.timeout = 30s});
  const Session session = MakeStars(client);
  Player player = session.Play();
  EXPECT_EQ(player.max_items(), 4);
  EXPECT_EQ(player.max_slots(), 2);
  for (const std::uint32_t count : {4u, 5u, 37u}) {
    for (std::uint32_t k = 0; k < count; ++k) player.Ask(0, k, {0, 0});
    const auto answers = player.Tick();
    ASSERT_EQ(answers.size(), count);
    EXPECT_EQ(answers[count - 1].tag, count - 1);
  }
  EXPECT_EQ(player.Bind(session), 1u);
  EXPECT_THAT([&] { player.Bind(session); }, Refuses(ErrorCode::kInvalidArgument, "SLOT_LIMIT"));
}

TEST(Faults, AClientOutlivedByItsPlayerIsNoFault) {
  std::optional<Player> player;
  {
    const Client client(SharedAddress());
    player = MakeStars(client).Play();
  }
  player->Ask(0, 5, {0, 0});
  EXPECT_EQ(player->Tick()[0].tag, 5u);
}

}  // namespace
}  // namespace posespace
