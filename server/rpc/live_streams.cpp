// SPDX-License-Identifier: Apache-2.0
#include "rpc/live_streams.h"

#include <algorithm>
#include <string>

namespace posespace {

Result<void> LiveStreams::Add(LiveStream* stream) {
  const std::scoped_lock lock(mutex_);
  if (draining_) return Error{ErrorCode::kDraining, "the service is ending", {}};
  if (CountLocked() >= limit_) {
    return Error{
        ErrorCode::kStreamLimit, "all " + std::to_string(limit_) + " streams are in use", {}};
  }
  std::min_element(quarters_.begin(), quarters_.end(), [](const auto& a, const auto& b) {
    return a.size() < b.size();
  })->insert(stream);
  return {};
}

void LiveStreams::Remove(LiveStream* stream) {
  const std::scoped_lock lock(mutex_);
  for (auto& quarter : quarters_) quarter.erase(stream);
}

void LiveStreams::Beat(std::chrono::steady_clock::time_point now) {
  const std::scoped_lock lock(mutex_);
  for (LiveStream* stream : quarters_[next_]) stream->Beat(now);
  next_ = (next_ + 1) % quarters_.size();
}

void LiveStreams::Drain(std::chrono::milliseconds grace) {
  const std::scoped_lock lock(mutex_);
  draining_ = true;
  for (auto& quarter : quarters_) {
    for (LiveStream* stream : quarter) stream->Drain(grace);
  }
}

std::size_t LiveStreams::count() const {
  const std::scoped_lock lock(mutex_);
  return CountLocked();
}

std::size_t LiveStreams::CountLocked() const {
  std::size_t sum = 0;
  for (const auto& quarter : quarters_) sum += quarter.size();
  return sum;
}

}  // namespace posespace
