// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_STREAM_WRITER_H_
#define POSESPACE_RPC_STREAM_WRITER_H_

#include <grpcpp/support/server_callback.h>
#include <grpcpp/support/status.h>

#include <cstddef>
#include <deque>
#include <memory>
#include <mutex>
#include <string>
#include <utility>

#include "geometry/result.h"
#include "rpc/call.h"
#include "rpc/compute_pool.h"
#include "session/registry.h"

namespace posespace {

// The server's side of a call that answers with a stream, with gRPC's rules kept for the subclass:
// one write at a time, exactly one Finish, nothing after it, and no end while somebody still works
// on the call.  Thread-safe.  Deletes itself when the call is done.
//
// A thread that works on the call holds it (Hold, Release), also when the caller goes away
// meanwhile. The call begins held, so that a subclass can be set up; it calls Release when it is.
template <typename Response>
class StreamWriter : public grpc::ServerWriteReactor<Response> {
 public:
  explicit StreamWriter(Call call) : call_(call) {}

  // Queues a message.  Without effect once the call is closing.
  void Write(Response message) {
    const std::scoped_lock lock(mutex_);
    if (closing_) return;
    queue_.push_back(std::move(message));
    if (!writing_) StartNextWrite();
  }

  // Ends the call after all that is queued.  The first outcome counts.
  void Close(Result<void> outcome) {
    bool finish = false;
    {
      const std::scoped_lock lock(mutex_);
      CloseLocked(std::move(outcome));
      finish = MayFinish();
    }
    if (finish) FinishNow();
  }

  void Hold() {
    const std::scoped_lock lock(mutex_);
    ++holds_;
  }

  // The object may be gone when this returns.
  void Release() {
    bool finish = false;
    {
      const std::scoped_lock lock(mutex_);
      --holds_;
      finish = MayFinish();
    }
    if (finish) FinishNow();
  }

  // True when nothing that is written any more can arrive.
  bool closing() const {
    const std::scoped_lock lock(mutex_);
    return closing_;
  }

 protected:
  // Sets the call up by begin(session), which closes it with its error: at once when the session is
  // in memory, else on a pool, which loads it.
  template <typename Begin>
  void BeginWith(const std::string& session_id, const Registry& registry, ComputePool& pool,
                 Begin begin) {
    const auto run = [this, begin](Result<std::shared_ptr<Session>> session) {
      auto begun = Guarded([&]() -> Result<void> { return begin(TRY(std::move(session))); });
      if (!begun) Close(std::move(begun));
    };
    auto session = registry.Peek(session_id);
    if (!session || *session != nullptr) return run(std::move(session));
    Hold();
    const bool posted = pool.TryPost([this, run, &session_id, &registry] {
      run(Guarded([&] { return registry.Find(session_id); }));
      Release();
    });
    if (posted) return;
    Close(Error{ErrorCode::kComputeQueueFull, "too much work is waiting; try again later", {}});
    Release();
  }

  // A message has been written and `waiting` more are queued; the call is held meanwhile.
  virtual void OnWritten(std::size_t /*waiting*/) {}

  // The call is over and about to be deleted; nothing runs beside this.
  virtual void OnEnd() {}

 private:
  void OnWriteDone(bool ok) final {
    std::size_t waiting = 0;
    {
      const std::scoped_lock lock(mutex_);
      writing_ = false;
      queue_.pop_front();
      if (!ok) Abandon();
      if (!queue_.empty()) StartNextWrite();
      waiting = queue_.size();
      ++holds_;
    }
    OnWritten(waiting);
    Release();
  }

  void OnCancel() final {
    bool finish = false;
    {
      const std::scoped_lock lock(mutex_);
      Abandon();
      finish = MayFinish();
    }
    if (finish) FinishNow();
  }

  void OnDone() final {
    OnEnd();
    delete this;
  }

  void StartNextWrite() {
    writing_ = true;
    this->StartWrite(&queue_.front());
  }

  // The caller is gone: what is queued is dropped, except a message that gRPC is writing.
  void Abandon() {
    CloseLocked(Error{ErrorCode::kCancelled, "the caller went away", {}});
    queue_.resize(writing_ ? 1 : 0);
  }

  void CloseLocked(Result<void> outcome) {
    if (closing_) return;
    closing_ = true;
    outcome_ = std::move(outcome);
  }

  bool MayFinish() {
    if (finished_ || !closing_ || writing_ || holds_ > 0) return false;
    finished_ = true;
    return true;
  }

  // Outside the lock: the object may be deleted before Finish returns.
  void FinishNow() { this->Finish(call_.End(std::move(outcome_))); }

  const Call call_;
  mutable std::mutex mutex_;
  std::deque<Response> queue_;  // its front is being written while writing_
  Result<void> outcome_;
  int holds_ = 1;
  bool writing_ = false;
  bool closing_ = false;
  bool finished_ = false;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_STREAM_WRITER_H_
