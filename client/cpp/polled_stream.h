// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_CLIENT_CPP_POLLED_STREAM_H_
#define POSESPACE_CLIENT_CPP_POLLED_STREAM_H_

#include <google/protobuf/message_lite.h>
#include <grpc/support/time.h>
#include <grpcpp/generic/generic_stub.h>
#include <grpcpp/support/byte_buffer.h>
#include <grpcpp/support/status.h>

#include <chrono>
#include <memory>
#include <string>

#include "client/cpp/stream.h"
#include "client/cpp/transport_error.h"

namespace posespace::internal {

// A streaming call of the method at `path`, over a completion queue of its own.
std::unique_ptr<Stream> OpenPolledStream(grpc::GenericStub& stub, const std::string& path,
                                         const std::string& address);

grpc::ByteBuffer BytesOf(const google::protobuf::MessageLite& message);
gpr_timespec GprTime(std::chrono::steady_clock::time_point time);
FailedCall Failed(const grpc::Status& status);

}  // namespace posespace::internal

#endif  // POSESPACE_CLIENT_CPP_POLLED_STREAM_H_
