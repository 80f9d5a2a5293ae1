// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_SUGGEST_CALL_H_
#define POSESPACE_RPC_SUGGEST_CALL_H_

#include <grpcpp/support/server_callback.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <string_view>

#include "geometry/progress.h"
#include "posespace/v1/session_service.pb.h"
#include "rpc/call.h"
#include "rpc/compute_pool.h"
#include "rpc/live_streams.h"
#include "session/registry.h"

namespace posespace {

// The answer to one SuggestCorrespondences: matched on a pool, as long as a build may take, and
// stopped when the caller goes away or the service ends.  Deletes itself when the call is done.
class SuggestCall final : public grpc::ServerUnaryReactor, private LiveStream {
 public:
  // gRPC keeps request and response for the call.
  SuggestCall(const Registry& registry, LiveStreams& streams, ComputePool& pool,
              const v1::SuggestCorrespondencesRequest& request,
              v1::SuggestCorrespondencesResponse& response);

 private:
  using Clock = std::chrono::steady_clock;

  Result<void> Begin(ComputePool& pool);
  void Work();
  Result<void> Suggest();
  void StopInTime();
  Error Stopped() const;  // why the work was

  void OnCancel() override { progress_.Cancel(); }
  void OnDone() override;
  void Beat(Clock::time_point) override {}  // the work looks at the clock itself
  void Drain(std::chrono::milliseconds grace) override { drain_by_ = Clock::now() + grace; }

  const Call call_{"SuggestCorrespondences"};
  const Registry& registry_;
  LiveStreams& streams_;
  const v1::SuggestCorrespondencesRequest& request_;
  v1::SuggestCorrespondencesResponse& response_;
  const std::chrono::seconds time_limit_;
  std::shared_ptr<Session> session_;  // null until the work begins for one that must be loaded
  bool added_ = false;                // to streams_
  Progress progress_{[this](std::string_view, double) { StopInTime(); }};
  Clock::time_point overdue_ = Clock::time_point::max();  // used by the work, set when it begins
  std::atomic<Clock::time_point> drain_by_{Clock::time_point::max()};
};

}  // namespace posespace

#endif  // POSESPACE_RPC_SUGGEST_CALL_H_
