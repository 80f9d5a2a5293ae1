// SPDX-License-Identifier: Apache-2.0
#include "session/session_state.h"

#include <algorithm>
#include <utility>

#include "session/random_id.h"

namespace posespace {

Session::State::State(std::string session_id, std::string name,
                      std::map<std::string, std::string> notes)
    : id(std::move(session_id)),
      display_name(std::move(name)),
      labels(std::move(notes)),
      nonce(RandomId()),
      created(std::chrono::system_clock::now()) {
  content.updated = created;
}

std::shared_ptr<BuildJob> Session::State::Latest() const {
  const std::lock_guard lock(reading);
  return latest;
}

std::shared_ptr<const PoseSpace> Session::State::BuiltOrNull() const {
  const std::lock_guard lock(reading);
  return built;
}

Session::State::Content Session::State::Current() const {
  const std::lock_guard lock(mutex);
  return content;
}

Result<Session::State::Content> Session::State::ContentToEdit(const std::string& etag) const {
  const std::lock_guard lock(mutex);
  TRY(AcceptEdit(etag));
  return content;
}

Session::State::Product Session::State::CurrentProduct() const { return {BuiltOrNull(), build_id}; }

Result<void> Session::State::Publish(const BuildStatus& status, std::int64_t placed) {
  if (status.pose_space == nullptr) return {};
  const std::lock_guard edit(editing);
  if (const auto job = Latest(); job == nullptr || job->Status().id != status.id) return {};
  if (closed) return {};

  // Placements set while the job ran count for what it built.
  std::shared_ptr<const PoseSpace> pose_space = status.pose_space;
  Content next = Current();
  if (next.placements_version != placed) {
    const auto places =
        PlacesOf(*pose_space, PlacementsOrDefault(next.placements, next.ShapeIds()));
    if (places) {
      if (auto moved = pose_space->WithPlacements(*places)) pose_space = std::move(*moved);
    }
  }
  return Commit(std::move(next), {std::move(pose_space), status.id});
}

Result<void> Session::State::Commit(Content next, Product product) {
  ++next.version;
  next.updated = std::chrono::system_clock::now();
  TRY(Keep(next, product, builds));
  Weigh(next, product);
  build_id = std::move(product.build_id);
  const std::lock_guard lock(mutex);
  content = std::move(next);
  const std::lock_guard read(reading);
  built = std::move(product.pose_space);
  if (built != nullptr) lost.reset();
  return {};
}

void Session::State::Weigh(const Content& next, const Product& product) {
  std::set<const Drawing*> drawings;
  for (const auto& drawing : next.drawings) drawings.insert(drawing.get());
  if (product.pose_space != nullptr) {
    for (const auto& drawing : product.pose_space->drawings()) drawings.insert(drawing.get());
  }
  constexpr std::int64_t kSmallThings = 4'096;
  std::int64_t bytes = kSmallThings;
  for (const Drawing* const drawing : drawings) bytes += MemoryBytesOf(*drawing);
  drawing_bytes = bytes;
}

std::string EtagOf(const std::string& nonce, std::int64_t version) {
  return nonce + "-" + std::to_string(version);
}

std::string Session::State::Etag() const { return EtagOf(nonce, content.version); }

Result<void> Session::State::AcceptEdit(const std::string& etag) const {
  if (closed) {
    return Error{ErrorCode::kSessionNotFound, "session '" + id + "' has been deleted", {}};
  }
  if (!etag.empty() && etag != Etag()) {
    return Error{ErrorCode::kEtagMismatch,
                 "session '" + id + "' has changed since it was read: its etag is " + Etag() +
                     ", not " + etag,
                 {{"etag", "is not the session's etag"}}};
  }
  return {};
}

std::vector<std::string> Session::State::Content::ShapeIds() const {
  std::vector<std::string> ids;
  for (const auto& drawing : drawings) ids.push_back(drawing->id);
  return ids;
}

std::ptrdiff_t Session::State::Content::Find(const std::string& shape_id) const {
  const auto found = std::find_if(drawings.begin(), drawings.end(),
                                  [&](const auto& drawing) { return drawing->id == shape_id; });
  return found == drawings.end() ? -1 : found - drawings.begin();
}

Placements PlacementsOrDefault(const Placements& placements, std::span<const std::string> ids) {
  if (!placements.empty()) return placements;
  const Points places = DefaultPlacements(static_cast<int>(ids.size()));
  Placements result;
  for (std::size_t i = 0; i < ids.size(); ++i) result[ids[i]] = places.row(i);
  return result;
}

std::optional<Points> PlacesOf(const PoseSpace& pose_space, const Placements& placements) {
  const auto& drawings = pose_space.drawings();
  Points places(static_cast<Eigen::Index>(drawings.size()), 2);
  for (std::size_t i = 0; i < drawings.size(); ++i) {
    const auto found = placements.find(drawings[i]->id);
    if (found == placements.end()) return std::nullopt;
    places.row(i) = found->second;
  }
  return places;
}

std::vector<Landmark> LandmarksOf(const std::vector<Correspondence>& tuples,
                                  std::span<const std::shared_ptr<const Drawing>> drawings) {
  std::vector<Landmark> landmarks;
  for (const Correspondence& tuple : tuples) {
    Landmark& landmark = landmarks.emplace_back();
    for (const auto& drawing : drawings) {
      const auto mark = tuple.find(drawing->id);
      landmark.points.push_back(mark == tuple.end() ? std::nullopt : std::optional(mark->second));
    }
  }
  return landmarks;
}

}  // namespace posespace
