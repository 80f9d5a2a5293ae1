// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_MESSAGE_BYTES_H_
#define POSESPACE_RPC_MESSAGE_BYTES_H_

#include <google/protobuf/message_lite.h>

#include <cstddef>
#include <memory>
#include <string_view>

namespace posespace {

// A message on its way out, as it travels: memory that its writer fills once and the transport
// sends without copying it.
//
// The memory comes from what earlier messages of all streams have left, up to some megabytes, and
// returns there from whatever thread lets go of it; so a steady stream allocates nothing.
class MessageBytes {
 public:
  MessageBytes() = default;  // none
  explicit MessageBytes(std::size_t size);
  explicit MessageBytes(const google::protobuf::MessageLite& message);

  char* data() { return block_ ? block_->bytes() : nullptr; }
  std::size_t size() const { return block_ ? block_->size : 0; }
  std::string_view view() const { return {block_ ? block_->bytes() : nullptr, size()}; }

  // Hands the memory over to somebody who calls Return with the token in the end.
  void* Release() && { return block_.release(); }
  static void Return(void* token);

 private:
  friend class SpareBytes;
  struct Block {
    std::size_t capacity;
    std::size_t size;
    char* bytes() { return reinterpret_cast<char*>(this + 1); }
  };
  struct Returner {
    void operator()(Block* block) const { Return(block); }
  };
  std::unique_ptr<Block, Returner> block_;
};

}  // namespace posespace

#endif  // POSESPACE_RPC_MESSAGE_BYTES_H_
