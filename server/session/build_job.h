// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_BUILD_JOB_H_
#define POSESPACE_SESSION_BUILD_JOB_H_

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "geometry/progress.h"
#include "geometry/result.h"
#include "session/limits.h"
#include "session/pose_space.h"

namespace posespace {

enum class BuildState { kQueued, kRunning, kSucceeded, kFailed, kCancelled };

// Where a build stands.  A copy.
struct BuildStatus {
  std::string id;
  BuildState state = BuildState::kQueued;
  std::string stage;
  double fraction = 0.0;
  std::int64_t sequence = 0;                     // grows with every change
  std::shared_ptr<const PoseSpace> pose_space;   // when succeeded
  std::optional<Error> error;                    // when failed or cancelled

  bool ended() const { return state > BuildState::kRunning; }
};

// One build: its inputs, its progress, its end.  Thread-safe.
class BuildJob {
 public:
  // Called once, on the thread that builds, when the build ended, before watchers hear of it.
  using Done = std::function<void(const BuildStatus&)>;

  BuildJob(std::string id, BuildInputs inputs, Done done);
  ~BuildJob();

  const std::string& revision() const;  // RevisionDigest of its inputs

  BuildStatus Status() const;

  // Calls `listener` after each change, on the thread that changed it, until Unwatch(token); it must not
  // block.  Called once at once, with the state as it is.  Unwatch waits for a call that is running.
  using Listener = std::function<void(const BuildStatus&)>;
  std::int64_t Watch(Listener listener);
  void Unwatch(std::int64_t token);

  // Asks the build to stop; it ends as kCancelled within 200 ms of work.  A queued job ends at once.
  void Cancel();

  // Builds; called by a BuildPool's worker.  Ends as kFailed with kBuildTimeout past the limit.
  void Run(std::chrono::seconds timeout);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Worker threads for builds at low priority (nice 19), so that a build never delays a stream.
// Thread-safe.  Destruction cancels what is queued and running and waits for the workers.
class BuildPool {
 public:
  explicit BuildPool(const Limits& limits);
  ~BuildPool();
  BuildPool(const BuildPool&) = delete;
  BuildPool& operator=(const BuildPool&) = delete;

  // Fails with kBuildQueueFull, kDraining (after Stop).
  Result<void> Submit(std::shared_ptr<BuildJob> job);

  // Cancels everything and takes no more.
  void Stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace posespace

#endif  // POSESPACE_SESSION_BUILD_JOB_H_
