// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_PLAY_STREAM_H_
#define POSESPACE_RPC_PLAY_STREAM_H_

#include <atomic>
#include <chrono>
#include <cstddef>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

#include "geometry/result.h"
#include "posespace/v1/pose_service.pb.h"
#include "rpc/fifo.h"
#include "rpc/message_bytes.h"
#include "rpc/play_request.h"
#include "rpc/play_slots.h"
#include "session/limits.h"

namespace posespace {

// What a Play stream asks of whatever carries it.  No call may come back into the stream before it
// returns, except from another thread.
class PlayTransport {
 public:
  // Reads the next message; then OnRead.
  virtual void StartRead(v1::PlayRequest* message) = 0;
  // Writes a PlayResponse; then OnWritten.
  virtual void StartWrite(MessageBytes message) = 0;
  // Has PlayStream::Work called on a thread that may be busy for long.
  virtual void ScheduleWork() = 0;
  // The same on a thread that may wait for a disk.
  virtual void ScheduleLoad() = 0;
  // The last call.  The stream may be deleted once all that was started has come back.
  virtual void Finish(Result<void> outcome) = 0;

 protected:
  ~PlayTransport() = default;
};

// What a Play stream does with time and order: it reads ahead, answers one message after another,
// writes one message at a time, beats, drains and ends.  What it answers is play_slots.h; it knows
// no gRPC.  Thread-safe: events may come from any thread.
//
// A frame is in flight from being read until its result is written; at most max_in_flight are,
// and nothing more is answered while kQueuedBytes wait to be written.  So a slow reader costs only
// itself.  The stream ends when the client has said all and got its answers, by a breach of the
// protocol, by cancellation, or when it outlives its draining, which comes with its age at the
// latest: gRPC has no greatest age of a stream, and new replicas would never get load.
//
// Requests are read into one piece of memory each (play_request.h), and answers are written once
// (play_tick.h): a steady stream allocates nothing for an item.
class PlayStream {
 public:
  using Clock = PlaySlots::Clock;

  static constexpr std::size_t kQueuedBytes = 4 << 20;
  static constexpr std::chrono::seconds kHeartbeat{10};
  static constexpr std::chrono::seconds kOldGrace{
      30};                                     // in which the client of an old stream moves
  static constexpr double kShortWork = 100.0;  // microseconds that may pass on the reading thread

  // The stream drains by itself at its first beat after `old_at`.  `now` is what its slots ask.
  PlayStream(const Registry& registry, const Limits& limits, PlayTransport& transport,
             Clock::time_point old_at = Clock::time_point::max(), PlaySlots::Now now = &Clock::now);

  // Says Welcome and begins to read.
  void Start();

  void OnRead(bool ok);     // not ok: the client has said all
  void OnWritten(bool ok);  // not ok: the client is gone
  void OnCancelled();
  void Work();  // answers one message

  // Says Heartbeat after a silence, RevisionChanged without waiting for a frame, and Draining when
  // the stream is old.
  void Beat(Clock::time_point now);

  // Says Draining; a client that has not ended after the time is cut off.
  void Drain(std::chrono::milliseconds stop_sending_in, Clock::time_point now = Clock::now());

 private:
  struct Outgoing {
    MessageBytes message;  // none once it is being written
    std::size_t bytes;
    bool completes = false;  // the last answer to a message that was read
  };
  enum class Then { kWait, kWorkHere, kScheduleWork, kScheduleLoad, kFinish };
  struct Next {
    std::optional<MessageBytes> write;
    v1::PlayRequest* read = nullptr;
    Then then = Then::kWait;
  };

  void FindSuperseded(PlaySlots::Tags* tags) const;
  void StartDraining(std::chrono::milliseconds stop_sending_in, Clock::time_point now);
  void Queue(MessageBytes message);
  void End(Result<void> outcome);
  void TakeSpare();
  Next Advance(bool may_work_here);
  void Do(Next next);
  bool MayFinish();

  PlayTransport& transport_;
  const std::size_t max_in_flight_;
  const Clock::time_point old_at_;
  // Used by whoever set working_, or under the lock while it is not set.
  PlaySlots slots_;
  PlaySlots::Tags superseded_;
  std::vector<MessageBytes> answers_;

  std::mutex mutex_;
  std::unique_ptr<ReusedRequest> incoming_;
  Fifo<std::unique_ptr<ReusedRequest>> waiting_;  // not yet answered; the front is worked on
  std::vector<std::unique_ptr<ReusedRequest>> spare_;
  Fifo<Outgoing> outgoing_;  // its front is being written while writing_
  std::size_t queued_bytes_ = 0;
  std::size_t in_flight_ = 0;
  bool reading_ = false;
  bool writing_ = false;
  bool working_ = false;
  bool all_said_ = false;
  bool gone_ = false;  // nothing can be written any more
  bool finished_ = false;
  std::optional<Result<void>> outcome_;  // set: no further message is answered
  Clock::time_point last_said_ = Clock::now();
  std::optional<Clock::time_point> cut_off_;

  // Reads that are decided on and not yet started, each kStarting, and kFinishWaits when whoever
  // starts the last of them must finish.
  static constexpr unsigned kFinishWaits = 1, kStarting = 2;
  std::atomic<unsigned> starting_{0};
};

}  // namespace posespace

#endif  // POSESPACE_RPC_PLAY_STREAM_H_
