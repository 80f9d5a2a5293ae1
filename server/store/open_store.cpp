// SPDX-License-Identifier: Apache-2.0
#include "store/open_store.h"

#include "store/memory_store.h"
#include "store/sqlite_store.h"

namespace posespace {

Result<std::unique_ptr<Store>> OpenStore(const std::string& where) {
  constexpr std::string_view kSqlite = "sqlite:";
  if (where == "memory") return std::unique_ptr<Store>(std::make_unique<MemoryStore>());
  if (where.starts_with(kSqlite) && where.size() > kSqlite.size()) {
    return SqliteStore::Open(where.substr(kSqlite.size()));
  }
  return Error{ErrorCode::kInvalidOption,
               "the store '" + where + "' is not available; this version has: memory, sqlite:PATH",
               {}};
}

}  // namespace posespace
