// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_SUPPORT_FLAKY_STORE_H_
#define POSESPACE_TESTS_SUPPORT_FLAKY_STORE_H_

#include <atomic>
#include <functional>
#include <map>
#include <mutex>
#include <string>

#include "store/memory_store.h"

namespace posespace {

// A store whose medium fails when told, and whose bytes can be damaged.
class FlakyStore final : public Store {
 public:
  std::atomic<bool> fails_writing{false};
  std::atomic<bool> fails_reading{false};
  mutable std::atomic<int> records_read{0};
  mutable std::atomic<int> blobs_read{0};
  std::atomic<int> writes{0};

  // Changes what is read under keys that begin with `prefix`; records have the key "session/ID".
  void Damage(const std::string& prefix, std::function<void(Bytes&)> change) {
    const std::lock_guard lock(mutex_);
    damage_[prefix] = std::move(change);
  }
  void Heal() {
    const std::lock_guard lock(mutex_);
    damage_.clear();
  }

  Result<std::vector<Entry>> List() const override {
    if (fails_reading) return Failure();
    return store_.List();
  }
  Result<void> Insert(const Entry& entry, std::span<const std::uint8_t> record) override {
    if (fails_writing) return Failure();
    ++writes;
    return store_.Insert(entry, record);
  }
  Result<void> Update(const std::string& id, std::span<const std::uint8_t> record,
                      std::span<const std::string> uses, std::span<const Blob> blobs) override {
    if (fails_writing) return Failure();
    ++writes;
    {
      const std::lock_guard lock(mutex_);
      for (const Blob& blob : blobs) {
        std::erase_if(damage_, [&](const auto& each) { return blob.key.starts_with(each.first); });
      }
    }
    return store_.Update(id, record, uses, blobs);
  }
  Result<void> Remove(const std::string& id) override {
    if (fails_writing) return Failure();
    ++writes;
    return store_.Remove(id);
  }
  Result<Bytes> ReadRecord(const std::string& id) const override {
    if (fails_reading) return Failure();
    ++records_read;
    return Damaged("session/" + id, store_.ReadRecord(id));
  }
  Result<Bytes> ReadBlob(const std::string& key) const override {
    if (fails_reading) return Failure();
    ++blobs_read;
    return Damaged(key, store_.ReadBlob(key));
  }

 private:
  static Error Failure() { return Error{ErrorCode::kStoreUnavailable, "the disk is full", {}}; }

  Result<Bytes> Damaged(const std::string& key, Result<Bytes> bytes) const {
    const std::lock_guard lock(mutex_);
    for (const auto& [prefix, change] : damage_) {
      if (bytes && key.starts_with(prefix)) change(*bytes);
    }
    return bytes;
  }

  MemoryStore store_;
  mutable std::mutex mutex_;
  std::map<std::string, std::function<void(Bytes&)>> damage_;  // guarded by mutex_
};

}  // namespace posespace

#endif  // POSESPACE_TESTS_SUPPORT_FLAKY_STORE_H_
