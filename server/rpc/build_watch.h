// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_BUILD_WATCH_H_
#define POSESPACE_RPC_BUILD_WATCH_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>

#include "posespace/v1/session_service.pb.h"
#include "rpc/compute_pool.h"
#include "rpc/live_streams.h"
#include "rpc/stream_writer.h"
#include "session/build_job.h"
#include "session/registry.h"

namespace posespace {

// The answer to one WatchBuild: a build's state after each change, the newest only when the reader
// is slower than the changes.
class BuildWatch final : public StreamWriter<v1::WatchBuildResponse>, private LiveStream {
 public:
  // A session that must be loaded is, on `pool`.
  BuildWatch(const Registry& registry, LiveStreams& streams, ComputePool& pool,
             const v1::WatchBuildRequest& request);

 private:
  Result<void> Begin(const Session& session);
  void OnChange(const BuildStatus& status);
  void SendNewest();  // under mutex_
  void OnWritten(std::size_t waiting) override;
  void OnEnd() override;
  void Beat(std::chrono::steady_clock::time_point) override {}
  void Drain(std::chrono::milliseconds) override {}  // the build ends, and so this

  LiveStreams& streams_;
  const v1::WatchBuildRequest& request_;  // gRPC keeps it for the call
  std::shared_ptr<BuildJob> job_;
  std::int64_t token_ = 0;
  std::int64_t after_sequence_ = 0;
  std::mutex mutex_;
  std::optional<BuildStatus> newest_;  // not sent yet
  bool sending_ = false;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_BUILD_WATCH_H_
