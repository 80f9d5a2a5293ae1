// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_CALL_H_
#define POSESPACE_RPC_CALL_H_

#include <grpcpp/server_context.h>
#include <grpcpp/support/server_callback.h>
#include <grpcpp/support/status.h>

#include <chrono>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "geometry/result.h"
#include "rpc/compute_pool.h"
#include "rpc/shown_error.h"
#include "session/registry.h"

namespace posespace {

// One call from its beginning to its end: a copyable value.  The only place that turns outcomes
// into statuses and writes the call log (method, code, reason, duration; refusals at info, the rest
// at debug).
class Call {
 public:
  explicit Call(std::string_view method) : method_(method) {}  // a literal, such as "Blend"

  grpc::Status End(Result<void> outcome) const;

 private:
  std::string_view method_;
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

// Answers a unary call at once.  For handlers of at most about 100 us; they run on a thread that
// serves everybody.
template <typename Handler>
grpc::ServerUnaryReactor* Reply(grpc::CallbackServerContext* context, std::string_view method,
                                Handler&& handler) {
  const Call call(method);
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  reactor->Finish(call.End(Guarded(handler)));
  return reactor;
}

// Answers a unary call from a pool.  The handler keeps request and response by pointer: they live
// until the call is finished.  A call that nobody waits for any more is not worked on.
template <typename Handler>
grpc::ServerUnaryReactor* ReplyFrom(ComputePool& pool, grpc::CallbackServerContext* context,
                                    std::string_view method, Handler handler) {
  const Call call(method);
  grpc::ServerUnaryReactor* const reactor = context->DefaultReactor();
  const bool posted = pool.TryPost([=, handler = std::move(handler)]() mutable {
    const auto answer = [&]() -> Result<void> {
      if (context->IsCancelled()) return Error{ErrorCode::kCancelled, "the caller went away", {}};
      return handler();
    };
    reactor->Finish(call.End(Guarded(answer)));
  });
  if (!posted) {
    reactor->Finish(call.End(
        Error{ErrorCode::kComputeQueueFull, "too much work is waiting; try again later", {}}));
  }
  return reactor;
}

// Answers a unary call about one session by handler(session): at once when the session is in
// memory, else from a pool, which loads it.  For handlers as Reply has them.
template <typename Handler>
grpc::ServerUnaryReactor* ReplyAbout(const std::string& session_id, const Registry& registry,
                                     ComputePool& pool, grpc::CallbackServerContext* context,
                                     std::string_view method, Handler handler) {
  auto session = registry.Peek(session_id);
  if (session && *session == nullptr) {
    return ReplyFrom(pool, context, method,
                     [&session_id, &registry, handler = std::move(handler)]() -> Result<void> {
                       return handler(TRY(registry.Find(session_id)));
                     });
  }
  return Reply(context, method, [&]() -> Result<void> { return handler(TRY(std::move(session))); });
}

}  // namespace posespace

#endif  // POSESPACE_RPC_CALL_H_
