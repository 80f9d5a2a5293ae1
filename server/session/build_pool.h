// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_BUILD_POOL_H_
#define POSESPACE_SESSION_BUILD_POOL_H_

#include <memory>

#include "geometry/result.h"
#include "session/build_job.h"
#include "session/limits.h"

namespace posespace {

// Worker threads for builds at low priority (nice 19), so that a build never delays a stream; jobs
// start in the order they came.  Thread-safe.
class BuildPool {
 public:
  // As many workers as limits.concurrent_builds; without any, jobs only wait.
  explicit BuildPool(const Limits& limits);
  ~BuildPool();  // as Stop()
  BuildPool(const BuildPool&) = delete;
  BuildPool& operator=(const BuildPool&) = delete;

  // Cancelled jobs leave the queue at once and do not count.
  // Fails with kBuildQueueFull, kDraining (after Stop).
  Result<void> Submit(std::shared_ptr<BuildJob> job);

  // Cancels everything and takes no more; returns at once.
  void CancelAll();

  // CancelAll, then waits for the workers.  Not from a worker: neither from
  // a job's Done nor from a listener.
  void Stop();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace posespace

#endif  // POSESPACE_SESSION_BUILD_POOL_H_
