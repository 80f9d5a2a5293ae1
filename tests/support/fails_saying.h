// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_SUPPORT_FAILS_SAYING_H_
#define POSESPACE_TESTS_SUPPORT_FAILS_SAYING_H_

#include <gmock/gmock.h>

#include <string>

#include "geometry/result.h"

namespace posespace {

// A Result that is the refusal `code` with a message that contains `text`:
// EXPECT_THAT(TraceOutline(...), FailsSaying(ErrorCode::kOutlineTooSmall, "at least 16")).
MATCHER_P2(FailsSaying, code, text,
           "fails with " + std::string(ReasonName(code)) + ": ..." + std::string(text) + "...") {
  if (arg.has_value()) {
    *result_listener << "succeeds";
    return false;
  }
  *result_listener << "fails with " << ReasonName(arg.error().code) << ": " << arg.error().message;
  return arg.error().code == code && arg.error().message.find(text) != std::string::npos;
}

}  // namespace posespace

#endif  // POSESPACE_TESTS_SUPPORT_FAILS_SAYING_H_
