// SPDX-License-Identifier: Apache-2.0
#include "session/registry.h"

#include <algorithm>
#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <exception>
#include <map>
#include <mutex>
#include <shared_mutex>
#include <utility>

#include "session/random_id.h"
#include "session/snapshot.h"
#include "store/memory_store.h"

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

Result<void> CheckNotes(const NewSession& request) {
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

// `mutex` is held for look-ups alone: not while the store is used, nor while sessions are freed.
// No lock of a session but its shortest is taken under it.
struct Registry::State {
  State(const Limits& given, std::shared_ptr<Store> given_store)
      : limits(given), store(std::move(given_store)), pool(given) {}

  struct Entry {
    std::string request_id;
    std::shared_ptr<Session> session = nullptr;  // null: in the store alone
    bool busy = false;  // somebody creates or loads it; others wait, nobody erases it
    mutable std::atomic<std::int64_t> last_used{0};
  };
  using Entries = std::map<std::string, Entry>;

  const Limits limits;
  const std::shared_ptr<Store> store;
  mutable std::shared_mutex mutex;
  std::condition_variable_any idle;                // an entry is no longer busy
  Entries sessions;                                // guarded by mutex
  std::map<std::string, std::string> request_ids;  // guarded by mutex; of living sessions: -> id
  std::atomic<std::int64_t> uses{0};               // counts calls: the clock of last_used
  BuildPool pool;                                  // last: its builds end first

  using Lock = std::unique_lock<std::shared_mutex>;

  // The rest requires `mutex`.

  // The session of an entry, marked as used.
  std::shared_ptr<Session> Use(const Entry& entry) {
    entry.last_used = ++uses;
    return entry.session;
  }

  // The entry of an id once nobody is busy with it; the end when there is none.
  Entries::iterator Await(Lock& lock, const std::string& id) {
    for (;;) {
      const auto entry = sessions.find(id);
      if (entry == sessions.end() || !entry->second.busy) return entry;
      idle.wait(lock);
    }
  }

  void Erase(Entries::iterator entry) {
    request_ids.erase(entry->second.request_id);
    sessions.erase(entry);
  }

  // Makes a session for an entry without the lock, while others wait for the entry.
  template <typename Make>
  Result<std::shared_ptr<Session>> Fill(Lock& lock, Entries::iterator entry, Make make) {
    entry->second.busy = true;
    lock.unlock();
    Result<std::shared_ptr<Session>> made = [&]() -> Result<std::shared_ptr<Session>> {
      try {
        return make();
      } catch (const std::exception& exception) {
        return Error{ErrorCode::kInternal,
                     std::string("a session could not be had: ") + exception.what(),
                     {}};
      }
    }();
    lock.lock();
    entry->second.busy = false;
    if (made) entry->second.session = *made;
    idle.notify_all();
    return made;
  }
};

Registry::Registry(std::unique_ptr<State> state) : state_(std::move(state)) {}

Registry::Registry(const Limits& limits)
    : Registry(std::make_unique<State>(limits, std::make_shared<MemoryStore>())) {}

Result<std::unique_ptr<Registry>> Registry::Open(const Limits& limits,
                                                 std::shared_ptr<Store> store) {
  auto state = std::make_unique<State>(limits, std::move(store));
  for (Store::Entry& stored : TRY(state->store->List())) {
    if (!stored.request_id.empty()) state->request_ids[stored.request_id] = stored.id;
    state->sessions[stored.id].request_id = std::move(stored.request_id);
  }
  return std::unique_ptr<Registry>(new Registry(std::move(state)));
}

Registry::~Registry() = default;

Result<std::shared_ptr<Session>> Registry::Create(NewSession request) {
  if (!request.id.empty()) TRY(CheckId("session", request.id));
  TRY(CheckNotes(request));
  Trim();

  State::Lock lock(state_->mutex);
  if (!request.id.empty()) state_->Await(lock, request.id);
  if (!request.request_id.empty()) {
    auto earlier = state_->request_ids.find(request.request_id);
    if (earlier != state_->request_ids.end() &&
        (request.id.empty() || request.id == earlier->second)) {
      const std::string id = earlier->second;
      lock.unlock();
      auto found = Find(id);
      const bool gone = !found && found.error().code == ErrorCode::kSessionNotFound;
      return gone ? Create(std::move(request)) : found;
    }
    if (earlier != state_->request_ids.end()) {
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
  if (request.id.empty()) request.id = RandomId();
  const auto entry = state_->sessions.try_emplace(request.id).first;
  entry->second.request_id = request.request_id;
  if (!request.request_id.empty()) state_->request_ids[request.request_id] = request.id;
  state_->Use(entry->second);
  auto made = state_->Fill(lock, entry, [&] {
    return Session::Create(std::move(request), state_->limits, state_->store);
  });
  if (!made) state_->Erase(entry);
  return made;
}

Result<std::shared_ptr<Session>> Registry::Peek(const std::string& id) const {
  TRY(CheckId("session", id));
  const std::shared_lock lock(state_->mutex);
  const auto entry = state_->sessions.find(id);
  if (entry == state_->sessions.end()) return SessionNotFound(id);
  return state_->Use(entry->second);
}

Result<std::shared_ptr<Session>> Registry::Find(const std::string& id) const {
  if (auto session = TRY(Peek(id))) return session;
  State::Lock lock(state_->mutex);
  const auto entry = state_->Await(lock, id);
  if (entry == state_->sessions.end()) return SessionNotFound(id);
  if (entry->second.session != nullptr) return state_->Use(entry->second);
  auto loaded =
      state_->Fill(lock, entry, [&] { return Session::Load(id, state_->limits, state_->store); });
  lock.unlock();
  Trim();
  return loaded;
}

Result<Registry::Page> Registry::List(int count, const std::string& after) const {
  const std::size_t wanted = static_cast<std::size_t>(std::max(count, 1));
  std::vector<std::pair<std::string, std::shared_ptr<Session>>> found;
  Page page;
  {
    const std::shared_lock lock(state_->mutex);
    auto next = state_->sessions.upper_bound(after);
    for (; next != state_->sessions.end() && found.size() < wanted; ++next) {
      found.emplace_back(next->first, next->second.session);
    }
    if (next != state_->sessions.end()) page.next_token = found.back().first;
  }
  for (const auto& [id, session] : found) {
    if (session != nullptr) {
      page.sessions.push_back(session->View());
      continue;
    }
    const auto bytes = state_->store->ReadRecord(id);
    if (!bytes && bytes.error().code == ErrorCode::kSessionNotFound) continue;  // deleted meanwhile
    if (!bytes && bytes.error().code == ErrorCode::kStoreUnavailable) return bytes.error();
    SessionView& view = page.sessions.emplace_back();
    view.id = id;
    if (!bytes) continue;
    if (const auto record = SessionRecordFromBytes(*bytes)) view = ViewOf(*record);
  }
  return page;
}

Result<void> Registry::Delete(const std::string& id, const std::string& etag) {
  // Closing cancels builds and tells their watchers, which may look up sessions: without the lock.
  const auto session = Find(id);
  if (session) {
    TRY((*session)->Delete(etag));
  } else if (session.error().code == ErrorCode::kSnapshotCorrupt && etag.empty()) {
    TRY(state_->store->Remove(id));
  } else {
    return session.error();
  }
  State::Lock lock(state_->mutex);
  const auto entry = state_->Await(lock, id);
  if (entry != state_->sessions.end()) state_->Erase(entry);
  return {};
}

void Registry::Trim() const {
  std::vector<std::shared_ptr<Session>> dropped;  // freed after the lock
  const State::Lock lock(state_->mutex);
  std::int64_t bytes = 0;
  std::vector<State::Entry*> unused;
  for (auto& [id, entry] : state_->sessions) {
    if (entry.session == nullptr) continue;
    bytes += entry.session->MemoryBytes();
    // Only this map can hand out a session that nobody else holds, and not under the lock.
    if (entry.session.use_count() == 1 && !entry.session->is_building()) unused.push_back(&entry);
  }
  if (bytes <= state_->limits.max_memory_bytes) return;
  std::sort(unused.begin(), unused.end(), [](const State::Entry* a, const State::Entry* b) {
    return a->last_used < b->last_used;
  });
  for (State::Entry* const entry : unused) {
    if (bytes <= state_->limits.max_memory_bytes) break;
    bytes -= entry->session->MemoryBytes();
    dropped.push_back(std::move(entry->session));
  }
}

std::size_t Registry::num_loaded() const {
  const std::shared_lock lock(state_->mutex);
  return static_cast<std::size_t>(
      std::count_if(state_->sessions.begin(), state_->sessions.end(),
                    [](const auto& entry) { return entry.second.session != nullptr; }));
}

BuildPool& Registry::build_pool() { return state_->pool; }

const Limits& Registry::limits() const { return state_->limits; }

}  // namespace posespace
