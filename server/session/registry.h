// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_REGISTRY_H_
#define POSESPACE_SESSION_REGISTRY_H_

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "geometry/result.h"
#include "session/session.h"
#include "store/store.h"

namespace posespace {

// All sessions, by id: those in use in memory, all of them in a store.  Thread-safe.
//
// At the start it knows ids alone; a session is loaded when it is first asked for, and leaves
// memory again, the least recently used first, when more than limits.max_memory_bytes are taken and
// nobody holds it.  Find, Create, List and Delete may wait for the store: Peek is for threads that
// must not.  A deleted session lives on, closed, for as long as somebody holds it.
class Registry {
 public:
  // Sessions that end with the registry.
  explicit Registry(const Limits& limits);

  // The sessions of a store.  Fails as Store::List.
  static Result<std::unique_ptr<Registry>> Open(const Limits& limits, std::shared_ptr<Store> store);

  ~Registry();

  // The same request_id again returns the session of the first call.
  // Fails  kInvalidId, kSessionExists, kSessionLimit, kInvalidOption (texts beyond their bounds; a
  //        request_id that came with another id), kStoreUnavailable.
  Result<std::shared_ptr<Session>> Create(NewSession request);

  // Loads the session unless it is in memory; callers that want the same one wait for one load.
  // Fails  kInvalidId (empty), kSessionNotFound, and as Session::Load.
  Result<std::shared_ptr<Session>> Find(const std::string& id) const;

  // The same without waiting: null for a session that Find would have to load, or wait for.
  Result<std::shared_ptr<Session>> Peek(const std::string& id) const;

  // Up to `count` (at least one) sessions with ids greater than `after`, by id, without loading
  // them; next_token, for `after` of the next page, is empty on the last.  A session whose record
  // is damaged shows its id alone.  Fails with kStoreUnavailable.
  struct Page {
    std::vector<SessionView> sessions;
    std::string next_token;
  };
  Result<Page> List(int count, const std::string& after) const;

  // Closes and forgets a session; of calls at the same time one succeeds.  A damaged one can only
  // be deleted by an empty etag.
  // Fails  kSessionNotFound, kEtagMismatch (a non-empty etag that is not the session's),
  //        kStoreUnavailable.
  Result<void> Delete(const std::string& id, const std::string& etag);

  // Lets go of sessions that nobody uses while too much memory is taken.  After calls that took
  // more; Find and Create do so themselves.
  void Trim() const;

  // How many sessions are in memory.
  std::size_t num_loaded() const;

  BuildPool& build_pool();
  const Limits& limits() const;

 private:
  struct State;
  explicit Registry(std::unique_ptr<State> state);

  std::unique_ptr<State> state_;
};

}  // namespace posespace

#endif  // POSESPACE_SESSION_REGISTRY_H_
