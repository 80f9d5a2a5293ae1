// SPDX-License-Identifier: Apache-2.0
#include "session/build_pool.h"

#include <sys/resource.h>
#include <unistd.h>

#include <condition_variable>
#include <deque>
#include <exception>
#include <mutex>
#include <set>
#include <thread>
#include <utility>
#include <vector>

namespace posespace {
namespace {

// On Linux a thread has a priority of its own.  A refusal leaves a build at normal priority.
void LowerPriorityOfThisThread() {
  constexpr int kLowest = 19;
  setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kLowest);
}

}  // namespace

// Lock order: `mutex` before those of a job; it is not held while a job runs or is cancelled.
struct BuildPool::State {
  explicit State(const Limits& given) : limits(given) {}

  const Limits limits;
  std::mutex mutex;
  std::condition_variable changed;
  std::deque<std::shared_ptr<BuildJob>> queue;  // guarded by mutex
  std::set<std::shared_ptr<BuildJob>> running;  // guarded by mutex
  bool stopped = false;                         // guarded by mutex
  std::mutex joining;
  std::vector<std::thread> workers;  // guarded by joining

  void Work() {
    LowerPriorityOfThisThread();
    std::unique_lock lock(mutex);
    for (;;) {
      changed.wait(lock, [this] { return stopped || !queue.empty(); });
      if (stopped) return;
      std::shared_ptr<BuildJob> job = std::move(queue.front());
      queue.pop_front();
      running.insert(job);
      lock.unlock();
      RunToItsEnd(*job);
      lock.lock();
      running.erase(job);
      lock.unlock();
      job.reset();  // what it built may be large to free
      lock.lock();
    }
  }

  // A job reports its own failures; only lack of memory for that report can come here, and then it
  // costs this build rather than the service.
  void RunToItsEnd(BuildJob& job) noexcept {
    try {
      job.Run(limits.build_timeout);
    } catch (const std::exception&) {
      return;
    }
  }
};

BuildPool::BuildPool(const Limits& limits) : state_(std::make_unique<State>(limits)) {
  for (int i = 0; i < limits.concurrent_builds; ++i) {
    state_->workers.emplace_back([state = state_.get()] { state->Work(); });
  }
}

BuildPool::~BuildPool() { Stop(); }

Result<void> BuildPool::Submit(std::shared_ptr<BuildJob> job) {
  const std::lock_guard lock(state_->mutex);
  if (state_->stopped) {
    return Error{ErrorCode::kDraining, "the service is shutting down and builds no more", {}};
  }
  std::erase_if(state_->queue, [](const auto& queued) { return queued->ended(); });
  if (std::ssize(state_->queue) >= state_->limits.build_queue) {
    return Error{ErrorCode::kBuildQueueFull,
                 std::to_string(state_->queue.size()) +
                     " builds are waiting, as many as may: "
                     "try again later",
                 {}};
  }
  state_->queue.push_back(std::move(job));
  state_->changed.notify_one();
  return {};
}

void BuildPool::CancelAll() {
  std::vector<std::shared_ptr<BuildJob>> jobs;
  {
    const std::lock_guard lock(state_->mutex);
    state_->stopped = true;
    jobs.assign(state_->running.begin(), state_->running.end());
    jobs.insert(jobs.end(), state_->queue.begin(), state_->queue.end());
    state_->queue.clear();
    state_->changed.notify_all();
  }
  for (const auto& job : jobs) job->Cancel();
}

void BuildPool::Stop() {
  CancelAll();
  const std::lock_guard lock(state_->joining);
  for (std::thread& worker : state_->workers) worker.join();
  state_->workers.clear();
}

}  // namespace posespace
