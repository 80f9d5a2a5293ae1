// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_GEOMETRY_RESULT_H_
#define POSESPACE_GEOMETRY_RESULT_H_

#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

namespace posespace {

// Why a call was refused.  Each value has one name on the wire (ReasonName) and one gRPC status
// (rpc/status.cpp); a new value does not compile until both know it.
enum class ErrorCode {
  // A drawing that cannot be used.
  kImageUndecodable,    // not a picture, or damaged
  kImageTooLarge,       // more pixels than the limit, read from the header
  kOutlineEmpty,        // nothing painted
  kOutlineTooSmall,     // too few painted pixels, or an outline without area
  kOutlineNotSimple,    // a ring that crosses itself
  kOutlineTooLong,      // more outline points than the limit
  kShapeSourceMissing,  // a PutShape without a picture or a polygon
  // Correspondences.
  kLandmarkNotFinite,
  kLandmarkOffOutline,  // too far from the outline it should mark
  kLandmarksOutOfOrder,
  kTooManyLandmarks,
  // Building.
  kNoShapes,
  kTooManyShapes,
  kMeshTooLarge,
  kSizeMismatch,  // rows that should correspond do not
  // Pose space and blending.
  kPlacementNotFinite,
  kPlacementsCoincide,
  kPoseNotFinite,
  kWeightsNotFinite,
  kWeightsSumNotOne,
  kWeightsCountMismatch,
  kTooManyQueries,
  kPathInvalid,  // waypoints without order in time, or without length
  kTooManyFrames,
  // Names and states.
  kInvalidId,
  kInvalidOption,
  kSessionNotFound,
  kShapeNotFound,
  kRevisionNotFound,
  kBuildNotFound,
  kSessionExists,
  kShapeExists,
  kEtagMismatch,
  kSessionNotBuilt,
  kBuildFailed,
  kCancelled,
  kBuildTimeout,
  // Quotas and life cycle.
  kSessionLimit,
  kStreamLimit,
  kSlotLimit,
  kSlotNotBound,  // an item of a stream that names a slot without a session
  kSuperseded,    // an item of a stream that a later one replaces
  kBuildQueueFull,
  kComputeQueueFull,
  kDraining,
  kProtocolBreach,    // a stream message that makes no sense in its state
  kStoreUnavailable,  // what should be kept cannot be written, or read, at present
  kSnapshotCorrupt,   // stored bytes are damaged
  kInternal,
};

// The wire name of a code: kOutlineEmpty -> "OUTLINE_EMPTY".
std::string_view ReasonName(ErrorCode code);

// One thing that is wrong, and where: `field` is the request's own path, such as "image.data",
// "polygon.holes[2][5]" or "tuples[3].points['walk']"; of a build, "shapes['walk'].outline[17]".
struct Violation {
  std::string field;
  std::string description;
};

// A refusal.  The message names the drawing, the point and the limit, for a person to read.
struct Error {
  ErrorCode code = ErrorCode::kInternal;
  std::string message;
  std::vector<Violation> where;  // every place at fault, when places are at fault
};

// A refusal of one field's value: the message is the field and what is wrong with it.
Error ErrorAt(ErrorCode code, std::string field, const std::string& description);

// The same error, its fields inside of another: "at" under "queries[3]" is "queries[3].at".
Error Under(const std::string& outer, Error error);

// A value or the reason why there is none; the surface of std::expected<T, Error>.
template <typename T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : state_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  bool has_value() const { return std::holds_alternative<T>(state_); }
  explicit operator bool() const { return has_value(); }
  T& value() & { return std::get<T>(state_); }
  const T& value() const& { return std::get<T>(state_); }
  T&& value() && { return std::get<T>(std::move(state_)); }
  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }
  Error& error() & { return std::get<Error>(state_); }
  const Error& error() const& { return std::get<Error>(state_); }
  Error&& error() && { return std::get<Error>(std::move(state_)); }

 private:
  std::variant<T, Error> state_;
};

template <>
class [[nodiscard]] Result<void> {
 public:
  Result() = default;
  Result(Error error) : state_(std::move(error)) {}  // NOLINT(google-explicit-constructor)

  bool has_value() const { return state_.index() == 0; }
  explicit operator bool() const { return has_value(); }
  void value() && {}
  Error& error() & { return std::get<Error>(state_); }
  const Error& error() const& { return std::get<Error>(state_); }
  Error&& error() && { return std::get<Error>(std::move(state_)); }

 private:
  std::variant<std::monostate, Error> state_;
};

// The value of a Result, or an early return of its error:  const auto mesh = TRY(Build(...));
#define TRY(expression)                                      \
  __extension__({                                            \
    auto try_result_ = (expression);                         \
    if (!try_result_) return std::move(try_result_).error(); \
    std::move(try_result_).value();                          \
  })

}  // namespace posespace

#endif  // POSESPACE_GEOMETRY_RESULT_H_
