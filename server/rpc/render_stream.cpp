// SPDX-License-Identifier: Apache-2.0
#include "rpc/render_stream.h"

#include <string>
#include <utility>
#include <vector>

#include "drawing/decode.h"
#include "rpc/query_convert.h"

namespace posespace {
namespace {

constexpr int kAhead = 2;

}  // namespace

RenderStream::RenderStream(const Registry& registry, LiveStreams& streams, ComputePool& pool,
                           PictureBudget& budget, const v1::RenderRequest& request)
    : StreamWriter(Call("Render")),
      streams_(streams),
      pool_(pool),
      budget_(budget),
      request_(request) {
  if (auto begun = Guarded([&] { return Begin(registry); }); !begun) Close(std::move(begun));
  Release();
}

Result<void> RenderStream::Begin(const Registry& registry) {
  const auto session = TRY(registry.Find(request_.session_id()));
  TRY(CheckQueryCount(request_.queries_size(), registry.limits().max_queries));
  pose_space_ = TRY(session->Built());
  view_ = TRY(ViewFromProto(request_, *pose_space_, registry.limits().max_render_side));
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
  TRY(streams_.Add(this));
  added_ = true;
  Hold();
  if (pool_.TryPost([this] { DrawNext(); })) return {};
  Release();
  return Error{ErrorCode::kComputeQueueFull, "too much work is waiting; try again later", {}};
}

// On the pool; the call is held, and nobody else draws.
void RenderStream::DrawNext() {
  if (!closing()) {
    auto picture = Guarded([&] { return Draw(next_); });
    if (picture) {
      Write(std::move(*picture));
    } else {
      Close(std::move(picture).error());
    }
  }
  bool last = false;
  {
    const std::scoped_lock lock(mutex_);
    drawing_ = false;
    ++ahead_;
    last = ++next_ == request_.queries_size();
  }
  last ? Close({}) : Continue();
  Release();
}

void RenderStream::Continue() {
  {
    const std::scoped_lock lock(mutex_);
    if (drawing_ || ahead_ >= kAhead || next_ == request_.queries_size() || closing()) return;
    drawing_ = true;
  }
  Hold();
  pool_.Post([this] { DrawNext(); });
}

void RenderStream::OnWritten(std::size_t /*waiting*/) {
  {
    const std::scoped_lock lock(mutex_);
    --ahead_;
  }
  Continue();
}

Result<v1::RenderResponse> RenderStream::Draw(int index) const {
  Frame frame = TRY(BlendQuery(*pose_space_, request_.queries(index), QueryField(index),
                               /*weights_only=*/false));
  const Image image = pose_space_->Render(frame, view_);
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
  if (added_) streams_.Remove(this);
  budget_.Return(reserved_);
}

}  // namespace posespace
