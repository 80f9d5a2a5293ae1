// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_SEQUENCE_STREAM_H_
#define POSESPACE_RPC_SEQUENCE_STREAM_H_

#include <grpcpp/alarm.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <optional>
#include <utility>

#include "rpc/compute_pool.h"
#include "rpc/live_streams.h"
#include "rpc/stream_writer.h"

namespace posespace {

// A call that answers with a known number of messages, made on a pool one after another, a few
// ahead of the reader, each not before it is due.  When the service ends it has the grace to
// finish, and is cut off with DRAINING.
template <typename Response>
class SequenceStream : public StreamWriter<Response>, private LiveStream {
 public:
  using Clock = std::chrono::steady_clock;

 protected:
  // At most `ahead` messages are made and not yet written; a turn on the pool makes at most `turn`
  // of them before others have theirs.
  SequenceStream(Call call, LiveStreams& streams, ComputePool& pool, int ahead, int turn)
      : StreamWriter<Response>(call), streams_(streams), pool_(pool), ahead_(ahead), turn_(turn) {}

  // Begins to make messages 0 .. count - 1; in the subclass's constructor, when it is set up.
  // Fails  kStreamLimit, kDraining, kComputeQueueFull.
  Result<void> Start(int count) {
    count_ = count;
    TRY(streams_.Add(this));
    added_ = true;
    working_ = true;
    this->Hold();
    if (pool_.TryPost([this] { Work(); })) return {};
    this->Release();
    return Error{ErrorCode::kComputeQueueFull, "too much work is waiting; try again later", {}};
  }

  // Message `index`; in order, on the pool.  An error ends the call.
  virtual Result<Response> Make(int index) = 0;

  // When message `index` may be sent.
  virtual Clock::time_point Due(int /*index*/) const { return Clock::time_point::min(); }

  void OnEnd() override {
    if (added_) streams_.Remove(this);
  }

 private:
  // On the pool or the alarm's thread; the call is held, and nobody else makes messages.
  void Work() {
    if (Clock::now() > drain_by_.load()) {
      this->Close(Error{ErrorCode::kDraining, "the service ends; ask another, or later", {}});
    }
    for (int made = 0; made < turn_ && MayMake() && Due(next_) <= Clock::now(); ++made) {
      auto message = Guarded([this] { return Make(next_); });
      if (!message) {
        this->Close(std::move(message).error());
        break;
      }
      {
        const std::scoped_lock lock(mutex_);
        ++waiting_;
        ++next_;
      }
      this->Write(std::move(*message));
    }
    if (next_ == count_) this->Close({});
    {
      const std::scoped_lock lock(mutex_);
      working_ = false;
    }
    Continue();
    this->Release();
  }

  bool MayMake() const {
    const std::scoped_lock lock(mutex_);
    return waiting_ < ahead_ && next_ < count_ && !this->closing();
  }

  // Makes the next messages if there are any to make and nobody is at it.
  void Continue() {
    if (!MayMake()) return;
    {
      const std::scoped_lock lock(mutex_);
      if (working_) return;
      working_ = true;
    }
    this->Hold();
    const Clock::time_point due = Due(next_), now = Clock::now();
    if (due <= now) {
      pool_.Post([this] { Work(); });
      return;
    }
    // In slices, so that a caller who goes away or a service that ends need not wait for long.
    constexpr auto kSlice = std::chrono::milliseconds(100);
    const auto slice = std::min<Clock::duration>(due - now, kSlice);
    alarm_.emplace();  // anew: the callback of the last one may not have returned yet
    alarm_->Set(std::chrono::system_clock::now() +
                    std::chrono::duration_cast<std::chrono::system_clock::duration>(slice),
                [this](bool /*fired*/) { pool_.Post([this] { Work(); }); });
  }

  void OnWritten(std::size_t /*waiting*/) override {
    {
      const std::scoped_lock lock(mutex_);
      --waiting_;
    }
    Continue();
  }

  void Beat(Clock::time_point) override {}
  void Drain(std::chrono::milliseconds grace) override { drain_by_ = Clock::now() + grace; }

  LiveStreams& streams_;
  ComputePool& pool_;
  const int ahead_;
  const int turn_;
  int count_ = 0;
  bool added_ = false;
  std::optional<grpc::Alarm> alarm_;  // used by who works
  std::atomic<Clock::time_point> drain_by_{Clock::time_point::max()};

  mutable std::mutex mutex_;
  int next_ = 0;     // the message to make next; changed by who works
  int waiting_ = 0;  // made and not yet written
  bool working_ = false;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_SEQUENCE_STREAM_H_
