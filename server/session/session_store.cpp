// SPDX-License-Identifier: Apache-2.0
// How a session goes into its store and comes back.
#include <utility>

#include "session/random_id.h"
#include "session/session_state.h"

namespace posespace {
namespace {

std::vector<DrawingName> NamesOf(std::span<const std::shared_ptr<const Drawing>> drawings) {
  std::vector<DrawingName> names;
  for (const auto& drawing : drawings) names.push_back({drawing->id, drawing->digest});
  return names;
}

// Drawings of one session by what it calls them; equal names share one.
using Shelf = std::map<std::pair<std::string, std::string>, std::shared_ptr<const Drawing>>;

Result<void> Fetch(const Store& store, std::span<const DrawingName> names, Shelf* shelf) {
  for (const DrawingName& name : names) {
    std::shared_ptr<const Drawing>& place = (*shelf)[{name.id, name.digest}];
    if (place != nullptr) continue;
    const Bytes bytes = TRY(store.ReadBlob(DrawingKey(name.digest)));
    place = std::make_shared<const Drawing>(TRY(DrawingFromBytes(name, bytes)));
  }
  return {};
}

Result<std::shared_ptr<const PoseSpace>> FetchPoseSpace(const Store& store,
                                                        const SessionRecord& record, Shelf* shelf) {
  TRY(Fetch(store, record.built_from, shelf));
  const Bytes bytes = TRY(store.ReadBlob(PoseSpaceKey(record.built->revision)));
  return PoseSpaceFromBytes(bytes, [shelf](const DrawingName& name) {
    const auto found = shelf->find({name.id, name.digest});
    return found == shelf->end() ? nullptr : found->second;
  });
}

Error Named(const std::string& id, const std::string& what, Error error) {
  error.message = "session '" + id + "': " + what + ": " + error.message;
  return error;
}

}  // namespace

Session::State::State(const SessionRecord& record, std::shared_ptr<Store> kept_in)
    : id(record.id),
      display_name(record.display_name),
      labels(record.labels),
      nonce(record.nonce),
      created(record.created),
      store(std::move(kept_in)),
      builds(record.builds) {
  content.correspondences = record.correspondences;
  content.placements = record.placements;
  content.version = record.version;
  content.updated = record.updated;
}

Session::Session(std::shared_ptr<State> state, const Limits& limits)
    : id_(state->id), limits_(limits), state_(std::move(state)) {}

Result<std::shared_ptr<Session>> Session::Create(NewSession request, const Limits& limits,
                                                 std::shared_ptr<Store> store) {
  SessionRecord record;
  record.id = std::move(request.id);
  record.display_name = std::move(request.display_name);
  record.labels = std::move(request.labels);
  record.nonce = RandomId();
  record.created = record.updated = std::chrono::system_clock::now();
  TRY(store->Insert({record.id, std::move(request.request_id)}, ToBytes(record)));
  auto state = std::make_shared<State>(record, std::move(store));
  return std::shared_ptr<Session>(new Session(std::move(state), limits));
}

Result<std::shared_ptr<Session>> Session::Load(const std::string& id, const Limits& limits,
                                               std::shared_ptr<Store> store) {
  const Bytes bytes = TRY(store->ReadRecord(id));
  auto decoded = SessionRecordFromBytes(bytes);
  if (!decoded) return Named(id, "its record is damaged", std::move(decoded).error());
  const SessionRecord& record = *decoded;

  Shelf shelf;
  auto state = std::make_shared<State>(record, store);
  if (auto fetched = Fetch(*store, record.drawings, &shelf); !fetched) {
    return Named(id, "a drawing cannot be read", std::move(fetched).error());
  }
  for (const DrawingName& name : record.drawings) {
    state->content.drawings.push_back(shelf.at({name.id, name.digest}));
    state->stored.insert(DrawingKey(name.digest));
  }
  if (record.built) TRY(state->TakeBuilt(record, FetchPoseSpace(*store, record, &shelf)));
  state->Weigh(state->content, state->CurrentProduct());
  return std::shared_ptr<Session>(new Session(std::move(state), limits));
}

Result<void> Session::State::TakeBuilt(const SessionRecord& record,
                                       Result<std::shared_ptr<const PoseSpace>> fetched) {
  if (!fetched && fetched.error().code != ErrorCode::kSnapshotCorrupt) return fetched.error();
  if (!fetched) {
    lost = Named(id, "what was built is damaged; build again", std::move(fetched).error());
    return {};
  }
  for (const DrawingName& name : record.built_from) stored.insert(DrawingKey(name.digest));
  stored.insert(PoseSpaceKey(record.built->revision));
  build_id = record.build_id;
  latest = std::make_shared<BuildJob>(build_id, *fetched, build_changes);
  built = std::move(fetched).value();
  return {};
}

SessionRecord Session::State::RecordOf(const Content& next, const Product& product,
                                       std::int64_t started_builds) const {
  SessionRecord record;
  record.id = id;
  record.display_name = display_name;
  record.labels = labels;
  record.nonce = nonce;
  record.version = next.version;
  record.created = created;
  record.updated = next.updated;
  record.drawings = NamesOf(next.drawings);
  record.correspondences = next.correspondences;
  record.placements = next.placements;
  record.builds = started_builds;
  if (product.pose_space != nullptr) {
    record.build_id = product.build_id;
    record.built = product.pose_space->Summary();
    record.built_from = NamesOf(product.pose_space->drawings());
  }
  return record;
}

Result<void> Session::State::Keep(const Content& next, const Product& product,
                                  std::int64_t started_builds) {
  if (store == nullptr) return {};
  std::vector<Blob> missing;
  std::set<std::string> uses;
  const auto use = [&](const std::string& key, const auto& value) {
    if (uses.insert(key).second && !stored.contains(key)) missing.push_back({key, ToBytes(value)});
  };
  for (const auto& drawing : next.drawings) use(DrawingKey(drawing->digest), *drawing);
  if (product.pose_space != nullptr) {
    for (const auto& drawing : product.pose_space->drawings()) {
      use(DrawingKey(drawing->digest), *drawing);
    }
    use(PoseSpaceKey(product.pose_space->revision()), *product.pose_space);
  }
  const Bytes record = ToBytes(RecordOf(next, product, started_builds));
  const std::vector<std::string> keys(uses.begin(), uses.end());
  TRY(store->Update(id, record, keys, missing));
  stored = std::move(uses);
  return {};
}

SessionView ViewOf(const SessionRecord& record) {
  SessionView view;
  view.id = record.id;
  view.display_name = record.display_name;
  view.labels = record.labels;
  for (const DrawingName& name : record.drawings) view.shape_ids.push_back(name.id);
  view.correspondences = record.correspondences;
  view.placements = PlacementsOrDefault(record.placements, view.shape_ids);
  view.placements_are_default = record.placements.empty();
  view.etag = EtagOf(record.nonce, record.version);
  view.created = record.created;
  view.updated = record.updated;
  if (record.built) {
    view.revision = record.built->revision;
    BuildStatus status;
    status.id = record.build_id;
    status.state = BuildState::kSucceeded;
    status.fraction = 1.0;
    status.sequence = 1;
    status.summary = std::make_shared<const BuildSummary>(*record.built);
    view.build = std::move(status);
  }
  return view;
}

}  // namespace posespace
