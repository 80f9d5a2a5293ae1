// SPDX-License-Identifier: Apache-2.0
#include "rpc/status.h"

#include <gmock/gmock.h>
#include <google/rpc/error_details.pb.h>
#include <google/rpc/status.pb.h>

#include <string>

namespace posespace {
namespace {

constexpr std::size_t kMostDetailBytes = 4'096;

google::rpc::Status DetailsOf(const grpc::Status& status) {
  google::rpc::Status details;
  EXPECT_TRUE(details.ParseFromString(status.error_details()));
  return details;
}

// The detail of a type, or its default when there is none.
template <typename Detail>
Detail Find(const google::rpc::Status& details) {
  Detail found;
  for (const auto& any : details.details()) {
    if (any.Is<Detail>()) any.UnpackTo(&found);
  }
  return found;
}

template <typename Detail>
bool Has(const google::rpc::Status& details) {
  for (const auto& any : details.details()) {
    if (any.Is<Detail>()) return true;
  }
  return false;
}

TEST(Status, EveryReasonHasACodeAndAName) {
  for (int k = 0; k <= static_cast<int>(ErrorCode::kInternal); ++k) {
    const ErrorCode code = static_cast<ErrorCode>(k);
    const grpc::Status status = StatusOf({code, "why", {}});
    EXPECT_NE(status.error_code(), grpc::StatusCode::OK) << k;
    EXPECT_EQ(status.error_code() == grpc::StatusCode::INTERNAL, code == ErrorCode::kInternal)
        << ReasonName(code);
    const google::rpc::Status details = DetailsOf(status);
    EXPECT_EQ(details.code(), status.error_code());
    EXPECT_EQ(details.message(), "why");
    EXPECT_EQ(Find<google::rpc::ErrorInfo>(details).reason(), ReasonName(code));
    EXPECT_EQ(Find<google::rpc::ErrorInfo>(details).domain(), "posespace.v1");
  }
}

TEST(Status, CodesAreThoseOfTheContract) {
  EXPECT_EQ(StatusCodeOf(ErrorCode::kOutlineNotSimple), grpc::StatusCode::INVALID_ARGUMENT);
  EXPECT_EQ(StatusCodeOf(ErrorCode::kSessionNotFound), grpc::StatusCode::NOT_FOUND);
  EXPECT_EQ(StatusCodeOf(ErrorCode::kSessionExists), grpc::StatusCode::ALREADY_EXISTS);
  EXPECT_EQ(StatusCodeOf(ErrorCode::kSessionNotBuilt), grpc::StatusCode::FAILED_PRECONDITION);
  EXPECT_EQ(StatusCodeOf(ErrorCode::kEtagMismatch), grpc::StatusCode::ABORTED);
  EXPECT_EQ(StatusCodeOf(ErrorCode::kStreamLimit), grpc::StatusCode::RESOURCE_EXHAUSTED);
  EXPECT_EQ(StatusCodeOf(ErrorCode::kDraining), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(StatusCodeOf(ErrorCode::kStoreUnavailable), grpc::StatusCode::UNAVAILABLE);
  EXPECT_EQ(StatusCodeOf(ErrorCode::kSnapshotCorrupt), grpc::StatusCode::DATA_LOSS);
}

TEST(Status, SaysWhenTryingAgainHelps) {
  for (const ErrorCode code :
       {ErrorCode::kBuildQueueFull, ErrorCode::kDraining, ErrorCode::kStoreUnavailable}) {
    const auto details = DetailsOf(StatusOf({code, "later", {}}));
    EXPECT_GT(Find<google::rpc::RetryInfo>(details).retry_delay().seconds(), 0);
  }
  const auto details = DetailsOf(StatusOf({ErrorCode::kOutlineEmpty, "never", {}}));
  EXPECT_FALSE(Has<google::rpc::RetryInfo>(details));
}

TEST(Status, NamesTheFieldsAtFault) {
  const auto details = DetailsOf(StatusOf(
      {ErrorCode::kLandmarkOffOutline, "two", {{"tuples[3].points['walk']", "is far away"}}}));
  const auto fields = Find<google::rpc::BadRequest>(details);
  ASSERT_EQ(fields.field_violations_size(), 1);
  EXPECT_EQ(fields.field_violations(0).field(), "tuples[3].points['walk']");
  EXPECT_EQ(fields.field_violations(0).description(), "is far away");
  EXPECT_TRUE(Find<google::rpc::ErrorInfo>(details).metadata().empty());
}

TEST(Status, WithoutFieldsHasNoBadRequest) {
  const auto details = DetailsOf(StatusOf({ErrorCode::kOutlineEmpty, "nothing", {}}));
  EXPECT_FALSE(Has<google::rpc::BadRequest>(details));
}

TEST(Status, KeepsTwentyViolationsAndCountsTheRest) {
  Error error{ErrorCode::kLandmarkOffOutline, "many", {}};
  for (int k = 0; k < 1'000; ++k) error.where.push_back({"tuples[" + std::to_string(k) + "]", "x"});
  const grpc::Status status = StatusOf(error);
  EXPECT_LT(status.error_details().size(), kMostDetailBytes);
  const auto details = DetailsOf(status);
  EXPECT_EQ(Find<google::rpc::BadRequest>(details).field_violations_size(), 20);
  EXPECT_EQ(Find<google::rpc::ErrorInfo>(details).metadata().at("truncated"), "980");
}

TEST(Status, StaysUnderFourKibibytesHoweverLongTheTexts) {
  Error error{ErrorCode::kLandmarkOffOutline, std::string(1 << 20, 'm'), {}};
  for (int k = 0; k < 1'000; ++k) {
    error.where.push_back({std::string(10'000, 'f'), std::string(10'000, 'd')});
  }
  const grpc::Status status = StatusOf(error);
  EXPECT_LT(status.error_details().size(), kMostDetailBytes);
  EXPECT_LE(status.error_message().size(), 512u);
  const auto details = DetailsOf(status);
  const int kept = Find<google::rpc::BadRequest>(details).field_violations_size();
  EXPECT_GT(kept, 0);
  EXPECT_EQ(Find<google::rpc::ErrorInfo>(details).metadata().at("truncated"),
            std::to_string(1'000 - kept));
}

TEST(Status, TakesTextThatIsNotUtf8) {
  const grpc::Status status =
      StatusOf({ErrorCode::kInvalidId, "id '\xff\xfe'", {{"shape\xff", "is \xc3"}}});
  EXPECT_EQ(status.error_message(), "id '\?\?'");
  EXPECT_EQ(Find<google::rpc::BadRequest>(DetailsOf(status)).field_violations(0).field(), "shape?");
}

}  // namespace
}  // namespace posespace
