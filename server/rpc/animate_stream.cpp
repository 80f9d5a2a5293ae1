// SPDX-License-Identifier: Apache-2.0
#include "rpc/animate_stream.h"

#include <algorithm>
#include <utility>

#include "rpc/query_convert.h"

namespace posespace {
namespace {

constexpr int kAhead = 32;  // frames; a slow reader holds some 100 kB
constexpr int kTurn = 16;   // frames; solved together

}  // namespace

AnimateStream::AnimateStream(const Registry& registry, LiveStreams& streams, ComputePool& pool,
                             ComputePool& loads, const v1::AnimateRequest& request)
    : SequenceStream(Call("Animate"), streams, pool, kAhead, kTurn), request_(request) {
  BeginWith(request_.session_id(), registry, loads,
            [this, &limits = registry.limits()](const std::shared_ptr<Session>& session) {
              return Begin(*session, limits);
            });
  Release();
}

Result<void> AnimateStream::Begin(const Session& session, const Limits& limits) {
  pose_space_ = TRY(session.Built());
  TRY(CheckRevision(*pose_space_, request_.revision()));
  frames_ = TRY(AnimationFrames::From(request_.animation(), limits.max_animation_frames));
  start_ = Clock::now();
  return Start(frames_->count());
}

Result<v1::AnimateResponse> AnimateStream::Make(int index) {
  const Frame frame = TRY(FrameAt(index));
  const Query query = frames_->At(index);
  const Point& at = std::get<Point>(query.position);
  v1::AnimateResponse response;
  response.set_index(index);
  response.set_time(frames_->TimeOf(index));
  response.mutable_at()->set_x(at.x());
  response.mutable_at()->set_y(at.y());
  ToProto(frame, /*with_weights=*/true, response.mutable_frame());
  response.set_revision(pose_space_->revision());
  return response;
}

Result<Frame> AnimateStream::FrameAt(int index) {
  if (index >= first_solved_ + static_cast<int>(solved_.size())) {
    std::vector<Query> queries;
    for (int k = index; k < std::min(index + kTurn, frames_->count()); ++k) {
      queries.push_back(frames_->At(k));
    }
    solved_ = pose_space_->BlendAll(queries);
    first_solved_ = index;
  }
  return std::move(solved_[index - first_solved_]);
}

AnimateStream::Clock::time_point AnimateStream::Due(int index) const {
  if (!request_.paced()) return Clock::time_point::min();
  return start_ + std::chrono::duration_cast<Clock::duration>(
                      std::chrono::duration<double>(frames_->TimeOf(index)));
}

}  // namespace posespace
