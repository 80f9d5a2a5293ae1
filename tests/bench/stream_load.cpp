// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/stream_load.h"

#include <grpc/grpc.h>
#include <grpc/support/time.h>
#include <grpcpp/channel.h>
#include <grpcpp/client_context.h>
#include <grpcpp/completion_queue.h>
#include <grpcpp/create_channel.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/security/credentials.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstdint>
#include <ctime>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <thread>

namespace posespace {
namespace {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr int kStreamsPerConnection = 8;

double CpuSeconds(pid_t process) {
  clockid_t clock;
  timespec now{};
  if (clock_getcpuclockid(process, &clock) != 0 || clock_gettime(clock, &now) != 0) {
    throw std::runtime_error("the server has ended");
  }
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

// One stream: messages wait until the one before is written.  Any thread may say something; one
// thread takes what comes from the completion queue.
class LoadStream {
 public:
  enum class Step : std::uintptr_t { kStarted, kWritten, kRead, kFinished };

  LoadStream(const std::shared_ptr<grpc::Channel>& channel, const std::string& method,
             grpc::CompletionQueue* queue)
      : stub_(channel), call_(stub_.PrepareCall(&context_, method, queue)) {
    call_->StartCall(Tag(Step::kStarted));
  }

  void Say(const grpc::ByteBuffer& message, Clock::time_point instant, bool is_answered) {
    const std::scoped_lock lock(mutex_);
    if (is_answered) asked_.push_back(instant);
    waiting_.push_back(&message);
    WriteNext();
  }
  void Read() { call_->Read(&incoming_, Tag(Step::kRead)); }
  void Written() {
    const std::scoped_lock lock(mutex_);
    writing_ = false;
    WriteNext();
  }
  Clock::time_point Answered() {
    const std::scoped_lock lock(mutex_);
    const Clock::time_point instant = asked_.front();
    asked_.pop_front();
    return instant;
  }
  void Finish() {
    context_.TryCancel();
    call_->Finish(&status_, Tag(Step::kFinished));
  }

  // The two lowest bits of a tag are the step.
  static LoadStream* Of(void* tag) {
    return reinterpret_cast<LoadStream*>(reinterpret_cast<std::uintptr_t>(tag) &
                                         ~std::uintptr_t{3});
  }
  static Step StepOf(void* tag) {
    return static_cast<Step>(reinterpret_cast<std::uintptr_t>(tag) & std::uintptr_t{3});
  }

 private:
  void* Tag(Step step) {
    return reinterpret_cast<void*>(reinterpret_cast<std::uintptr_t>(this) |
                                   static_cast<std::uintptr_t>(step));
  }
  void WriteNext() {
    if (writing_ || waiting_.empty()) return;
    writing_ = true;
    call_->Write(*waiting_.front(), Tag(Step::kWritten));
    waiting_.pop_front();
  }

  grpc::GenericStub stub_;
  grpc::ClientContext context_;
  std::unique_ptr<grpc::GenericClientAsyncReaderWriter> call_;
  grpc::ByteBuffer incoming_;
  grpc::Status status_;
  std::mutex mutex_;
  std::deque<const grpc::ByteBuffer*> waiting_;
  std::deque<Clock::time_point> asked_;
  bool writing_ = false;
};

// All streams of a run, open and past their first answers.
class OpenStreams {
 public:
  OpenStreams(const LoadTarget& target, int count) : target_(target) {
    std::shared_ptr<grpc::Channel> channel;
    for (int k = 0; k < count; ++k) {
      if (k % kStreamsPerConnection == 0) {
        grpc::ChannelArguments arguments;
        arguments.SetMaxReceiveMessageSize(-1);
        arguments.SetInt(GRPC_ARG_USE_LOCAL_SUBCHANNEL_POOL, 1);  // a connection of its own
        channel = grpc::CreateCustomChannel(target.address, grpc::InsecureChannelCredentials(),
                                            arguments);
      }
      streams_.push_back(std::make_unique<LoadStream>(channel, target.method, &queue_));
    }
    int outstanding = count * static_cast<int>(1 + target.first.size() + target.first_answers);
    std::vector<int> answers(streams_.size(), 0);
    while (outstanding > 0) {
      const std::optional<Event> event = Next(Clock::now() + std::chrono::seconds(10));
      if (!event) throw std::runtime_error(target.method + " does not answer");
      const auto& [stream, step] = *event;
      --outstanding;
      if (step == LoadStream::Step::kStarted) {
        for (const auto& message : target.first) stream->Say(message, {}, false);
        stream->Read();
      } else if (step == LoadStream::Step::kWritten) {
        stream->Written();
      } else {
        stream->Read();
      }
    }
  }

  ~OpenStreams() {
    for (auto& stream : streams_) stream->Finish();
    queue_.Shutdown();
    void* tag = nullptr;
    bool ok = false;
    while (queue_.Next(&tag, &ok)) {
    }
  }

  std::size_t count() const { return streams_.size(); }
  void Ask(std::size_t stream, Clock::time_point instant) { Ask(*streams_[stream], instant); }
  void Ask(LoadStream& stream, Clock::time_point instant) {
    stream.Say(target_.ticks[next_tick_++ % target_.ticks.size()], instant, true);
  }

  // Takes events until `end`; `answered(stream, instant, now)` for each answer.
  template <typename Answered>
  void RunUntil(Clock::time_point end, const Answered& answered) {
    while (const std::optional<Event> event = Next(end)) {
      const auto& [stream, step] = *event;
      if (step == LoadStream::Step::kWritten) {
        stream->Written();
      } else if (step == LoadStream::Step::kRead) {
        const Clock::time_point now = Clock::now();
        const Clock::time_point instant = stream->Answered();
        stream->Read();
        answered(*stream, instant, now);
      }
    }
  }

 private:
  struct Event {
    LoadStream* stream;
    LoadStream::Step step;
  };
  // None once it is `end`.
  std::optional<Event> Next(Clock::time_point end) {
    void* tag = nullptr;
    bool ok = false;
    const auto left = std::chrono::duration_cast<std::chrono::microseconds>(end - Clock::now());
    if (left.count() <= 0) return std::nullopt;
    const gpr_timespec deadline = gpr_time_add(gpr_now(GPR_CLOCK_MONOTONIC),
                                               gpr_time_from_micros(left.count(), GPR_TIMESPAN));
    const auto outcome = queue_.AsyncNext(&tag, &ok, deadline);
    if (outcome != grpc::CompletionQueue::GOT_EVENT) return std::nullopt;
    if (!ok) throw std::runtime_error("a stream of " + target_.method + " has ended");
    return Event{LoadStream::Of(tag), LoadStream::StepOf(tag)};
  }

  const LoadTarget& target_;
  grpc::CompletionQueue queue_;
  std::vector<std::unique_ptr<LoadStream>> streams_;
  std::atomic<std::size_t> next_tick_{0};
};

double Quantile(std::vector<double>& values, double share) {
  if (values.empty()) return 0.0;
  const auto nth =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), nth, values.end());
  return *nth;
}

// Asks at instants fixed beforehand, each stream `hertz` times a second, from `start` to `end`;
// returns how many of them are from `counted_from` on.
long Pace(OpenStreams& streams, double hertz, Clock::time_point start,
          Clock::time_point counted_from, Clock::time_point end) {
  const Seconds gap(1.0 / hertz / static_cast<double>(streams.count()));
  long count = 0;
  for (std::size_t k = 0;; ++k) {
    const Clock::time_point instant =
        start + std::chrono::duration_cast<Clock::duration>(static_cast<double>(k) * gap);
    if (instant >= end) return count;
    count += instant >= counted_from;
    std::this_thread::sleep_until(instant);
    streams.Ask(k % streams.count(), instant);
  }
}

}  // namespace

LoadResult Load(const LoadTarget& target, const LoadPlan& plan) {
  const auto seconds = [](double count) {
    return std::chrono::duration_cast<Clock::duration>(Seconds(count));
  };
  const bool is_paced = plan.hertz > 0.0;
  const Clock::duration period = seconds(is_paced ? 1.0 / plan.hertz : 0.0);
  OpenStreams streams(target, plan.streams);
  const auto start = Clock::now();
  const auto measured_from = start + seconds(0.3 * plan.seconds);
  const auto end = measured_from + seconds(plan.seconds);

  LoadResult result;
  std::vector<double> times;
  long in_window = 0;
  const auto answered = [&](LoadStream& stream, Clock::time_point instant, Clock::time_point now) {
    if (!is_paced && now < end) streams.Ask(stream, now);
    in_window += now >= measured_from && now < end;
    if (instant < measured_from || instant >= end) return;
    times.push_back(Seconds(now - instant).count());
    result.dropped += is_paced && now - instant > period;
  };
  std::jthread pacer;
  if (is_paced) {
    pacer = std::jthread(
        [&] { result.messages = Pace(streams, plan.hertz, start, measured_from, end); });
  } else {
    for (std::size_t k = 0; k < streams.count(); ++k) streams.Ask(k, Clock::now());
  }
  streams.RunUntil(measured_from, answered);
  const double cpu_before = CpuSeconds(target.process);
  streams.RunUntil(end, answered);
  const double cpu = CpuSeconds(target.process) - cpu_before;
  if (is_paced) {
    pacer.join();
    streams.RunUntil(Clock::now() + 10 * period, answered);  // the late ones
    result.dropped += result.messages - static_cast<long>(times.size());
  } else {
    result.messages = in_window;
  }
  const double count = std::max(1.0, static_cast<double>(in_window));
  result.messages_per_second = count / plan.seconds;
  result.server_seconds = cpu / count;
  result.p50 = Quantile(times, 0.5);
  result.p99 = Quantile(times, 0.99);
  return result;
}

double FirstAfterIdle(const LoadTarget& target, double idle, int tries) {
  OpenStreams streams(target, 1);
  std::vector<double> times;
  for (int k = 0; k <= tries; ++k) {  // the first one only begins the next one's waiting
    constexpr auto kWait = std::chrono::milliseconds(150);  // of the idle time, if all goes well
    std::this_thread::sleep_for(Seconds(idle) - kWait);
    bool done = false;
    streams.Ask(0, Clock::now());
    while (!done) {
      streams.RunUntil(Clock::now() + kWait,
                       [&](LoadStream&, Clock::time_point instant, Clock::time_point now) {
                         done = true;
                         times.push_back(Seconds(now - instant).count());
                       });
    }
  }
  times.erase(times.begin());
  return Quantile(times, 0.5);
}

}  // namespace posespace
