// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_CLIENT_CPP_SESSION_HANDLE_H_
#define POSESPACE_CLIENT_CPP_SESSION_HANDLE_H_

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "client/cpp/channel.h"
#include "posespace/results.h"
#include "posespace/v1/session_service.pb.h"

namespace posespace::internal {

// A built pose space, as far as calls have to know it.
struct Built {
  std::string revision;
  std::vector<std::string> shape_ids;  // in the order of weights
  int vertex_count = 0;
};

// What the copies of a Session share.  Thread-safe.
class SessionHandle {
 public:
  SessionHandle(std::shared_ptr<Channel> over, std::string session_id)
      : channel(std::move(over)), id(std::move(session_id)) {}

  // What `ask` answers for the current revision and its drawings.
  //
  // Weights travel without names and batches one by one, so each call says which revision it means;
  // when a rebuild has overtaken it, it is made again for the new one.
  template <typename Ask>
  auto OfOneRevision(const Ask& ask) {
    for (int rebuilds = 0; rebuilds < kRebuilds; ++rebuilds) {
      const auto [built, from_before] = Current();
      try {
        return ask(*built);
      } catch (const Error& error) {
        if (!Overtaken(error, from_before)) throw;
        Forget(built);
      }
    }
    return ask(*Current().first);
  }

  const std::shared_ptr<Channel> channel;
  const std::string id;

 private:
  static constexpr int kRebuilds = 5;  // that may overtake one call before it gives up

  static bool Overtaken(const Error& error, bool from_before);
  std::pair<std::shared_ptr<const Built>, bool> Current();  // second: known from an earlier call
  void Forget(const std::shared_ptr<const Built>& built);

  std::mutex mutex_;
  std::shared_ptr<const Built> built_;
};

// Starts a build and follows it to its end; see Session::Build.
BuildReport BuildAndWait(const std::shared_ptr<Channel>& channel,
                         const v1::StartBuildRequest& request, const BuildOptions& options);

}  // namespace posespace::internal

#endif  // POSESPACE_CLIENT_CPP_SESSION_HANDLE_H_
