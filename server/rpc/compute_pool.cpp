// SPDX-License-Identifier: Apache-2.0
#include "rpc/compute_pool.h"

#include <sys/resource.h>
#include <unistd.h>

#include <utility>

namespace posespace {

ComputePool::ComputePool(int threads, std::size_t capacity, int niceness) : capacity_(capacity) {
  for (int k = 0; k < threads; ++k) {
    threads_.emplace_back([this, niceness] { Work(niceness); });
  }
}

ComputePool::~ComputePool() {
  {
    const std::scoped_lock lock(mutex_);
    stopping_ = true;
  }
  ready_.notify_all();
  for (std::thread& thread : threads_) thread.join();
}

bool ComputePool::TryPost(Job job) {
  {
    const std::scoped_lock lock(mutex_);
    if (jobs_.size() >= capacity_) return false;
    jobs_.push_back(std::move(job));
  }
  ready_.notify_one();
  return true;
}

void ComputePool::Post(Job job) {
  {
    const std::scoped_lock lock(mutex_);
    jobs_.push_back(std::move(job));
  }
  ready_.notify_one();
}

void ComputePool::Work(int niceness) {
  // On Linux niceness belongs to a thread.
  if (niceness > 0) setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), niceness);
  for (;;) {
    Job job;
    {
      std::unique_lock lock(mutex_);
      ready_.wait(lock, [&] { return stopping_ || !jobs_.empty(); });
      if (jobs_.empty()) return;
      job = std::move(jobs_.front());
      jobs_.pop_front();
    }
    job();
  }
}

}  // namespace posespace
