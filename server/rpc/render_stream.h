// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_RENDER_STREAM_H_
#define POSESPACE_RPC_RENDER_STREAM_H_

#include <cstdint>
#include <memory>
#include <optional>

#include "posespace/v1/pose_service.pb.h"
#include "rpc/animation_frames.h"
#include "rpc/picture_budget.h"
#include "rpc/sequence_stream.h"
#include "session/registry.h"

namespace posespace {

// The answer to one Render: pictures in the order of the queries, or along an animation's path.
class RenderStream final : public SequenceStream<v1::RenderResponse> {
 public:
  RenderStream(const Registry& registry, LiveStreams& streams, ComputePool& pool,
               PictureBudget& budget, const v1::RenderRequest& request);

 private:
  Result<void> Begin(const Session& session, const Limits& limits);
  Result<v1::RenderResponse> Make(int index) override;
  void OnEnd() override;

  PictureBudget& budget_;
  const v1::RenderRequest& request_;  // gRPC keeps it for the call
  std::shared_ptr<const PoseSpace> pose_space_;
  std::optional<AnimationFrames> frames_;  // without: the request's queries
  View view_;
  PaintEdges edges_ = PaintEdges::kCrisp;
  std::int64_t reserved_ = 0;  // of the budget: as many pictures as may wait
};

}  // namespace posespace

#endif  // POSESPACE_RPC_RENDER_STREAM_H_
