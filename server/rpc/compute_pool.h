// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_COMPUTE_POOL_H_
#define POSESPACE_RPC_COMPUTE_POOL_H_

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>
#include <vector>

namespace posespace {

// Threads for work that is too long for a gRPC callback thread; such a thread serves every stream,
// so nothing may hold it up.  First come, first served.  Thread-safe. Destruction finishes what was
// posted: each job owes somebody an answer.
class ComputePool {
 public:
  using Job = std::function<void()>;

  // `niceness` 0 .. 19 as in nice(1); TryPost keeps at most `capacity` jobs waiting.
  ComputePool(int threads, std::size_t capacity, int niceness);
  ~ComputePool();
  ComputePool(const ComputePool&) = delete;
  ComputePool& operator=(const ComputePool&) = delete;

  // False when the queue is full: the caller should be told to come back.
  [[nodiscard]] bool TryPost(Job job);

  // For streams, which post at most one job each and are themselves limited in number.
  void Post(Job job);

 private:
  void Work(int niceness);

  const std::size_t capacity_;
  std::mutex mutex_;
  std::condition_variable ready_;
  std::deque<Job> jobs_;
  bool stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_COMPUTE_POOL_H_
