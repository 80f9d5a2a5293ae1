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
      created(std::chrono::system_clock::now()),
      updated(created) {}

std::shared_ptr<BuildJob> Session::State::Latest() const {
  const std::lock_guard lock(reading);
  return latest;
}

std::shared_ptr<const PoseSpace> Session::State::BuiltOrNull() const {
  const std::lock_guard lock(reading);
  return built;
}

void Session::State::Publish(const BuildStatus& status, std::int64_t placed) {
  if (status.pose_space == nullptr) return;
  const std::lock_guard edit(editing);
  if (const auto job = Latest(); job == nullptr || job->Status().id != status.id) return;

  // Placements set while the job ran count for what it built.
  std::shared_ptr<const PoseSpace> pose_space = status.pose_space;
  std::optional<Points> places;
  {
    const std::lock_guard lock(mutex);
    if (placements_version != placed) {
      places = PlacesOf(*pose_space, PlacementsOrDefault(placements, ShapeIds()));
    }
  }
  if (places) {
    if (auto moved = pose_space->WithPlacements(*places)) pose_space = std::move(*moved);
  }

  const std::lock_guard lock(mutex);
  if (closed) return;
  Touch();
  const std::lock_guard read(reading);
  built = std::move(pose_space);
}

std::string Session::State::Etag() const { return nonce + "-" + std::to_string(version); }

void Session::State::Touch() {
  ++version;
  updated = std::chrono::system_clock::now();
}

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

std::vector<std::string> Session::State::ShapeIds() const {
  std::vector<std::string> ids;
  for (const auto& drawing : drawings) ids.push_back(drawing->id);
  return ids;
}

std::ptrdiff_t Session::State::Find(const std::string& shape_id) const {
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
