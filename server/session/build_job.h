// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_BUILD_JOB_H_
#define POSESPACE_SESSION_BUILD_JOB_H_

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "geometry/progress.h"
#include "geometry/result.h"
#include "session/pose_space.h"

namespace posespace {

enum class BuildState { kQueued, kRunning, kSucceeded, kFailed, kCancelled };

// Where a build stands.  A copy.
struct BuildStatus {
  std::string id;
  BuildState state = BuildState::kQueued;
  std::string stage;
  double fraction = 0.0;                        // never falls; 1 when succeeded
  std::int64_t sequence = 0;                    // >= 1; grows with every change
  std::shared_ptr<const PoseSpace> pose_space;  // when succeeded, of a session in memory
  std::shared_ptr<const BuildSummary> summary;  // when succeeded
  std::optional<Error> error;                   // when failed or cancelled
  bool attached = false;  // of StartBuild's answer: the build was there already

  bool ended() const { return state > BuildState::kRunning; }
};

// Numbers the changes of a session's builds, so that a watcher who moves from one build to the next
// neither misses nor repeats one.
using ChangeCounter = std::atomic<std::int64_t>;

// One build: its inputs, its progress, its end.  Thread-safe.
class BuildJob {
 public:
  // Called once when the build ended, before anybody else hears of it, holding no lock: on the
  // thread that builds, or, for a job cancelled while it is queued, on the thread that cancels.
  // A build whose result it cannot take ends as failed with its error.
  using Done = std::function<Result<void>(const BuildStatus&)>;

  // A build of the same mesh as `reuse`, if any, only makes its weights anew.
  BuildJob(std::string id, BuildInputs inputs, Done done,
           std::shared_ptr<const PoseSpace> reuse = nullptr,
           std::shared_ptr<ChangeCounter> changes = nullptr);

  // A build that has succeeded before it was asked for.
  BuildJob(std::string id, std::shared_ptr<const PoseSpace> built,
           std::shared_ptr<ChangeCounter> changes = nullptr);

  ~BuildJob();

  const std::string& revision() const;  // RevisionDigest of its inputs

  BuildStatus Status() const;

  bool ended() const;

  // True when Cancel() came in time: the job ends, or has ended, as kCancelled.
  bool cancelled() const;

  // Calls `listener` after each change, on the thread that changed it, until Unwatch(token). It is
  // called once at once, with the state as it is, on the caller's thread.  Calls come one at a
  // time, in order of sequence; reports of progress within one stage come at most every 20 ms.
  //
  // A listener must not block or throw, nor call Watch or Cancel; it may call Unwatch.  Unwatch
  // waits for a call that is running on another thread, so call it with no lock that a listener
  // takes.
  using Listener = std::function<void(const BuildStatus&)>;
  std::int64_t Watch(Listener listener);
  void Unwatch(std::int64_t token);

  // Asks the build to stop; it ends as kCancelled within 200 ms of work.  A queued job ends at
  // once; an ended one stays as it is.
  void Cancel();

  // Builds; called by a BuildPool's worker.  Ends as kFailed with kBuildTimeout past the limit, and
  // with kInternal for anything thrown.  A job that has been run or cancelled is left alone.
  void Run(std::chrono::milliseconds timeout);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace posespace

#endif  // POSESPACE_SESSION_BUILD_JOB_H_
