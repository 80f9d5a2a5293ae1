// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_OPS_TERMINATION_H_
#define POSESPACE_OPS_TERMINATION_H_

#include <chrono>
#include <csignal>

namespace posespace {

// SIGTERM and SIGINT as something to wait for, instead of a handler in which almost nothing is
// allowed.  Make it before any thread: threads inherit that the signals are blocked.
class Termination {
 public:
  Termination();

  // Returns when a signal has come.
  void Wait() const;

  // True when a signal came within the time.
  bool WaitFor(std::chrono::milliseconds time) const;

 private:
  sigset_t signals_;
};

}  // namespace posespace

#endif  // POSESPACE_OPS_TERMINATION_H_
