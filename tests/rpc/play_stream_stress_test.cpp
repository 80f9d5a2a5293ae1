// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <optional>
#include <queue>
#include <random>
#include <thread>
#include <utility>
#include <vector>

#include "rpc/play_stream.h"
#include "tests/rpc/built_session.h"

namespace posespace {
namespace {

using namespace std::chrono_literals;

// Threads that run what they are given.
class Threads {
 public:
  explicit Threads(int count) {
    for (int k = 0; k < count; ++k) threads_.emplace_back([this] { Run(); });
  }
  ~Threads() {
    {
      const std::scoped_lock lock(mutex_);
      stopping_ = true;
    }
    ready_.notify_all();
    for (std::thread& thread : threads_) thread.join();
  }
  void Do(std::function<void()> job) {
    {
      const std::scoped_lock lock(mutex_);
      jobs_.push(std::move(job));
    }
    ready_.notify_one();
  }

 private:
  void Run() {
    for (;;) {
      std::unique_lock lock(mutex_);
      ready_.wait(lock, [&] { return stopping_ || !jobs_.empty(); });
      if (jobs_.empty()) return;
      const auto job = std::move(jobs_.front());
      jobs_.pop();
      lock.unlock();
      job();
    }
  }

  std::mutex mutex_;
  std::condition_variable ready_;
  std::queue<std::function<void()>> jobs_;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

// A client and a transport as gRPC's is: every event comes from a thread of its own choice, and
// the stream is gone once all that it started has come back.
class Connection final : public PlayTransport {
 public:
  Connection(const Registry& registry, Threads& threads, int frames)
      : threads_(threads), frames_(frames), stream_(registry, Limits{}, *this) {}

  void Start() { stream_.Start(); }
  PlayStream& stream() { return stream_; }

  void StartRead(v1::PlayRequest* message) override {
    EXPECT_FALSE(finished_);
    const int turn = reads_++;
    Begin([=, this] {
      if (turn == 0) {
        message->mutable_bind()->set_session_id("cell");
      } else {
        message->mutable_tick()->set_frame_id(static_cast<std::uint64_t>(turn));
        const int items = turn % 5 == 0 ? 8 : 1;
        for (int k = 0; k < items; ++k) {
          message->mutable_tick()->add_items()->mutable_query()->mutable_at()->set_y(0.1 * k);
        }
      }
      stream_.OnRead(turn <= frames_ && !cancelled_);
    });
  }
  void StartWrite(MessageBytes bytes) override {
    EXPECT_FALSE(finished_);
    v1::PlayResponse message;
    EXPECT_TRUE(message.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())));
    Begin([message, this] {
      if (message.has_frame_result()) {
        const auto frame_id = static_cast<int>(message.frame_result().frame_id());
        EXPECT_EQ(frame_id, ++results_);
      }
      stream_.OnWritten(!cancelled_);
    });
  }
  void ScheduleWork() override {
    Begin([this] { stream_.Work(); });
  }
  void ScheduleLoad() override { ScheduleWork(); }
  void Finish(Result<void> outcome) override {
    if (!cancelled_) {
      EXPECT_TRUE(outcome);
    }
    EXPECT_FALSE(finished_.exchange(true));
  }
  void Cancel() {
    cancelled_ = true;
    Begin([this] { stream_.OnCancelled(); });
  }

  bool over() const { return finished_ && pending_ == 0; }
  int results() const { return results_; }

 private:
  void Begin(std::function<void()> event) {
    ++pending_;
    threads_.Do([this, event = std::move(event)] {
      event();
      --pending_;
    });
  }

  Threads& threads_;
  const int frames_;
  std::atomic<int> reads_{0}, results_{0}, pending_{0};
  std::atomic<bool> cancelled_{false}, finished_{false};
  PlayStream stream_;
};

TEST(PlayStress, ManyStreamsOnManyThreadsEndOnceAndAnswerInOrder) {
  constexpr int kFrames = 60;
  constexpr int kRounds = 20;
  BuiltSession sessions;
  Threads threads(6);
  std::mt19937 random(1);
  for (int round = 0; round < kRounds; ++round) {
    std::vector<std::unique_ptr<Connection>> connections;
    for (int k = 0; k < 4; ++k) {
      connections.push_back(std::make_unique<Connection>(sessions.registry(), threads, kFrames));
      connections.back()->Start();
    }
    const bool cancel = round % 2 == 1;
    for (int beat = 0; beat < 30; ++beat) {
      for (auto& connection : connections) connection->stream().Beat(PlayStream::Clock::now());
      if (beat % 10 == 5) {  // under the streams' feet
        EXPECT_TRUE(sessions.session().SetPlacements(
            {{"wide", Point(0, 0)}, {"tall", Point(0, 1.0 + round % 2)}}, ""));
      }
      if (cancel && beat == static_cast<int>(random() % 30)) connections[beat % 4]->Cancel();
      if (round % 5 == 4 && beat == 20) {
        for (auto& connection : connections) connection->stream().Drain(1h);
      }
    }
    for (auto& connection : connections) {
      while (!connection->over()) std::this_thread::sleep_for(1ms);
      if (!cancel) {
        EXPECT_EQ(connection->results(), kFrames);
      }
    }
  }
}

}  // namespace
}  // namespace posespace
