// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_SUPPORT_FAILS_WITH_H_
#define POSESPACE_TESTS_SUPPORT_FAILS_WITH_H_

#include <gmock/gmock.h>

#include <string>

#include "geometry/result.h"

namespace posespace {

// A Result that is the refusal `code`:  EXPECT_THAT(Build(...), FailsWith(ErrorCode::kNoShapes)).
MATCHER_P(FailsWith, code, "fails with " + std::string(ReasonName(code))) {
  if (arg.has_value()) {
    *result_listener << "succeeds";
    return false;
  }
  *result_listener << "fails with " << ReasonName(arg.error().code) << ": " << arg.error().message;
  return arg.error().code == code;
}

// The same, with a field among the places at fault.
MATCHER_P2(FailsWith, code, field,
           "fails with " + std::string(ReasonName(code)) + " at " + std::string(field)) {
  if (arg.has_value()) {
    *result_listener << "succeeds";
    return false;
  }
  const Error& error = arg.error();
  *result_listener << "fails with " << ReasonName(error.code) << ": " << error.message << " at";
  bool found = false;
  for (const Violation& violation : error.where) {
    *result_listener << " " << violation.field;
    found = found || violation.field == field;
  }
  return error.code == code && found;
}

// A Result that has a value; the message is shown when it has none.
MATCHER(Succeeds, "succeeds") {
  if (!arg.has_value()) {
    *result_listener << "fails with " << ReasonName(arg.error().code) << ": "
                     << arg.error().message;
  }
  return arg.has_value();
}

}  // namespace posespace

#endif  // POSESPACE_TESTS_SUPPORT_FAILS_WITH_H_
