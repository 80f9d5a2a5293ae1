// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_STORE_SQLITE_STORE_H_
#define POSESPACE_STORE_SQLITE_STORE_H_

#include <memory>
#include <string>

#include "store/store.h"

namespace posespace {

// A store in one SQLite file (and its -wal beside it), written ahead and synchronised before a call
// returns, so that what was answered survives SIGKILL and power failure.
//
// One process holds the file at a time: a second one is refused rather than shown stale sessions.
class SqliteStore final : public Store {
 public:
  // Opens or creates the file, and creates its folder, readable by its owner alone, when missing.
  // Fails  kStoreUnavailable, naming the path: held by another process (after a second's patience),
  //        read-only, not a store of ours, or written by a newer version.
  static Result<std::unique_ptr<Store>> Open(const std::string& path);

  ~SqliteStore() override;

  Result<std::vector<Entry>> List() const override;
  Result<void> Insert(const Entry& entry, std::span<const std::uint8_t> record) override;
  Result<void> Update(const std::string& id, std::span<const std::uint8_t> record,
                      std::span<const std::string> uses, std::span<const Blob> blobs) override;
  Result<void> Remove(const std::string& id) override;
  Result<Bytes> ReadRecord(const std::string& id) const override;
  Result<Bytes> ReadBlob(const std::string& key) const override;

 private:
  struct Database;
  explicit SqliteStore(std::unique_ptr<Database> database);

  std::unique_ptr<Database> database_;
};

}  // namespace posespace

#endif  // POSESPACE_STORE_SQLITE_STORE_H_
