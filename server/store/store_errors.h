// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_STORE_STORE_ERRORS_H_
#define POSESPACE_STORE_STORE_ERRORS_H_

#include <string>

#include "geometry/result.h"

// What every store refuses in the same words; private to this folder.

namespace posespace {

inline Error StoredAlready(const std::string& id) {
  return Error{ErrorCode::kSessionExists,
               "session '" + id + "' is there already",
               {{"session_id", "is taken"}}};
}

inline Error NotStored(const std::string& id) {
  return Error{ErrorCode::kSessionNotFound, "there is no session '" + id + "'", {}};
}

inline Error BlobMissing(const std::string& key) {
  return Error{ErrorCode::kSnapshotCorrupt, "the store has lost '" + key + "'", {}};
}

}  // namespace posespace

#endif  // POSESPACE_STORE_STORE_ERRORS_H_
