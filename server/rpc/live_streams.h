// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_LIVE_STREAMS_H_
#define POSESPACE_RPC_LIVE_STREAMS_H_

#include <array>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <unordered_set>

#include "geometry/result.h"

namespace posespace {

// What an open stream is told from outside.  Neither call may block.
class LiveStream {
 public:
  // About once a second.
  virtual void Beat(std::chrono::steady_clock::time_point now) = 0;

  // The service ends: finish within the time.
  virtual void Drain(std::chrono::milliseconds grace) = 0;

 protected:
  ~LiveStream() = default;
};

// All open streams: gRPC limits neither their number nor tells them that the service ends.
// Thread-safe.
class LiveStreams {
 public:
  explicit LiveStreams(int limit) : limit_(static_cast<std::size_t>(limit)) {}

  // Fails with kStreamLimit, kDraining.  An added stream is removed before it is deleted.
  Result<void> Add(LiveStream* stream);
  void Remove(LiveStream* stream);

  // Beats a quarter of the streams, the next quarter the next time; called four times a second.
  void Beat(std::chrono::steady_clock::time_point now);

  // Tells every stream, and lets no new one begin.
  void Drain(std::chrono::milliseconds grace);

  std::size_t count() const;

 private:
  std::size_t CountLocked() const;

  const std::size_t limit_;
  mutable std::mutex mutex_;
  std::array<std::unordered_set<LiveStream*>, 4> quarters_;
  std::size_t next_ = 0;
  bool draining_ = false;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_LIVE_STREAMS_H_
