// SPDX-License-Identifier: Apache-2.0
#include "posespace/error.h"

#include <gmock/gmock.h>

#include "client/cpp/transport_error.h"

namespace posespace {
namespace {

using internal::ErrorOfCall;
using internal::ErrorOfReason;
using ::testing::HasSubstr;

constexpr int kDeadlineExceeded = 4, kResourceExhausted = 8, kDataLoss = 15, kUnavailable = 14;

TEST(Error, OfATransportSaysWhere) {
  const Error gone = ErrorOfCall({kUnavailable, "connect failed", ""}, "host:1");
  EXPECT_EQ(gone.code(), ErrorCode::kUnavailable);
  EXPECT_STREQ(gone.what(), "the service at host:1 is not there: connect failed");
  const Error late = ErrorOfCall({kDeadlineExceeded, "Deadline Exceeded", ""}, "host:1", 2.5);
  EXPECT_EQ(late.code(), ErrorCode::kDeadlineExceeded);
  EXPECT_STREQ(late.what(), "no answer from host:1 within 2.5 s");
  EXPECT_FALSE(late.retry_after());
}

TEST(Error, OfARequestThatIsTooLargeNamesBothSizes) {
  const Error error = ErrorOfCall(
      {kResourceExhausted, "Received message larger than max (25000000 vs. 16777216)", ""},
      "host:1", 5.0, 25'000'000);
  EXPECT_EQ(error.reason(), "REQUEST_TOO_LARGE");
  EXPECT_STREQ(error.what(), "the request has 23.8 MiB; the service takes at most 16 MiB at once");
}

TEST(Error, OfAnUnknownStatusIsStillAnError) {
  EXPECT_EQ(ErrorOfCall({kDataLoss, "bad", ""}, "a").code(), ErrorCode::kInternal);
  const Error odd = ErrorOfCall({99, "odd", "no details"}, "a");
  EXPECT_EQ(odd.code(), ErrorCode::kUnknown);
  EXPECT_THAT(odd.what(), HasSubstr("99"));
}

TEST(Error, OfAReasonHasTheKindThatItsCallWouldHaveHad) {
  const std::vector<std::pair<std::string, ErrorCode>> cases = {
      {"SESSION_NOT_FOUND", ErrorCode::kNotFound},
      {"SLOT_NOT_BOUND", ErrorCode::kNotBuilt},
      {"DRAINING", ErrorCode::kUnavailable},
      {"BUILD_TIMEOUT", ErrorCode::kDeadlineExceeded},
      {"OUTLINE_EMPTY", ErrorCode::kInvalidDrawing},
      {"IMAGE_TOO_LARGE", ErrorCode::kInvalidDrawing},
      {"POSE_NOT_FINITE", ErrorCode::kInvalidArgument},
  };
  for (const auto& [reason, code] : cases) {
    const Error error = ErrorOfReason(reason, "why", {{"field", "why"}});
    EXPECT_EQ(error.code(), code) << reason;
    EXPECT_EQ(error.reason(), reason);
    EXPECT_EQ(error.fields().at("field"), "why");
  }
}

TEST(Error, EveryKindHasItsName) {
  for (int code = 0; code < static_cast<int>(ErrorCode::kUnknown); ++code) {
    EXPECT_NE(Name(static_cast<ErrorCode>(code)), "Unknown");
  }
}

}  // namespace
}  // namespace posespace
