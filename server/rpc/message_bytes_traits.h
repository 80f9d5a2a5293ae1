// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_MESSAGE_BYTES_TRAITS_H_
#define POSESPACE_RPC_MESSAGE_BYTES_TRAITS_H_

#include <grpcpp/impl/serialization_traits.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/slice.h>
#include <grpcpp/support/status.h>

#include <cstddef>
#include <utility>

#include "rpc/message_bytes.h"

namespace grpc {

// MessageBytes as gRPC sends them: not copied, and given back when they are sent.
template <>
class SerializationTraits<posespace::MessageBytes> {
 public:
  static Status Serialize(const posespace::MessageBytes& message, ByteBuffer* buffer,
                          bool* own_buffer) {
    auto& bytes = const_cast<posespace::MessageBytes&>(message);
    char* const data = bytes.data();
    const std::size_t size = bytes.size();
    const Slice slice(data, size, posespace::MessageBytes::Return, std::move(bytes).Release());
    *buffer = ByteBuffer(&slice, 1);
    *own_buffer = true;
    return Status::OK;
  }
};

}  // namespace grpc

#endif  // POSESPACE_RPC_MESSAGE_BYTES_TRAITS_H_
