// SPDX-License-Identifier: Apache-2.0
#include "rpc/build_watch.h"

#include <utility>

#include "rpc/convert.h"

namespace posespace {

BuildWatch::BuildWatch(const Registry& registry, LiveStreams& streams, ComputePool& pool,
                       const v1::WatchBuildRequest& request)
    : StreamWriter(Call("WatchBuild")), streams_(streams), request_(request) {
  BeginWith(request_.session_id(), registry, pool,
            [this](const std::shared_ptr<Session>& session) { return Begin(*session); });
  Release();
}

Result<void> BuildWatch::Begin(const Session& session) {
  auto job = session.LatestBuild();
  if (!job) {
    return Error{
        ErrorCode::kBuildNotFound, "session '" + session.id() + "' has had no build yet", {}};
  }
  TRY(streams_.Add(this));
  // A number beyond the build's own is not of this session, which may have been made anew.
  const bool resumed = request_.after_sequence() <= job->Status().sequence;
  after_sequence_ = resumed ? request_.after_sequence() : 0;
  job_ = std::move(job);
  token_ = job_->Watch([this](const BuildStatus& status) { OnChange(status); });
  return {};
}

void BuildWatch::OnChange(const BuildStatus& status) {
  const std::scoped_lock lock(mutex_);
  newest_ = status;
  if (!sending_) SendNewest();
}

void BuildWatch::OnWritten(std::size_t waiting) {
  if (waiting > 0) return;
  const std::scoped_lock lock(mutex_);
  sending_ = false;
  SendNewest();
}

void BuildWatch::SendNewest() {
  if (!newest_) return;
  const BuildStatus status = std::move(*std::exchange(newest_, std::nullopt));
  if (status.sequence > after_sequence_) {
    v1::WatchBuildResponse response;
    ToProto(status, response.mutable_build());
    sending_ = true;
    Write(std::move(response));
  }
  if (status.ended()) Close({});
}

void BuildWatch::OnEnd() {
  if (!job_) return;
  job_->Unwatch(token_);
  streams_.Remove(this);
}

}  // namespace posespace
