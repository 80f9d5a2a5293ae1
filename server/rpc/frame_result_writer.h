// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_FRAME_RESULT_WRITER_H_
#define POSESPACE_RPC_FRAME_RESULT_WRITER_H_

#include <cstdint>
#include <span>
#include <string>

#include "posespace/v1/pose_service.pb.h"
#include "rpc/message_bytes.h"

namespace posespace {

// What one item of a tick came to: a reason, or a frame.
struct ItemAnswer {
  std::uint32_t slot = 0;
  std::uint32_t tag = 0;
  std::string reason = {};  // empty: there is a frame
  std::string error_message = {};
  std::span<const float> vertices = {};  // x0 y0 x1 y1 ..., finite
  std::span<const double> weights = {};  // none unless asked for
  std::span<const double> texture_weights = {};
  int folds = 0;
  int mended = 0;
  bool fading = false;
};

// A PlayResponse with a FrameResult, written once and in place: protobuf would allocate and copy
// every item's frame.  With kInt16 vertices become QuantizedVertices (pose_service.proto).
MessageBytes WriteFrameResult(std::uint64_t frame_id, std::span<const ItemAnswer> items,
                              std::uint32_t superseded, v1::VertexFormat format);

}  // namespace posespace

#endif  // POSESPACE_RPC_FRAME_RESULT_WRITER_H_
