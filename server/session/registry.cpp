// SPDX-License-Identifier: Apache-2.0
#include "session/registry.h"

#include <algorithm>
#include <mutex>
#include <shared_mutex>
#include <utility>

#include "session/random_id.h"

namespace posespace {
namespace {

// Bounds what a session without drawings costs in memory.
constexpr std::size_t kMaxLabels = 64;
constexpr std::size_t kMaxTextBytes = 256;

Result<void> CheckText(const std::string& field, const std::string& text) {
  if (text.size() <= kMaxTextBytes) return {};
  const std::string message = field + " has " + std::to_string(text.size()) +
                              " bytes, more than the limit of " + std::to_string(kMaxTextBytes);
  return Error{ErrorCode::kInvalidOption, message, {{field, message}}};
}

Result<void> CheckNotes(const Registry::NewSession& request) {
  TRY(CheckText("display_name", request.display_name));
  TRY(CheckText("request_id", request.request_id));
  if (request.labels.size() > kMaxLabels) {
    const std::string message = std::to_string(request.labels.size()) +
                                " labels are more than the limit of " + std::to_string(kMaxLabels);
    return Error{ErrorCode::kInvalidOption, message, {{"labels", message}}};
  }
  for (const auto& [key, value] : request.labels) {
    TRY(CheckText("labels", key));
    TRY(CheckText("labels['" + key + "']", value));
  }
  return {};
}

Error SessionNotFound(const std::string& id) {
  return Error{ErrorCode::kSessionNotFound, "there is no session '" + id + "'", {}};
}

}  // namespace

// `mutex` is held for look-ups alone; no lock of a session is taken under it.
struct Registry::State {
  explicit State(const Limits& given) : limits(given), pool(given) {}

  struct Entry {
    std::shared_ptr<Session> session;
    std::string request_id;
  };

  const Limits limits;
  mutable std::shared_mutex mutex;
  std::map<std::string, Entry> sessions;           // guarded by mutex
  std::map<std::string, std::string> request_ids;  // guarded by mutex; of living sessions: -> id
  BuildPool pool;                                  // last: its builds end first
};

Registry::Registry(const Limits& limits) : state_(std::make_unique<State>(limits)) {}

Registry::~Registry() = default;

Result<std::shared_ptr<Session>> Registry::Create(NewSession request) {
  if (!request.id.empty()) TRY(CheckId("session", request.id));
  TRY(CheckNotes(request));

  const std::lock_guard lock(state_->mutex);
  if (!request.request_id.empty()) {
    const auto earlier = state_->request_ids.find(request.request_id);
    if (earlier != state_->request_ids.end()) {
      if (request.id.empty() || request.id == earlier->second) {
        return state_->sessions.at(earlier->second).session;
      }
      const std::string message =
          "request_id '" + request.request_id + "' came before with another session id";
      return Error{ErrorCode::kInvalidOption, message, {{"request_id", message}}};
    }
  }
  if (state_->sessions.contains(request.id)) {
    return Error{ErrorCode::kSessionExists,
                 "session '" + request.id + "' is there already",
                 {{"session_id", "is taken"}}};
  }
  if (std::ssize(state_->sessions) >= state_->limits.max_sessions) {
    return Error{ErrorCode::kSessionLimit,
                 "there are " + std::to_string(state_->sessions.size()) +
                     " sessions, as many as may be: delete one, or try again later",
                 {}};
  }
  const std::string id = request.id.empty() ? RandomId() : request.id;
  auto session = std::make_shared<Session>(id, std::move(request.display_name),
                                           std::move(request.labels), state_->limits);
  if (!request.request_id.empty()) state_->request_ids.emplace(request.request_id, id);
  state_->sessions.emplace(id, State::Entry{session, std::move(request.request_id)});
  return session;
}

Result<std::shared_ptr<Session>> Registry::Find(const std::string& id) const {
  TRY(CheckId("session", id));
  const std::shared_lock lock(state_->mutex);
  const auto found = state_->sessions.find(id);
  if (found == state_->sessions.end()) return SessionNotFound(id);
  return found->second.session;
}

Registry::Page Registry::List(int count, const std::string& after) const {
  const std::size_t wanted = static_cast<std::size_t>(std::max(count, 1));
  Page page;
  const std::shared_lock lock(state_->mutex);
  auto next = state_->sessions.upper_bound(after);
  for (; next != state_->sessions.end() && page.sessions.size() < wanted; ++next) {
    page.sessions.push_back(next->second.session);
  }
  if (next != state_->sessions.end()) page.next_token = page.sessions.back()->id();
  return page;
}

Result<void> Registry::Delete(const std::string& id, const std::string& etag) {
  // Closing cancels builds and tells their watchers, which may look up sessions: without the lock.
  const auto session = TRY(Find(id));
  TRY(session->CloseIf(etag));
  const std::lock_guard lock(state_->mutex);
  const auto found = state_->sessions.find(id);
  state_->request_ids.erase(found->second.request_id);
  state_->sessions.erase(found);
  return {};
}

BuildPool& Registry::build_pool() { return state_->pool; }

const Limits& Registry::limits() const { return state_->limits; }

}  // namespace posespace
