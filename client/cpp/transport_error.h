// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_CLIENT_CPP_TRANSPORT_ERROR_H_
#define POSESPACE_CLIENT_CPP_TRANSPORT_ERROR_H_

#include <cstddef>
#include <string>
#include <string_view>

#include "posespace/error.h"

namespace posespace::internal {

// How a call failed, as gRPC says it.
struct FailedCall {
  int code = 0;  // of google.rpc.Code
  std::string message;
  std::string details;  // a google.rpc.Status, serialized; may be empty
};

// A failed call as an error that says what to do about it.  `timeout_seconds` and `request_bytes`
// are those of the call, or 0.
Error ErrorOfCall(const FailedCall& call, const std::string& address, double timeout_seconds = 0.0,
                  std::size_t request_bytes = 0);

// The error of a refusal that came inside a message, with no status code.
Error ErrorOfReason(const std::string& reason, const std::string& message,
                    Error::Fields fields = {});

Error NoAnswer(const std::string& address, double seconds);

}  // namespace posespace::internal

#endif  // POSESPACE_CLIENT_CPP_TRANSPORT_ERROR_H_
