// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_REGISTRY_H_
#define POSESPACE_SESSION_REGISTRY_H_

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "geometry/result.h"
#include "session/session.h"

namespace posespace {

// All sessions, by id; in memory.  Thread-safe; Find is a short shared lock that no build, upload
// or blend holds.  A deleted session lives on, closed, for as long as somebody holds it.
class Registry {
 public:
  explicit Registry(const Limits& limits);
  ~Registry();

  struct NewSession {
    std::string id = {};            // empty: an unguessable one is chosen (128 random bits)
    std::string display_name = {};  // up to 256 bytes
    std::map<std::string, std::string> labels = {};  // up to 64, keys and values up to 256 bytes
    std::string request_id = {};                     // up to 256 bytes
  };
  // The same request_id again returns the session of the first call.
  // Fails  kInvalidId, kSessionExists, kSessionLimit, kInvalidOption (texts beyond their bounds; a
  //        request_id that came with another id).
  Result<std::shared_ptr<Session>> Create(NewSession request);

  // Fails  kInvalidId (empty), kSessionNotFound.
  Result<std::shared_ptr<Session>> Find(const std::string& id) const;

  // Up to `count` (at least one) sessions with ids greater than `after`, by id; next_token, for
  // `after` of the next page, is empty on the last.
  struct Page {
    std::vector<std::shared_ptr<Session>> sessions;
    std::string next_token;
  };
  Page List(int count, const std::string& after) const;

  // Closes and forgets a session; of calls at the same time one succeeds.
  // Fails  kSessionNotFound, kEtagMismatch (a non-empty etag that is not the session's).
  Result<void> Delete(const std::string& id, const std::string& etag);

  BuildPool& build_pool();
  const Limits& limits() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace posespace

#endif  // POSESPACE_SESSION_REGISTRY_H_
