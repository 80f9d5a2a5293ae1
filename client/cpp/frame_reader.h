// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_CLIENT_CPP_FRAME_READER_H_
#define POSESPACE_CLIENT_CPP_FRAME_READER_H_

#include <google/protobuf/io/zero_copy_stream.h>
#include <google/protobuf/repeated_field.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace posespace::internal {

// The items of FrameResult messages, read into memory that is used again and again: protobuf itself
// would free and allocate every item's frame for every message.  Frames lie one after another in
// `vertices`, quantized ones as floats too, and weights in `numbers`.
struct FrameItems {
  struct Item {
    std::uint32_t slot;
    std::uint32_t tag;
    std::int32_t folds, mended;
    std::size_t vertices_begin, vertices_end;  // in `vertices`
    int weights_begin, weights_end;            // in `numbers`
    int textures_begin, textures_end;          // in `numbers`
    bool fading;
    std::string reason;
    std::string message;
  };

  Item& Add();   // empty
  void Clear();  // keeps the memory

  std::vector<Item> items;  // the first `count`; further ones are memory
  std::size_t count = 0;
  std::vector<float> vertices;  // the first `floats`
  std::size_t floats = 0;
  google::protobuf::RepeatedField<double> numbers;
  std::vector<std::int16_t> steps;  // of the quantized vertices just read
};

enum class ReadOutcome { kFrameResult, kAnotherMessage, kBroken };

// Reads a PlayResponse when it is a FrameResult, and appends its items.
ReadOutcome ReadFrameResult(google::protobuf::io::ZeroCopyInputStream* message,
                            std::uint64_t* frame_id, FrameItems* items);

}  // namespace posespace::internal

#endif  // POSESPACE_CLIENT_CPP_FRAME_READER_H_
