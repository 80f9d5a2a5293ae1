// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_SUPPORT_FAILURE_H_
#define POSESPACE_TESTS_SUPPORT_FAILURE_H_

#include <gmock/gmock.h>

#include <string>

#include "geometry/result.h"

namespace posespace {

// EXPECT_THAT(result, FailsWith(ErrorCode::kOutlineEmpty));
MATCHER_P(FailsWith, code, "fails with " + std::string(ReasonName(code))) {
  if (arg.has_value()) {
    *result_listener << "which is a value";
    return false;
  }
  *result_listener << "which fails with " << ReasonName(arg.error().code) << ": "
                   << arg.error().message;
  return arg.error().code == code;
}

// The same, where the message must also contain `text`.
MATCHER_P2(FailsWith, code, text, "fails with " + std::string(ReasonName(code)) + ": " + text) {
  if (arg.has_value()) {
    *result_listener << "which is a value";
    return false;
  }
  *result_listener << "which fails with " << ReasonName(arg.error().code) << ": "
                   << arg.error().message;
  return arg.error().code == code && arg.error().message.find(text) != std::string::npos;
}

}  // namespace posespace

#endif  // POSESPACE_TESTS_SUPPORT_FAILURE_H_
