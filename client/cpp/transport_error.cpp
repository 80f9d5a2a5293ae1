// SPDX-License-Identifier: Apache-2.0
#include "client/cpp/transport_error.h"

#include <google/rpc/error_details.pb.h>
#include <google/rpc/status.pb.h>

#include <array>
#include <cstdint>
#include <cstdio>
#include <map>
#include <optional>
#include <regex>
#include <utility>

namespace posespace {

std::string_view Name(ErrorCode code) {
  switch (code) {
    case ErrorCode::kInvalidArgument:
      return "InvalidArgument";
    case ErrorCode::kInvalidDrawing:
      return "InvalidDrawing";
    case ErrorCode::kNotFound:
      return "NotFound";
    case ErrorCode::kAlreadyExists:
      return "AlreadyExists";
    case ErrorCode::kNotBuilt:
      return "NotBuilt";
    case ErrorCode::kConflict:
      return "Conflict";
    case ErrorCode::kResourceExhausted:
      return "ResourceExhausted";
    case ErrorCode::kUnavailable:
      return "Unavailable";
    case ErrorCode::kDeadlineExceeded:
      return "DeadlineExceeded";
    case ErrorCode::kCancelled:
      return "Cancelled";
    case ErrorCode::kUnauthenticated:
      return "Unauthenticated";
    case ErrorCode::kPermissionDenied:
      return "PermissionDenied";
    case ErrorCode::kInternal:
      return "Internal";
    case ErrorCode::kUnknown:
      return "Unknown";
  }
  return "Unknown";
}

namespace internal {
namespace {

// By number of google.rpc.Code, from OK on.
constexpr std::array<ErrorCode, 17> kByStatus = {
    ErrorCode::kUnknown,            // OK
    ErrorCode::kCancelled,          // CANCELLED
    ErrorCode::kUnknown,            // UNKNOWN
    ErrorCode::kInvalidArgument,    // INVALID_ARGUMENT
    ErrorCode::kDeadlineExceeded,   // DEADLINE_EXCEEDED
    ErrorCode::kNotFound,           // NOT_FOUND
    ErrorCode::kAlreadyExists,      // ALREADY_EXISTS
    ErrorCode::kPermissionDenied,   // PERMISSION_DENIED
    ErrorCode::kResourceExhausted,  // RESOURCE_EXHAUSTED
    ErrorCode::kNotBuilt,           // FAILED_PRECONDITION
    ErrorCode::kConflict,           // ABORTED
    ErrorCode::kInvalidArgument,    // OUT_OF_RANGE
    ErrorCode::kUnknown,            // UNIMPLEMENTED
    ErrorCode::kInternal,           // INTERNAL
    ErrorCode::kUnavailable,        // UNAVAILABLE
    ErrorCode::kInternal,           // DATA_LOSS
    ErrorCode::kUnauthenticated,    // UNAUTHENTICATED
};

// Builds and streams carry reasons without a status code; what is not here is an invalid argument.
const std::map<std::string_view, ErrorCode> kByReason = {
    {"BUILD_FAILED", ErrorCode::kNotBuilt},
    {"BUILD_NOT_FOUND", ErrorCode::kNotFound},
    {"BUILD_QUEUE_FULL", ErrorCode::kResourceExhausted},
    {"BUILD_TIMEOUT", ErrorCode::kDeadlineExceeded},
    {"CANCELLED", ErrorCode::kCancelled},
    {"COMPUTE_QUEUE_FULL", ErrorCode::kResourceExhausted},
    {"DRAINING", ErrorCode::kUnavailable},
    {"ETAG_MISMATCH", ErrorCode::kConflict},
    {"INTERNAL", ErrorCode::kInternal},
    {"NO_SHAPES", ErrorCode::kNotBuilt},
    {"REVISION_NOT_FOUND", ErrorCode::kNotFound},
    {"SESSION_EXISTS", ErrorCode::kAlreadyExists},
    {"SESSION_LIMIT", ErrorCode::kResourceExhausted},
    {"SESSION_NOT_BUILT", ErrorCode::kNotBuilt},
    {"SESSION_NOT_FOUND", ErrorCode::kNotFound},
    {"SHAPE_EXISTS", ErrorCode::kAlreadyExists},
    {"SHAPE_NOT_FOUND", ErrorCode::kNotFound},
    {"SLOT_NOT_BOUND", ErrorCode::kNotBuilt},
    {"SNAPSHOT_CORRUPT", ErrorCode::kInternal},
    {"STORE_UNAVAILABLE", ErrorCode::kUnavailable},
    {"STREAM_LIMIT", ErrorCode::kResourceExhausted},
};

bool IsOfADrawing(const std::string& reason) {
  return reason.starts_with("IMAGE_") || reason.starts_with("OUTLINE_") ||
         reason == "SHAPE_SOURCE_MISSING";
}

std::string Number(double value) {
  char text[32];
  std::snprintf(text, sizeof(text), "%g", value);
  return text;
}

struct Details {
  std::string reason;
  Error::Fields fields;
  std::optional<Error::Seconds> retry_after;
};

Details DetailsFrom(const std::string& bytes) {
  Details details;
  google::rpc::Status status;
  if (!status.ParseFromString(bytes)) return details;
  google::rpc::ErrorInfo info;
  google::rpc::BadRequest bad_request;
  google::rpc::RetryInfo retry;
  for (const auto& detail : status.details()) {
    if (detail.UnpackTo(&info)) {
      details.reason = info.reason();
    } else if (detail.UnpackTo(&bad_request)) {
      for (const auto& at_fault : bad_request.field_violations()) {
        std::string& said = details.fields[at_fault.field()];
        said += (said.empty() ? "" : "; ") + at_fault.description();
      }
    } else if (detail.UnpackTo(&retry)) {
      const auto& delay = retry.retry_delay();
      details.retry_after =
          Error::Seconds(static_cast<double>(delay.seconds()) + 1e-9 * delay.nanos());
    }
  }
  return details;
}

// The transport refuses a request that is too large in its own words, without the sizes' meaning.
std::optional<Error> TooLarge(const std::string& message, std::size_t request_bytes) {
  static const std::regex said("[Rr]eceived message larger than max \\(\\d+ vs\\.? (\\d+)\\)");
  std::smatch found;
  if (request_bytes == 0 || !std::regex_search(message, found, said)) return std::nullopt;
  constexpr double kMebibyte = 1 << 20;
  char size[32];
  std::snprintf(size, sizeof(size), "%.1f", static_cast<double>(request_bytes) / kMebibyte);
  return Error(ErrorCode::kResourceExhausted,
               "the request has " + std::string(size) + " MiB; the service takes at most " +
                   Number(std::stod(found[1]) / kMebibyte) + " MiB at once",
               "REQUEST_TOO_LARGE");
}

}  // namespace

Error ErrorOfCall(const FailedCall& call, const std::string& address, double timeout_seconds,
                  std::size_t request_bytes) {
  const bool known = call.code >= 0 && call.code < static_cast<int>(kByStatus.size());
  ErrorCode code = known ? kByStatus[static_cast<std::size_t>(call.code)] : ErrorCode::kUnknown;
  Details details = DetailsFrom(call.details);
  if (code == ErrorCode::kInvalidArgument && IsOfADrawing(details.reason)) {
    code = ErrorCode::kInvalidDrawing;
  }
  std::string message = call.message;
  if (details.reason.empty()) {  // the transport's own words, which do not say where
    if (code == ErrorCode::kResourceExhausted) {
      if (auto too_large = TooLarge(message, request_bytes)) return *std::move(too_large);
    } else if (code == ErrorCode::kUnavailable) {
      message = "the service at " + address + " is not there: " + message;
    } else if (code == ErrorCode::kDeadlineExceeded && timeout_seconds > 0.0) {
      return NoAnswer(address, timeout_seconds);
    } else if (code == ErrorCode::kUnknown) {
      message = "status " + std::to_string(call.code) + ": " + message;
    }
  }
  return Error(code, message, std::move(details.reason), std::move(details.fields),
               details.retry_after);
}

Error ErrorOfReason(const std::string& reason, const std::string& message, Error::Fields fields) {
  const auto found = kByReason.find(reason);
  const ErrorCode code = IsOfADrawing(reason)       ? ErrorCode::kInvalidDrawing
                         : found != kByReason.end() ? found->second
                                                    : ErrorCode::kInvalidArgument;
  return Error(code, message, reason, std::move(fields));
}

Error NoAnswer(const std::string& address, double seconds) {
  return Error(ErrorCode::kDeadlineExceeded,
               "no answer from " + address + " within " + Number(seconds) + " s");
}

}  // namespace internal
}  // namespace posespace
