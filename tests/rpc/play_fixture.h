// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_RPC_PLAY_FIXTURE_H_
#define POSESPACE_TESTS_RPC_PLAY_FIXTURE_H_

#include <gtest/gtest.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "rpc/play_stream.h"
#include "tests/interpolation/counted_allocations.h"
#include "tests/rpc/built_session.h"

namespace posespace {

// Everything a stream asks for, kept until the test lets it happen.
class Wire final : public PlayTransport {
 public:
  void StartRead(v1::PlayRequest* message) override {
    EXPECT_EQ(reading, nullptr) << "two reads at once";
    reading = message;
    if (during_read) std::thread(std::ref(during_read)).join();
    EXPECT_FALSE(finished);
  }
  void StartWrite(MessageBytes message) override {
    EXPECT_EQ(writing, nullptr) << "two writes at once";
    EXPECT_FALSE(finished);
    if (parse) {
      EXPECT_TRUE(written.ParseFromArray(message.data(), static_cast<int>(message.size())));
    }
    bytes = std::move(message);
    writing = &written;
    if (during_write) std::thread(std::ref(during_write)).join();
  }
  void ScheduleWork() override {
    EXPECT_FALSE(work) << "two threads at once";
    work = true;
  }
  void ScheduleLoad() override {
    ++loads;
    ScheduleWork();
  }
  void Finish(Result<void> outcome) override {
    EXPECT_FALSE(finished) << "finished twice";
    finished = true;
    error = outcome ? std::nullopt : std::optional(outcome.error().code);
  }

  // What another thread does while a read or a write is being started.
  std::function<void()> during_read, during_write;

  v1::PlayRequest* reading = nullptr;
  MessageBytes bytes;
  bool parse = true;
  v1::PlayResponse written;  // the same, parsed
  const v1::PlayResponse* writing = nullptr;
  bool work = false;
  int loads = 0;
  bool finished = false;
  std::optional<ErrorCode> error;
};

// One session for all tests that leave it as it is: builds take their time.
inline BuiltSession& SharedSession() {
  static BuiltSession session;
  return session;
}

class Play : public ::testing::Test {
 protected:
  explicit Play(BuiltSession& sessions = SharedSession(), const Limits& limits = {})
      : sessions_(sessions),
        stream_(sessions_.registry(), limits, wire_, PlayStream::Clock::time_point::max(),
                [this] { return now_; }) {
    stream_.Start();
  }

  // The client says something.
  void Say(const v1::PlayRequest& message) {
    ASSERT_NE(wire_.reading, nullptr) << "the stream does not listen";
    *std::exchange(wire_.reading, nullptr) = message;
    stream_.OnRead(true);
  }
  void SayAll() {
    wire_.reading = nullptr;
    stream_.OnRead(false);
  }
  void LetWork() {
    ASSERT_TRUE(std::exchange(wire_.work, false)) << "there is no work";
    stream_.Work();
  }
  // The client takes one message.
  v1::PlayResponse Take() {
    if (wire_.writing == nullptr) {
      ADD_FAILURE() << "nothing is written";
      return {};
    }
    const v1::PlayResponse message = *std::exchange(wire_.writing, nullptr);
    stream_.OnWritten(true);
    return message;
  }
  // All that comes of itself: work is done, messages are taken.
  std::vector<v1::PlayResponse> TakeAll() {
    std::vector<v1::PlayResponse> messages;
    while (wire_.work || wire_.writing != nullptr) {
      if (wire_.work) {
        LetWork();
      } else {
        messages.push_back(Take());
      }
    }
    return messages;
  }

  static v1::PlayRequest Bind(std::uint32_t slot, const std::string& session = "cell",
                              const std::string& revision = "") {
    v1::PlayRequest request;
    request.mutable_bind()->set_slot(slot);
    request.mutable_bind()->set_session_id(session);
    request.mutable_bind()->set_pinned_revision(revision);
    return request;
  }
  static v1::PlayRequest Unbind(std::uint32_t slot) {
    v1::PlayRequest request;
    request.mutable_unbind()->set_slot(slot);
    return request;
  }
  static v1::PlayRequest Tick(std::uint64_t frame_id, const std::vector<std::uint32_t>& slots,
                              double y = 0.5) {
    v1::PlayRequest request;
    request.mutable_tick()->set_frame_id(frame_id);
    for (const std::uint32_t slot : slots) {
      auto* const item = request.mutable_tick()->add_items();
      item->set_slot(slot);
      item->set_tag(static_cast<std::uint32_t>(100 + request.tick().items_size()));
      item->mutable_query()->mutable_at()->set_y(y);
    }
    return request;
  }
  // Binds slot 0 and forgets what was said so far.
  void BindSlot0() {
    Say(Bind(0));
    ASSERT_EQ(TakeAll().back().bound().reason(), "");
  }
  std::string Revision() { return (*sessions_.session().Built())->revision(); }
  int Vertices() { return (*sessions_.session().Built())->mesh().num_vertices(); }

  // Plays messages of one, some and many items until memory is what they need, and counts then.
  void ExpectNoAllocationForAnItem() {
    wire_.parse = false;
    for (const std::size_t count : {1, 16, 64}) {
      const v1::PlayRequest tick = Tick(1, std::vector<std::uint32_t>(count, 0), 0.3);
      const std::string bytes = tick.SerializeAsString();
      const auto play = [&] {
        ASSERT_NE(wire_.reading, nullptr);
        ASSERT_TRUE(std::exchange(wire_.reading, nullptr)->ParseFromString(bytes));
        stream_.OnRead(true);
        if (std::exchange(wire_.work, false)) stream_.Work();
        ASSERT_GT(wire_.bytes.size(), count * 8 * Vertices());
        wire_.bytes = {};
        wire_.writing = nullptr;
        stream_.OnWritten(true);
      };
      for (int k = 0; k < 10; ++k) play();
      const int before = CountedAllocations();
      constexpr int kMessages = 100;
      for (int k = 0; k < kMessages; ++k) play();
      // What protobuf reads a message into, however many items it has.
      EXPECT_LE(CountedAllocations() - before, 4 * kMessages) << count << " items";
    }
    wire_.parse = true;
  }

  BuiltSession& sessions_;
  PlayStream::Clock::time_point now_ = PlayStream::Clock::now();
  Wire wire_;
  PlayStream stream_;
};

// A session of its own; made before the stream.
struct OwnSession {
  BuiltSession own;
};
class PlayOfAChangingSession : private OwnSession, public Play {
 protected:
  PlayOfAChangingSession() : Play(own) {}
};

}  // namespace posespace

#endif  // POSESPACE_TESTS_RPC_PLAY_FIXTURE_H_
