// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_ANIMATE_STREAM_H_
#define POSESPACE_RPC_ANIMATE_STREAM_H_

#include <memory>
#include <optional>
#include <vector>

#include "posespace/v1/pose_service.pb.h"
#include "rpc/animation_frames.h"
#include "rpc/sequence_stream.h"
#include "session/registry.h"

namespace posespace {

// The answer to one Animate: frames along a path, all of one revision.
class AnimateStream final : public SequenceStream<v1::AnimateResponse> {
 public:
  // Frames are made on `pool`; a session that must be loaded is, on `loads`.
  AnimateStream(const Registry& registry, LiveStreams& streams, ComputePool& pool,
                ComputePool& loads, const v1::AnimateRequest& request);

 private:
  Result<void> Begin(const Session& session, const Limits& limits);
  Result<v1::AnimateResponse> Make(int index) override;
  Clock::time_point Due(int index) const override;
  Result<Frame> FrameAt(int index);

  const v1::AnimateRequest& request_;  // gRPC keeps it for the call
  std::shared_ptr<const PoseSpace> pose_space_;
  std::optional<AnimationFrames> frames_;
  Clock::time_point start_;
  std::vector<Result<Frame>> solved_;  // together, a few ahead of what was asked for
  int first_solved_ = 0;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_ANIMATE_STREAM_H_
