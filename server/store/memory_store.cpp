// SPDX-License-Identifier: Apache-2.0
#include "store/memory_store.h"

#include <map>
#include <mutex>
#include <set>
#include <utility>

#include "store/store_errors.h"

namespace posespace {

struct MemoryStore::State {
  struct Session {
    std::string request_id;
    Bytes record;
    std::set<std::string> uses;
  };
  struct Counted {
    Bytes bytes;
    int users = 0;
  };

  mutable std::mutex mutex;
  std::map<std::string, Session> sessions;  // guarded by mutex
  std::map<std::string, Counted> blobs;     // guarded by mutex

  void Use(const std::set<std::string>& keys) {
    for (const std::string& key : keys) ++blobs[key].users;
  }

  void Forsake(const std::set<std::string>& keys) {
    for (const std::string& key : keys) {
      const auto blob = blobs.find(key);
      if (--blob->second.users == 0) blobs.erase(blob);
    }
  }
};

MemoryStore::MemoryStore() : state_(std::make_unique<State>()) {}

MemoryStore::~MemoryStore() = default;

Result<std::vector<Store::Entry>> MemoryStore::List() const {
  const std::lock_guard lock(state_->mutex);
  std::vector<Entry> entries;
  for (const auto& [id, session] : state_->sessions) entries.push_back({id, session.request_id});
  return entries;
}

Result<void> MemoryStore::Insert(const Entry& entry, std::span<const std::uint8_t> record) {
  const std::lock_guard lock(state_->mutex);
  const bool added =
      state_->sessions
          .try_emplace(entry.id,
                       State::Session{entry.request_id, Bytes(record.begin(), record.end()), {}})
          .second;
  if (!added) return StoredAlready(entry.id);
  return {};
}

Result<void> MemoryStore::Update(const std::string& id, std::span<const std::uint8_t> record,
                                 std::span<const std::string> uses, std::span<const Blob> blobs) {
  const std::lock_guard lock(state_->mutex);
  const auto session = state_->sessions.find(id);
  if (session == state_->sessions.end()) return NotStored(id);
  std::set<std::string> kept(uses.begin(), uses.end());
  state_->Use(kept);
  for (const Blob& blob : blobs) {
    if (kept.contains(blob.key)) state_->blobs[blob.key].bytes = blob.bytes;
  }
  state_->Forsake(session->second.uses);
  session->second.uses = std::move(kept);
  session->second.record.assign(record.begin(), record.end());
  return {};
}

Result<void> MemoryStore::Remove(const std::string& id) {
  const std::lock_guard lock(state_->mutex);
  const auto session = state_->sessions.find(id);
  if (session == state_->sessions.end()) return NotStored(id);
  state_->Forsake(session->second.uses);
  state_->sessions.erase(session);
  return {};
}

Result<Bytes> MemoryStore::ReadRecord(const std::string& id) const {
  const std::lock_guard lock(state_->mutex);
  const auto session = state_->sessions.find(id);
  if (session == state_->sessions.end()) return NotStored(id);
  return session->second.record;
}

Result<Bytes> MemoryStore::ReadBlob(const std::string& key) const {
  const std::lock_guard lock(state_->mutex);
  const auto blob = state_->blobs.find(key);
  if (blob == state_->blobs.end()) return BlobMissing(key);
  return blob->second.bytes;
}

}  // namespace posespace
