// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_STATUS_H_
#define POSESPACE_RPC_STATUS_H_

#include <grpcpp/support/status.h>

#include "geometry/result.h"

namespace posespace {

// The gRPC code of a reason: the table in proto/posespace/v1, once.
grpc::StatusCode StatusCodeOf(ErrorCode code);

// A refusal as it travels: the code, the message, and google.rpc.Status in the details with
// ErrorInfo (reason, domain "posespace.v1"), BadRequest when fields are at fault, RetryInfo when
// trying later helps.
//
// Details stay under 4 KiB and 20 violations, and the message under 512 bytes; what was cut is said
// by ErrorInfo.metadata["truncated"] = number of violations left out.  Trailers of about 8 KiB
// would reach the caller as RESOURCE_EXHAUSTED, whatever they said.
grpc::Status StatusOf(const Error& error);

}  // namespace posespace

#endif  // POSESPACE_RPC_STATUS_H_
