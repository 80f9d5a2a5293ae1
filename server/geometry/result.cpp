// SPDX-License-Identifier: Apache-2.0
#include "geometry/result.h"

namespace posespace {

std::string_view ReasonName(ErrorCode code) {
  switch (code) {
    case ErrorCode::kImageUndecodable:
      return "IMAGE_UNDECODABLE";
    case ErrorCode::kImageTooLarge:
      return "IMAGE_TOO_LARGE";
    case ErrorCode::kOutlineEmpty:
      return "OUTLINE_EMPTY";
    case ErrorCode::kOutlineTooSmall:
      return "OUTLINE_TOO_SMALL";
    case ErrorCode::kOutlineNotSimple:
      return "OUTLINE_SELF_INTERSECTS";
    case ErrorCode::kOutlineTooLong:
      return "OUTLINE_TOO_LONG";
    case ErrorCode::kShapeSourceMissing:
      return "SHAPE_SOURCE_MISSING";
    case ErrorCode::kLandmarkNotFinite:
      return "LANDMARK_NOT_FINITE";
    case ErrorCode::kLandmarkOffOutline:
      return "LANDMARK_OFF_OUTLINE";
    case ErrorCode::kLandmarksOutOfOrder:
      return "LANDMARKS_OUT_OF_ORDER";
    case ErrorCode::kTooManyLandmarks:
      return "TOO_MANY_LANDMARKS";
    case ErrorCode::kNoShapes:
      return "NO_SHAPES";
    case ErrorCode::kTooManyShapes:
      return "TOO_MANY_SHAPES";
    case ErrorCode::kMeshTooLarge:
      return "MESH_TOO_LARGE";
    case ErrorCode::kSizeMismatch:
      return "SIZE_MISMATCH";
    case ErrorCode::kPlacementNotFinite:
      return "PLACEMENT_NOT_FINITE";
    case ErrorCode::kPlacementsCoincide:
      return "PLACEMENTS_COINCIDE";
    case ErrorCode::kPoseNotFinite:
      return "POSE_NOT_FINITE";
    case ErrorCode::kWeightsNotFinite:
      return "WEIGHTS_NOT_FINITE";
    case ErrorCode::kWeightsSumNotOne:
      return "WEIGHTS_SUM_NOT_ONE";
    case ErrorCode::kWeightsCountMismatch:
      return "WEIGHTS_COUNT_MISMATCH";
    case ErrorCode::kTooManyQueries:
      return "TOO_MANY_QUERIES";
    case ErrorCode::kPathInvalid:
      return "PATH_INVALID";
    case ErrorCode::kTooManyFrames:
      return "TOO_MANY_FRAMES";
    case ErrorCode::kInvalidId:
      return "INVALID_ID";
    case ErrorCode::kInvalidOption:
      return "INVALID_OPTION";
    case ErrorCode::kSessionNotFound:
      return "SESSION_NOT_FOUND";
    case ErrorCode::kShapeNotFound:
      return "SHAPE_NOT_FOUND";
    case ErrorCode::kRevisionNotFound:
      return "REVISION_NOT_FOUND";
    case ErrorCode::kBuildNotFound:
      return "BUILD_NOT_FOUND";
    case ErrorCode::kSessionExists:
      return "SESSION_EXISTS";
    case ErrorCode::kShapeExists:
      return "SHAPE_EXISTS";
    case ErrorCode::kEtagMismatch:
      return "ETAG_MISMATCH";
    case ErrorCode::kSessionNotBuilt:
      return "SESSION_NOT_BUILT";
    case ErrorCode::kBuildFailed:
      return "BUILD_FAILED";
    case ErrorCode::kCancelled:
      return "CANCELLED";
    case ErrorCode::kBuildTimeout:
      return "BUILD_TIMEOUT";
    case ErrorCode::kSessionLimit:
      return "SESSION_LIMIT";
    case ErrorCode::kStreamLimit:
      return "STREAM_LIMIT";
    case ErrorCode::kSlotLimit:
      return "SLOT_LIMIT";
    case ErrorCode::kSlotNotBound:
      return "SLOT_NOT_BOUND";
    case ErrorCode::kSuperseded:
      return "SUPERSEDED";
    case ErrorCode::kBuildQueueFull:
      return "BUILD_QUEUE_FULL";
    case ErrorCode::kComputeQueueFull:
      return "COMPUTE_QUEUE_FULL";
    case ErrorCode::kDraining:
      return "DRAINING";
    case ErrorCode::kProtocolBreach:
      return "PROTOCOL_BREACH";
    case ErrorCode::kStoreUnavailable:
      return "STORE_UNAVAILABLE";
    case ErrorCode::kSnapshotCorrupt:
      return "SNAPSHOT_CORRUPT";
    case ErrorCode::kInternal:
      return "INTERNAL";
  }
  return "INTERNAL";
}

Error ErrorAt(ErrorCode code, std::string field, const std::string& description) {
  const std::string message = field + " " + description;
  return Error{code, message, {{std::move(field), description}}};
}

Error Under(const std::string& outer, Error error) {
  for (Violation& violation : error.where) violation.field = outer + "." + violation.field;
  return error;
}

}  // namespace posespace
