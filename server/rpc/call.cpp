// SPDX-License-Identifier: Apache-2.0
#include "rpc/call.h"

#include <spdlog/spdlog.h>

#include "ops/logging.h"
#include "rpc/status.h"

namespace posespace {

grpc::Status Call::End(Result<void> outcome) const {
  const std::chrono::duration<double, std::milli> spent = std::chrono::steady_clock::now() - start_;
  if (outcome) {
    spdlog::debug("event=call method={} code=0 ms={:.3f}", method_, spent.count());
    return grpc::Status::OK;
  }
  const Error error = Shown(std::move(outcome).error());
  const grpc::Status status = StatusOf(error);
  spdlog::info("event=call method={} code={} reason={} ms={:.3f} message={}", method_,
               static_cast<int>(status.error_code()), ReasonName(error.code), spent.count(),
               LogValue(status.error_message()));
  return status;
}

}  // namespace posespace
