// SPDX-License-Identifier: Apache-2.0
#include "rpc/render_stream.h"

#include <utility>
#include <vector>

#include "drawing/png_file.h"
#include "rpc/query_convert.h"

namespace posespace {
namespace {

constexpr int kAhead = 2;  // pictures
constexpr int kTurn = 1;

}  // namespace

RenderStream::RenderStream(const Registry& registry, LiveStreams& streams, ComputePool& pool,
                           PictureBudget& budget, const v1::RenderRequest& request)
    : SequenceStream(Call("Render"), streams, pool, kAhead, kTurn),
      budget_(budget),
      request_(request) {
  BeginWith(request_.session_id(), registry, pool,
            [this, &limits = registry.limits()](const std::shared_ptr<Session>& session) {
              return Begin(*session, limits);
            });
  Release();
}

Result<void> RenderStream::Begin(const Session& session, const Limits& limits) {
  if (request_.has_animation() && request_.queries_size() > 0) {
    return ErrorAt(ErrorCode::kInvalidOption, "animation", "is given beside queries");
  }
  if (!request_.has_animation()) {
    TRY(CheckQueryCount(request_.queries_size(), limits.max_queries));
  }
  pose_space_ = TRY(session.Built());
  view_ = TRY(ViewFromProto(request_, *pose_space_, limits.max_render_side));
  edges_ = TRY(EdgesFromProto(request_.edges()));
  if (request_.has_animation()) {
    frames_ = TRY(AnimationFrames::From(request_.animation(), limits.max_render_frames));
  }
  // Queries are checked before the first picture, so that a bad one costs nothing.
  for (int k = 0; k < request_.queries_size(); ++k) {
    TRY(BlendQuery(*pose_space_, request_.queries(k), QueryField(k), /*weights_only=*/true));
  }
  const std::int64_t bytes = std::int64_t{4} * kAhead * view_.width * view_.height;
  if (!budget_.TryTake(bytes)) {
    return Error{ErrorCode::kComputeQueueFull,
                 "too many large pictures wait to be read; try again later",
                 {}};
  }
  reserved_ = bytes;
  return Start(frames_ ? frames_->count() : request_.queries_size());
}

Result<v1::RenderResponse> RenderStream::Make(int index) {
  Frame frame = frames_ ? TRY(pose_space_->Blend(frames_->At(index)))
                        : TRY(BlendQuery(*pose_space_, request_.queries(index), QueryField(index),
                                         /*weights_only=*/false));
  const Image image = pose_space_->Render(frame, view_, edges_);
  v1::RenderResponse response;
  response.set_index(index);
  if (request_.format() == v1::IMAGE_FORMAT_RGBA) {
    response.mutable_image()->assign(image.rgba.begin(), image.rgba.end());
  } else {
    const std::vector<std::uint8_t> png = EncodePng(image);
    response.mutable_image()->assign(png.begin(), png.end());
  }
  frame.vertices.resize(0, 2);
  ToProto(frame, /*with_weights=*/true, response.mutable_frame());
  response.set_revision(pose_space_->revision());
  return response;
}

void RenderStream::OnEnd() {
  SequenceStream::OnEnd();
  budget_.Return(reserved_);
}

}  // namespace posespace
