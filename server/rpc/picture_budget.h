// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_PICTURE_BUDGET_H_
#define POSESPACE_RPC_PICTURE_BUDGET_H_

#include <atomic>
#include <cstdint>

namespace posespace {

// Bytes of pictures that all streams together may have drawn and not yet delivered: readers that do
// not read hold their share and no more.  Thread-safe.
class PictureBudget {
 public:
  explicit PictureBudget(std::int64_t bytes) : left_(bytes) {}

  // False, and takes nothing, when less than `bytes` are left.
  bool TryTake(std::int64_t bytes) {
    if (left_.fetch_sub(bytes) >= bytes) return true;
    left_.fetch_add(bytes);
    return false;
  }
  void Return(std::int64_t bytes) { left_.fetch_add(bytes); }

 private:
  std::atomic<std::int64_t> left_;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_PICTURE_BUDGET_H_
