// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_IDS_H_
#define POSESPACE_SESSION_IDS_H_

#include <string>

#include "geometry/result.h"

namespace posespace {

// An id as sessions and shapes have it: 1-63 of letters, digits, '_', '.', '-', beginning with a
// letter or digit.  Fails with kInvalidId, naming `what` and the id.
Result<void> CheckId(const std::string& what, const std::string& id);

// What a caller sent as an id, in quotes for a message, which must not grow with it: cut where no
// id is as long.
std::string Quoted(const std::string& id);

}  // namespace posespace

#endif  // POSESPACE_SESSION_IDS_H_
