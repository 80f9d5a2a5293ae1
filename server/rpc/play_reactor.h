// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_PLAY_REACTOR_H_
#define POSESPACE_RPC_PLAY_REACTOR_H_

#include <grpcpp/support/server_callback.h>

#include <chrono>

#include "posespace/v1/pose_service.pb.h"
#include "rpc/call.h"
#include "rpc/compute_pool.h"
#include "rpc/live_streams.h"
#include "rpc/message_bytes_traits.h"
#include "rpc/play_stream.h"
#include "session/registry.h"

namespace posespace {

// Carries a PlayStream over gRPC; decides nothing.  Deletes itself when the call is done.
class PlayReactor final : public grpc::ServerBidiReactor<v1::PlayRequest, MessageBytes>,
                          private PlayTransport,
                          private LiveStream {
 public:
  // Long blends run on `blends`; sessions are loaded on `loads`.
  PlayReactor(const Registry& registry, LiveStreams& streams, ComputePool& blends,
              ComputePool& loads);

 private:
  void OnReadDone(bool ok) override { stream_.OnRead(ok); }
  void OnWriteDone(bool ok) override { stream_.OnWritten(ok); }
  void OnCancel() override;
  void OnDone() override;

  void StartRead(v1::PlayRequest* message) override { ServerBidiReactor::StartRead(message); }
  void StartWrite(MessageBytes message) override;
  void ScheduleWork() override {
    blends_.Post([this] { stream_.Work(); });
  }
  void ScheduleLoad() override {
    loads_.Post([this] { stream_.Work(); });
  }
  void Finish(Result<void> outcome) override {
    ServerBidiReactor::Finish(call_.End(std::move(outcome)));
  }

  void Beat(std::chrono::steady_clock::time_point now) override { stream_.Beat(now); }
  void Drain(std::chrono::milliseconds grace) override { stream_.Drain(grace); }

  const Call call_{"Play"};
  LiveStreams& streams_;
  ComputePool& blends_;
  ComputePool& loads_;
  MessageBytes outgoing_;
  PlayStream stream_;
  bool admitted_ = false;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_PLAY_REACTOR_H_
