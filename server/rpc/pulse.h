// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_PULSE_H_
#define POSESPACE_RPC_PULSE_H_

#include <grpcpp/server.h>

#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace posespace {

// Four times a second: calls `beat`, and keeps gRPC awake.
//
// gRPC's callback threads fall asleep for 100 ms at a time when a second passes without an event,
// so that messages a little more than a second apart would wait for up to 100 ms.  A small call
// from the server to itself is such an event.
class Pulse {
 public:
  using Beat = std::function<void(std::chrono::steady_clock::time_point now)>;

  // `server` outlives this.
  Pulse(grpc::Server& server, Beat beat);
  ~Pulse();
  Pulse(const Pulse&) = delete;
  Pulse& operator=(const Pulse&) = delete;

 private:
  void Run(grpc::Server& server);

  const Beat beat_;
  std::mutex mutex_;
  std::condition_variable stop_;
  bool stopping_ = false;
  std::thread thread_;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_PULSE_H_
