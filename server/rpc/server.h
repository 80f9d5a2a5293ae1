// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_SERVER_H_
#define POSESPACE_RPC_SERVER_H_

#include <grpcpp/server.h>

#include <chrono>
#include <cstddef>
#include <memory>
#include <string>

#include "geometry/result.h"
#include "rpc/compute_pool.h"
#include "rpc/live_streams.h"
#include "rpc/pose_service.h"
#include "rpc/pulse.h"
#include "rpc/session_service.h"
#include "session/limits.h"
#include "session/registry.h"
#include "store/store.h"

namespace posespace {

// The whole service at one address.  Ends in three steps: BeginDrain, a while in which open streams
// end, Shutdown.
class Server {
 public:
  // `listen` is ADDR:PORT, port 0 for any, or unix:PATH; without a store sessions end with the
  // server.  Fails with kInvalidOption when nothing can listen there, and as Registry::Open.
  static Result<std::unique_ptr<Server>> Start(const std::string& listen, const Limits& limits,
                                               std::shared_ptr<Store> store = nullptr);

  ~Server();
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  const std::string& address() const { return address_; }  // as one connects to it
  int port() const { return port_; }                       // 0 for a Unix socket
  std::size_t open_streams() const { return streams_.count(); }

  // Health says NOT_SERVING, builds are cancelled, open streams are told to end within `grace`, and
  // new streams and builds are refused.  Other calls are still answered.
  void BeginDrain(std::chrono::milliseconds grace);

  // Waits at most `patience` for calls to end, then cuts them off.
  void Shutdown(std::chrono::milliseconds patience);

 private:
  explicit Server(std::unique_ptr<Registry> registry);

  // In the order in which they may be destroyed from the last to the first: services use the pools,
  // streams and registry above them.
  const std::unique_ptr<Registry> registry_;
  LiveStreams streams_;
  ComputePool blend_pool_;
  ComputePool bulk_pool_;
  ComputePool matching_pool_;
  SessionService session_service_;
  PoseService pose_service_;
  std::unique_ptr<grpc::Server> server_;
  std::unique_ptr<Pulse> pulse_;
  std::string address_;
  int port_ = 0;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_SERVER_H_
