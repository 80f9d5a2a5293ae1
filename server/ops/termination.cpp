// SPDX-License-Identifier: Apache-2.0
#include "ops/termination.h"

#include <cerrno>
#include <csignal>

namespace posespace {

Termination::Termination() {
  sigemptyset(&signals_);
  sigaddset(&signals_, SIGTERM);
  sigaddset(&signals_, SIGINT);
  pthread_sigmask(SIG_BLOCK, &signals_, nullptr);
  // A reader of the log that goes away must not take the service with it.
  std::signal(SIGPIPE, SIG_IGN);
}

void Termination::Wait() const {
  int signal = 0;
  while (sigwait(&signals_, &signal) == EINTR) {
  }
}

bool Termination::WaitFor(std::chrono::milliseconds time) const {
  const auto seconds = std::chrono::duration_cast<std::chrono::seconds>(time);
  timespec limit{};
  limit.tv_sec = seconds.count();
  limit.tv_nsec = std::chrono::nanoseconds(time - seconds).count();
  return sigtimedwait(&signals_, nullptr, &limit) > 0;
}

}  // namespace posespace
