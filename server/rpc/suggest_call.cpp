// SPDX-License-Identifier: Apache-2.0
#include "rpc/suggest_call.h"

#include <string>
#include <utility>

#include "rpc/convert.h"

namespace posespace {

SuggestCall::SuggestCall(const Registry& registry, LiveStreams& streams, ComputePool& pool,
                         const v1::SuggestCorrespondencesRequest& request,
                         v1::SuggestCorrespondencesResponse& response)
    : registry_(registry),
      streams_(streams),
      request_(request),
      response_(response),
      time_limit_(registry.limits().build_timeout) {
  auto begun = Guarded([&] { return Begin(pool); });
  if (!begun) Finish(call_.End(std::move(begun)));
}

Result<void> SuggestCall::Begin(ComputePool& pool) {
  session_ = TRY(registry_.Peek(request_.session_id()));
  TRY(streams_.Add(this));
  added_ = true;
  if (pool.TryPost([this] { Work(); })) return {};
  return Error{ErrorCode::kComputeQueueFull, "too much work is waiting; try again later", {}};
}

void SuggestCall::Work() {
  overdue_ = Clock::now() + time_limit_;
  // Nothing of this object may be used once it is finished.
  Finish(call_.End(Guarded([this] { return Suggest(); })));
}

Result<void> SuggestCall::Suggest() {
  auto suggestion = [&]() -> Result<Suggestion> {
    const SuggestRequest request = TRY(SuggestRequestFromProto(request_));
    if (session_ == nullptr) session_ = TRY(registry_.Find(request_.session_id()));
    return session_->Suggest(request, &progress_);
  }();
  if (suggestion) {
    ToProto(*suggestion, &response_);
    return {};
  }
  if (suggestion.error().code == ErrorCode::kCancelled) return Stopped();
  return std::move(suggestion).error();
}

void SuggestCall::StopInTime() {
  const auto now = Clock::now();
  if (now > overdue_ || now > drain_by_.load()) progress_.Cancel();
}

Error SuggestCall::Stopped() const {
  const auto now = Clock::now();
  if (now > drain_by_.load()) {
    return Error{ErrorCode::kDraining, "the service ends; ask another, or later", {}};
  }
  if (now > overdue_) {
    return Error{
        ErrorCode::kBuildTimeout,
        "matching took longer than the limit of " + std::to_string(time_limit_.count()) + " s",
        {}};
  }
  return Error{ErrorCode::kCancelled, "the caller went away", {}};
}

void SuggestCall::OnDone() {
  if (added_) streams_.Remove(this);
  delete this;
}

}  // namespace posespace
