// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_GEOMETRY_PROGRESS_H_
#define POSESPACE_GEOMETRY_PROGRESS_H_

#include <atomic>
#include <functional>
#include <string>
#include <string_view>
#include <utility>

namespace posespace {

// How far a long computation has come, and whether it should stop.  It knows no gRPC.
//
// The computation runs on one thread: it enters stages in order and reports fractions within them;
// the overall fraction never falls.  Cancel() may be called from any thread; the computation asks
// cancelled() at least every few milliseconds and then fails with kCancelled.
class Progress {
 public:
  // Called on the computing thread with the stage and the overall fraction in [0, 1].
  using Listener = std::function<void(std::string_view stage, double fraction)>;

  Progress() = default;
  explicit Progress(Listener listener) : listener_(std::move(listener)) {}
  // A part of a longer computation: the whole of this is [begin, end] of `parent`, which also
  // cancels it.  A parent may be absent; otherwise it outlives its parts.
  Progress(Progress* parent, double begin, double end);
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void Cancel() { cancelled_.store(true, std::memory_order_relaxed); }
  bool cancelled() const {
    return cancelled_.load(std::memory_order_relaxed) ||
           (parent_ != nullptr && parent_->cancelled());
  }

  // Later reports speak of `stage`, which takes the overall fraction from `begin` to `end`.
  void EnterStage(std::string_view stage, double begin, double end);

  // `fraction` of the current stage is done, in [0, 1].
  void Report(double fraction);

 private:
  Progress* const parent_ = nullptr;
  Listener listener_;
  std::atomic<bool> cancelled_{false};
  std::string stage_;
  double begin_ = 0.0;
  double end_ = 1.0;
  double overall_ = 0.0;
};

// The same questions for a Progress that may be absent.
inline bool IsCancelled(const Progress* progress) {
  return progress != nullptr && progress->cancelled();
}
inline void Report(Progress* progress, double fraction) {
  if (progress != nullptr) progress->Report(fraction);
}

}  // namespace posespace

#endif  // POSESPACE_GEOMETRY_PROGRESS_H_
