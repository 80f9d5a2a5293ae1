// SPDX-License-Identifier: Apache-2.0
#include "rpc/message_bytes.h"

#include <array>
#include <bit>
#include <mutex>
#include <new>
#include <vector>

namespace posespace {

// Blocks that nobody uses, by size: powers of two.  The last one returned is the next one used: its
// memory is still in the processor's cache.
class SpareBytes {
 public:
  using Block = MessageBytes::Block;

  // Lives as long as the program: transports may return memory until its very end.
  static SpareBytes& Get() {
    static SpareBytes& spare = *new SpareBytes;
    return spare;
  }

  Block* Take(std::size_t size) {
    const std::size_t whole = std::bit_ceil(std::max(kLeast, size + sizeof(Block)));
    {
      const std::scoped_lock lock(mutex_);
      std::vector<Block*>& blocks = BlocksOf(whole);
      if (!blocks.empty()) {
        Block* const block = blocks.back();
        blocks.pop_back();
        kept_ -= whole;
        block->size = size;
        return block;
      }
    }
    return new (::operator new(whole)) Block{whole, size};
  }

  void Return(Block* block) {
    {
      const std::scoped_lock lock(mutex_);
      if (kept_ + block->capacity <= kMost) {
        BlocksOf(block->capacity).push_back(block);
        kept_ += block->capacity;
        return;
      }
    }
    ::operator delete(block);
  }

 private:
  static constexpr std::size_t kLeast = 256;
  static constexpr std::size_t kMost = 32 << 20;  // of all blocks together

  SpareBytes() {
    for (std::vector<Block*>& blocks : blocks_) blocks.reserve(64);
  }
  std::vector<Block*>& BlocksOf(std::size_t whole) {
    return blocks_[static_cast<std::size_t>(std::countr_zero(whole))];
  }

  std::mutex mutex_;
  std::array<std::vector<Block*>, 64> blocks_;  // [k]: of 2^k bytes
  std::size_t kept_ = 0;                        // bytes
};

MessageBytes::MessageBytes(std::size_t size) : block_(SpareBytes::Get().Take(size)) {}

MessageBytes::MessageBytes(const google::protobuf::MessageLite& message)
    : MessageBytes(message.ByteSizeLong()) {
  message.SerializeWithCachedSizesToArray(reinterpret_cast<std::uint8_t*>(data()));
}

void MessageBytes::Return(void* token) {
  if (token != nullptr) SpareBytes::Get().Return(static_cast<Block*>(token));
}

}  // namespace posespace
