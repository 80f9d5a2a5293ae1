// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_RENDER_STREAM_H_
#define POSESPACE_RPC_RENDER_STREAM_H_

#include <chrono>
#include <cstdint>
#include <memory>
#include <mutex>

#include "posespace/v1/pose_service.pb.h"
#include "rpc/compute_pool.h"
#include "rpc/live_streams.h"
#include "rpc/picture_budget.h"
#include "rpc/stream_writer.h"
#include "session/registry.h"

namespace posespace {

// The answer to one Render: pictures in the order of the queries, drawn on a pool one after
// another, at most two ahead of the reader.
class RenderStream final : public StreamWriter<v1::RenderResponse>, private LiveStream {
 public:
  RenderStream(const Registry& registry, LiveStreams& streams, ComputePool& pool,
               PictureBudget& budget, const v1::RenderRequest& request);

 private:
  Result<void> Begin(const Registry& registry);
  Result<v1::RenderResponse> Draw(int index) const;
  void Continue();
  void DrawNext();
  void OnWritten(std::size_t waiting) override;
  void OnEnd() override;
  void Beat(std::chrono::steady_clock::time_point) override {}
  void Drain(std::chrono::milliseconds) override {}  // pictures are few: they may all be drawn

  LiveStreams& streams_;
  ComputePool& pool_;
  PictureBudget& budget_;
  const v1::RenderRequest& request_;  // gRPC keeps it for the call
  std::shared_ptr<const PoseSpace> pose_space_;
  View view_;
  bool added_ = false;
  std::int64_t reserved_ = 0;  // of the budget: as many pictures as may wait

  std::mutex mutex_;
  int next_ = 0;   // the query to draw next
  int ahead_ = 0;  // pictures drawn and not yet written
  bool drawing_ = true;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_RENDER_STREAM_H_
