// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_STORE_OPEN_STORE_H_
#define POSESPACE_STORE_OPEN_STORE_H_

#include <memory>
#include <string>

#include "store/store.h"

namespace posespace {

// The store that `where` names: "memory" or "sqlite:PATH".
// Fails  kInvalidOption (neither), and as SqliteStore::Open.
Result<std::unique_ptr<Store>> OpenStore(const std::string& where);

}  // namespace posespace

#endif  // POSESPACE_STORE_OPEN_STORE_H_
