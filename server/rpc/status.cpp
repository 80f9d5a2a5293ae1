// SPDX-License-Identifier: Apache-2.0
#include "rpc/status.h"

#include <google/rpc/error_details.pb.h>
#include <google/rpc/status.pb.h>

#include <cstddef>
#include <string>
#include <string_view>

#include "rpc/shown_error.h"

namespace posespace {
namespace {

constexpr std::string_view kDomain = "posespace.v1";
constexpr std::size_t kMessageBytes = 512;
constexpr std::size_t kFieldBytes = 128;
constexpr std::size_t kDescriptionBytes = 256;
constexpr std::size_t kViolationBytes = 2'800;  // of all violations: the rest of 4 KiB stays free
constexpr int kViolations = 20;

// How long a caller should wait before it tries again, seconds; 0 where trying again cannot help.
int RetrySeconds(grpc::StatusCode code) {
  return code == grpc::StatusCode::RESOURCE_EXHAUSTED || code == grpc::StatusCode::UNAVAILABLE ? 1
                                                                                               : 0;
}

}  // namespace

grpc::StatusCode StatusCodeOf(ErrorCode code) {
  switch (code) {
    case ErrorCode::kImageUndecodable:
    case ErrorCode::kImageTooLarge:
    case ErrorCode::kOutlineEmpty:
    case ErrorCode::kOutlineTooSmall:
    case ErrorCode::kOutlineNotSimple:
    case ErrorCode::kOutlineTooLong:
    case ErrorCode::kShapeSourceMissing:
    case ErrorCode::kLandmarkNotFinite:
    case ErrorCode::kLandmarkOffOutline:
    case ErrorCode::kLandmarksOutOfOrder:
    case ErrorCode::kTooManyLandmarks:
    case ErrorCode::kTooManyShapes:
    case ErrorCode::kMeshTooLarge:
    case ErrorCode::kSizeMismatch:
    case ErrorCode::kPlacementNotFinite:
    case ErrorCode::kPlacementsCoincide:
    case ErrorCode::kPoseNotFinite:
    case ErrorCode::kWeightsNotFinite:
    case ErrorCode::kWeightsSumNotOne:
    case ErrorCode::kWeightsCountMismatch:
    case ErrorCode::kTooManyQueries:
    case ErrorCode::kPathInvalid:
    case ErrorCode::kTooManyFrames:
    case ErrorCode::kInvalidId:
    case ErrorCode::kInvalidOption:
    case ErrorCode::kSlotLimit:
    case ErrorCode::kProtocolBreach:
      return grpc::StatusCode::INVALID_ARGUMENT;
    case ErrorCode::kSessionNotFound:
    case ErrorCode::kShapeNotFound:
    case ErrorCode::kRevisionNotFound:
    case ErrorCode::kBuildNotFound:
      return grpc::StatusCode::NOT_FOUND;
    case ErrorCode::kSessionExists:
    case ErrorCode::kShapeExists:
      return grpc::StatusCode::ALREADY_EXISTS;
    case ErrorCode::kEtagMismatch:
    case ErrorCode::kSuperseded:
      return grpc::StatusCode::ABORTED;
    case ErrorCode::kNoShapes:
    case ErrorCode::kSessionNotBuilt:
    case ErrorCode::kBuildFailed:
    case ErrorCode::kSlotNotBound:
      return grpc::StatusCode::FAILED_PRECONDITION;
    case ErrorCode::kCancelled:
      return grpc::StatusCode::CANCELLED;
    case ErrorCode::kBuildTimeout:
      return grpc::StatusCode::DEADLINE_EXCEEDED;
    case ErrorCode::kSessionLimit:
    case ErrorCode::kStreamLimit:
    case ErrorCode::kBuildQueueFull:
    case ErrorCode::kComputeQueueFull:
      return grpc::StatusCode::RESOURCE_EXHAUSTED;
    case ErrorCode::kDraining:
    case ErrorCode::kStoreUnavailable:
      return grpc::StatusCode::UNAVAILABLE;
    case ErrorCode::kSnapshotCorrupt:
      return grpc::StatusCode::DATA_LOSS;
    case ErrorCode::kInternal:
      return grpc::StatusCode::INTERNAL;
  }
  return grpc::StatusCode::INTERNAL;
}

grpc::Status StatusOf(const Error& error) {
  const grpc::StatusCode code = StatusCodeOf(error.code);
  google::rpc::Status status;
  status.set_code(code);
  status.set_message(CleanText(error.message, kMessageBytes));

  google::rpc::BadRequest fields;
  std::size_t bytes = 0;
  for (const Violation& violation : error.where) {
    if (fields.field_violations_size() == kViolations) break;
    auto* added = fields.add_field_violations();
    added->set_field(CleanText(violation.field, kFieldBytes));
    added->set_description(CleanText(violation.description, kDescriptionBytes));
    bytes += added->ByteSizeLong() + 3;
    if (bytes > kViolationBytes) {
      fields.mutable_field_violations()->RemoveLast();
      break;
    }
  }

  google::rpc::ErrorInfo info;
  info.set_reason(std::string(ReasonName(error.code)));
  info.set_domain(std::string(kDomain));
  const std::size_t kept = static_cast<std::size_t>(fields.field_violations_size());
  if (kept < error.where.size()) {
    (*info.mutable_metadata())["truncated"] = std::to_string(error.where.size() - kept);
  }
  status.add_details()->PackFrom(info);
  if (kept > 0) status.add_details()->PackFrom(fields);
  if (const int seconds = RetrySeconds(code); seconds > 0) {
    google::rpc::RetryInfo retry;
    retry.mutable_retry_delay()->set_seconds(seconds);
    status.add_details()->PackFrom(retry);
  }
  return {code, status.message(), status.SerializeAsString()};
}

}  // namespace posespace
