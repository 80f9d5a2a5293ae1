// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_RPC_TRANSPORT_OPTIONS_H_
#define POSESPACE_RPC_TRANSPORT_OPTIONS_H_

#include <grpcpp/server_builder.h>

#include "session/limits.h"

namespace posespace {

// How gRPC listens and keeps connections alive.
void SetTransportOptions(grpc::ServerBuilder& builder, const Limits& limits);

}  // namespace posespace

#endif  // POSESPACE_RPC_TRANSPORT_OPTIONS_H_
