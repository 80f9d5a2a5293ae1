// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <utility>

#include "client/cpp/channel.h"
#include "client/cpp/convert.h"
#include "client/cpp/session_handle.h"
#include "client/cpp/transport_error.h"

namespace posespace::internal {
namespace {

using namespace std::chrono_literals;

constexpr Clock::duration kFirstPause = 50ms,
                          kLongestPause = 1s;  // between tries to reach it again

Error Stopped(const std::string& session_id) {
  return Error(ErrorCode::kCancelled, "the build of session '" + session_id + "' was stopped",
               "CANCELLED");
}

// A build watched to its end, over broken streams.
class Watch {
 public:
  Watch(std::shared_ptr<Channel> channel, const v1::StartBuildResponse& started,
        const std::string& session_id, const BuildOptions& options, Clock::time_point deadline)
      : channel_(std::move(channel)),
        session_id_(session_id),
        build_id_(started.build().id()),
        options_(options),
        deadline_(deadline) {}

  BuildReport ToTheEnd() {
    for (;;) {
      if (auto report = Follow()) return *std::move(report);
      const v1::Build build = OnceReached();
      if (build.sequence() <= sequence_) continue;
      if (auto report = Note(build)) return *std::move(report);
    }
  }

 private:
  // The changes that one stream brings; none when it broke.
  std::optional<BuildReport> Follow() {
    auto request = std::make_unique<v1::WatchBuildRequest>();
    request->set_session_id(session_id_);
    request->set_after_sequence(sequence_);
    Answers answers(channel_, std::move(request), options_.stop);
    v1::WatchBuildResponse change;
    while (NextUnlessBroken(&answers, &change)) {
      if (auto report = Note(change.build())) return report;
    }
    return std::nullopt;
  }

  bool NextUnlessBroken(Answers* answers, v1::WatchBuildResponse* change) const {
    try {
      return answers->Next(change, deadline_);
    } catch (const Error& error) {
      if (options_.stop.stop_requested()) throw Stopped(session_id_);
      if (error.code() != ErrorCode::kUnavailable) throw;
      return false;
    }
  }

  // Takes note of a change; the report when it is the last.
  std::optional<BuildReport> Note(const v1::Build& build) {
    if (build.id() != build_id_) {
      throw Error(ErrorCode::kCancelled,
                  "another build of session '" + session_id_ + "' has replaced this one",
                  "CANCELLED");
    }
    sequence_ = build.sequence();
    if (options_.on_progress) options_.on_progress(build.stage(), build.fraction());
    if (build.has_error()) {
      Error::Fields fields;
      for (const std::string& field : build.error().fields()) {
        fields[field] = build.error().message();
      }
      throw ErrorOfReason(build.error().reason(), build.error().message(), std::move(fields));
    }
    if (build.state() != v1::BUILD_STATE_SUCCEEDED) return std::nullopt;
    return FromMessage(build.report());
  }

  // The build as it stands, as soon as the service answers; kUnavailable when it does not within
  // the client's timeout.
  v1::Build OnceReached() const {
    const auto give_up = Clock::now() + channel_->timeout();
    v1::GetSessionRequest request;
    request.set_session_id(session_id_);
    v1::GetSessionResponse response;
    for (Clock::duration pause = kFirstPause;; pause = std::min(2 * pause, kLongestPause)) {
      if (!Sleep(pause, options_.stop)) throw Stopped(session_id_);
      try {
        channel_->Call(request, &response);
        return response.session().build();
      } catch (const Error& error) {
        if (error.code() != ErrorCode::kUnavailable || Clock::now() > give_up) throw;
      }
    }
  }

  const std::shared_ptr<Channel> channel_;
  const std::string session_id_;
  const std::string build_id_;
  const BuildOptions& options_;
  const Clock::time_point deadline_;
  std::int64_t sequence_ = 0;
};

// Stops a build that was started here; others may wait for one that was there already.
void Cancel(const Channel& channel, const std::string& session_id,
            const v1::StartBuildResponse& started) {
  if (started.attached()) return;
  v1::CancelBuildRequest request;
  request.set_session_id(session_id);
  request.set_build_id(started.build().id());
  v1::CancelBuildResponse response;
  try {
    channel.Call(request, &response);
  } catch (const Error&) {  // what ended the wait is what the caller is told
  }
}

}  // namespace

BuildReport BuildAndWait(const std::shared_ptr<Channel>& channel,
                         const v1::StartBuildRequest& request, const BuildOptions& options) {
  const auto deadline =
      options.timeout ? Clock::now() + *options.timeout : Clock::time_point::max();
  if (options.stop.stop_requested()) throw Stopped(request.session_id());
  v1::StartBuildResponse started;
  channel->CallPatiently(request, &started, deadline, options.stop);  // a full queue is waited for
  try {
    return Watch(channel, started, request.session_id(), options, deadline).ToTheEnd();
  } catch (const Error& error) {
    const bool too_long = error.code() == ErrorCode::kDeadlineExceeded && error.reason().empty();
    if (!too_long && !options.stop.stop_requested()) throw;
    Cancel(*channel, request.session_id(), started);
    if (!too_long || !options.timeout) throw;
    char seconds[32];
    std::snprintf(seconds, sizeof(seconds), "%g",
                  std::chrono::duration<double>(*options.timeout).count());
    throw Error(
        ErrorCode::kDeadlineExceeded,
        "session '" + request.session_id() + "' was not built within " + seconds + " s; " +
            (started.attached() ? "another caller's build goes on" : "its build is cancelled"));
  } catch (...) {  // what on_progress threw
    Cancel(*channel, request.session_id(), started);
    throw;
  }
}

}  // namespace posespace::internal
