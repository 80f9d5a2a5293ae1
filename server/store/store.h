// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_STORE_STORE_H_
#define POSESPACE_STORE_STORE_H_

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "geometry/result.h"

namespace posespace {

using Bytes = std::vector<std::uint8_t>;

// Large bytes and the key they are kept under.  A key names its content for good, so writing it
// again changes nothing but damage.
struct Blob {
  std::string key;
  Bytes bytes;
};

// What outlives the service: for each session a small record, and large blobs that records use.
// It knows bytes and keys; what they mean is said in session/snapshot.h.
//
// Every writing call is one transaction: when it returns without an error all of it survives, in
// `sqlite` a crash of the process or the machine; with an error, nothing of it has happened.  A
// blob is kept for as long as a session uses it.
//
// Thread-safe; calls may wait for a disk, so never on a thread that serves streams.
// All fail with kStoreUnavailable when the medium fails or is full, with kSnapshotCorrupt when what
// it holds is damaged.
class Store {
 public:
  virtual ~Store() = default;

  // Who is there, ordered by id: one short read, however much the sessions hold.
  struct Entry {
    std::string id;
    std::string request_id;  // empty: made without one
  };
  virtual Result<std::vector<Entry>> List() const = 0;

  // Adds a session, which uses no blob yet.  Fails  kSessionExists.
  virtual Result<void> Insert(const Entry& entry, std::span<const std::uint8_t> record) = 0;

  // Replaces a session's record and all of its uses.  Every key of `uses` is kept already or in
  // `blobs`, whose bytes replace what their keys held.  Fails  kSessionNotFound.
  virtual Result<void> Update(const std::string& id, std::span<const std::uint8_t> record,
                              std::span<const std::string> uses, std::span<const Blob> blobs) = 0;

  // Removes a session and the blobs that only it used.  Fails  kSessionNotFound.
  virtual Result<void> Remove(const std::string& id) = 0;

  // Fails  kSessionNotFound.
  virtual Result<Bytes> ReadRecord(const std::string& id) const = 0;

  // Fails  kSnapshotCorrupt when the blob is missing, too: somebody was promised that it is there.
  virtual Result<Bytes> ReadBlob(const std::string& key) const = 0;
};

}  // namespace posespace

#endif  // POSESPACE_STORE_STORE_H_
