// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_PLAY_REQUEST_H_
#define POSESPACE_RPC_PLAY_REQUEST_H_

#include <google/protobuf/arena.h>

#include <algorithm>
#include <cstddef>
#include <optional>

#include "posespace/v1/pose_service.pb.h"

namespace posespace {

// A PlayRequest to be read again and again: all that a message holds comes in one or two pieces of
// memory, as large as the one before needed, where protobuf alone would allocate every item's
// parts.  Any thread may fill it; an arena's own memory serves only the thread that made it.
class ReusedRequest {
 public:
  ReusedRequest() { Make(kLeastBytes); }

  // Empties it; what was read is gone.
  void Clear() {
    const auto used = static_cast<std::size_t>(arena_->SpaceUsed());
    Make(std::clamp(used + used / 4, kLeastBytes, kMostBytes));
  }

  v1::PlayRequest& message() { return *message_; }
  const v1::PlayRequest& message() const { return *message_; }

 private:
  static constexpr std::size_t kLeastBytes = 1 << 10;
  static constexpr std::size_t kMostBytes = 256 << 10;

  void Make(std::size_t bytes) {
    google::protobuf::ArenaOptions options;
    options.start_block_size = bytes;
    options.max_block_size = std::max(bytes, options.max_block_size);
    arena_.emplace(options);
    message_ = google::protobuf::Arena::CreateMessage<v1::PlayRequest>(&*arena_);
  }

  std::optional<google::protobuf::Arena> arena_;
  v1::PlayRequest* message_ = nullptr;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_PLAY_REQUEST_H_
