// SPDX-License-Identifier: Apache-2.0
#include "session/session.h"

#include <algorithm>
#include <utility>

#include "session/flip.h"
#include "session/session_state.h"

namespace posespace {
namespace {

Error ShapeNotFound(const std::string& session_id, const std::string& shape_id) {
  return Error{ErrorCode::kShapeNotFound,
               "session '" + session_id + "' has no shape " + Quoted(shape_id),
               {}};
}

std::int64_t PixelsOf(const Drawing& drawing) {
  return static_cast<std::int64_t>(drawing.texture.image.width) * drawing.texture.image.height;
}

// Moves the marks of a drawing to its mirror image.
void FlipMarks(std::vector<Correspondence>& tuples, const std::string& shape_id,
               double mirror_sum) {
  for (Correspondence& tuple : tuples) {
    if (const auto mark = tuple.find(shape_id); mark != tuple.end()) {
      mark->second.x() = mirror_sum - mark->second.x();
    }
  }
}

// Checks that each tuple marks something, and only drawings that are there.
Result<void> CheckTuples(const std::vector<Correspondence>& tuples,
                         const std::vector<std::string>& ids) {
  std::vector<Violation> empty;
  std::vector<Violation> unknown;
  for (std::size_t k = 0; k < tuples.size(); ++k) {
    const std::string field = "tuples[" + std::to_string(k) + "]";
    if (tuples[k].empty()) empty.push_back({field, field + " marks no drawing"});
    for (const auto& [id, point] : tuples[k]) {
      if (std::find(ids.begin(), ids.end(), id) != ids.end()) continue;
      const std::string mark = field + ".points[" + Quoted(id) + "]";
      unknown.push_back({mark, field + " marks shape " + Quoted(id) + ", which is not there"});
    }
  }
  if (!unknown.empty()) {
    const std::string message = unknown.front().description;
    return Error{ErrorCode::kShapeNotFound, message, std::move(unknown)};
  }
  if (!empty.empty()) {
    const std::string message = empty.front().description;
    return Error{ErrorCode::kInvalidOption, message, std::move(empty)};
  }
  return {};
}

}  // namespace

Session::Session(std::string id, std::string display_name,
                 std::map<std::string, std::string> labels, const Limits& limits)
    : id_(id),
      limits_(limits),
      state_(std::make_shared<State>(std::move(id), std::move(display_name), std::move(labels))) {}

SessionView Session::View() const {
  SessionView view;
  view.id = id_;
  view.display_name = state_->display_name;
  view.labels = state_->labels;
  view.created = state_->created;
  std::shared_ptr<BuildJob> latest;
  {
    const std::lock_guard lock(state_->mutex);
    view.shape_ids = state_->ShapeIds();
    view.correspondences = state_->correspondences;
    view.placements = PlacementsOrDefault(state_->placements, view.shape_ids);
    view.placements_are_default = state_->placements.empty();
    view.etag = state_->Etag();
    view.updated = state_->updated;
    const std::lock_guard read(state_->reading);
    if (state_->built != nullptr) view.revision = state_->built->revision();
    latest = state_->latest;
  }
  if (latest != nullptr) view.build = latest->Status();
  return view;
}

std::string Session::etag() const {
  const std::lock_guard lock(state_->mutex);
  return state_->Etag();
}

Result<std::shared_ptr<const Drawing>> Session::PutShape(const std::string& shape_id,
                                                         ShapeSource source, bool replace,
                                                         bool flip) {
  TRY(CheckId("shape", shape_id));

  // The drawing that answers the call without any work, if it is there; else whether it may come.
  const auto precheck = [&](const std::string& digest,
                            std::ptrdiff_t at) -> Result<std::shared_ptr<const Drawing>> {
    TRY(state_->AcceptEdit(""));
    if (at >= 0 && state_->drawings[at]->digest == digest) return state_->drawings[at];
    if (at >= 0 && !replace) {
      return Error{ErrorCode::kShapeExists,
                   "shape '" + shape_id + "' is there with another drawing; replace overwrites it",
                   {{"shape_id", "is taken by another drawing"}}};
    }
    if (at < 0 && std::ssize(state_->drawings) >= limits_.max_shapes) {
      return Error{ErrorCode::kTooManyShapes,
                   "session '" + id_ + "' has " + std::to_string(limits_.max_shapes) +
                       " drawings, as many as may be",
                   {}};
    }
    return std::shared_ptr<const Drawing>();
  };

  // Requires the lock.
  const auto pixels_of_others = [&] {
    std::int64_t pixels = 0;
    for (const auto& other : state_->drawings) {
      if (other->id != shape_id) pixels += PixelsOf(*other);
    }
    return pixels;
  };

  const std::string straight = SourceDigest(source), flipped = FlippedDigest(straight);
  const std::string& digest = flip ? flipped : straight;
  std::int64_t pixels_left = limits_.max_session_pixels;
  {
    const std::lock_guard lock(state_->mutex);
    if (auto known = TRY(precheck(digest, state_->Find(shape_id)))) return known;
    pixels_left -= pixels_of_others();
  }
  Drawing read = TRY(ReadDrawing(shape_id, source, limits_, pixels_left));
  const double mirror_sum = MirrorSum(source, read);
  if (flip) read = Flipped(std::move(read), mirror_sum);
  const auto drawing = std::make_shared<const Drawing>(std::move(read));

  const std::lock_guard edit(state_->editing);
  const std::lock_guard lock(state_->mutex);
  const std::ptrdiff_t at = state_->Find(shape_id);
  if (auto known = TRY(precheck(digest, at))) return known;
  // Others may have come while this one was read; polygons are painted whatever is left.
  const std::int64_t pixels = PixelsOf(*drawing) + pixels_of_others();
  if (pixels > limits_.max_session_pixels) {
    const std::string message = "shape '" + shape_id + "': with it the session's pictures have " +
                                std::to_string(pixels) + " pixels, more than the limit of " +
                                std::to_string(limits_.max_session_pixels);
    return Error{ErrorCode::kImageTooLarge, message, {{"shape_id", message}}};
  }
  if (at >= 0) {
    if (state_->drawings[at]->digest == (flip ? straight : flipped)) {
      FlipMarks(state_->correspondences, shape_id, mirror_sum);
    }
    state_->drawings[at] = drawing;
  } else {
    state_->drawings.push_back(drawing);
  }
  state_->Touch();
  return drawing;
}

Result<std::shared_ptr<const Drawing>> Session::FindShape(const std::string& shape_id) const {
  const std::lock_guard lock(state_->mutex);
  const std::ptrdiff_t at = state_->Find(shape_id);
  if (at < 0) return ShapeNotFound(id_, shape_id);
  return state_->drawings[at];
}

std::vector<std::shared_ptr<const Drawing>> Session::Shapes() const {
  const std::lock_guard lock(state_->mutex);
  return state_->drawings;
}

Result<void> Session::DeleteShape(const std::string& shape_id) {
  const std::lock_guard edit(state_->editing);
  const std::lock_guard lock(state_->mutex);
  TRY(state_->AcceptEdit(""));
  const std::ptrdiff_t at = state_->Find(shape_id);
  if (at < 0) return ShapeNotFound(id_, shape_id);
  state_->drawings.erase(state_->drawings.begin() + at);
  state_->placements.erase(shape_id);
  for (Correspondence& tuple : state_->correspondences) tuple.erase(shape_id);
  std::erase_if(state_->correspondences, [](const Correspondence& tuple) { return tuple.empty(); });
  state_->Touch();
  return {};
}

Result<void> Session::SetCorrespondences(std::vector<Correspondence> tuples,
                                         const std::string& etag) {
  if (std::ssize(tuples) > limits_.max_landmarks) {
    return Error{ErrorCode::kTooManyLandmarks,
                 std::to_string(tuples.size()) + " correspondences are more than the limit of " +
                     std::to_string(limits_.max_landmarks),
                 {{"tuples", "too many"}}};
  }
  const std::lock_guard edit(state_->editing);
  std::vector<std::shared_ptr<const Drawing>> drawings;
  {
    const std::lock_guard lock(state_->mutex);
    TRY(state_->AcceptEdit(etag));
    TRY(CheckTuples(tuples, state_->ShapeIds()));
    drawings = state_->drawings;
  }
  if (!tuples.empty()) {
    TRY(CheckLandmarks(MatchingShapesOf(drawings), LandmarksOf(tuples, drawings)));
  }

  const std::lock_guard lock(state_->mutex);
  TRY(state_->AcceptEdit(etag));
  state_->correspondences = std::move(tuples);
  state_->Touch();
  return {};
}

Result<void> Session::SetPlacements(Placements placements, const std::string& etag) {
  const std::lock_guard edit(state_->editing);
  auto pose_space = state_->BuiltOrNull();
  std::optional<Points> places;
  {
    const std::lock_guard lock(state_->mutex);
    TRY(state_->AcceptEdit(etag));
    const std::vector<std::string> ids = state_->ShapeIds();
    if (!placements.empty()) {
      TRY(CheckPlaced(ids, placements));
      Points all(std::ssize(ids), 2);
      for (std::size_t i = 0; i < ids.size(); ++i) all.row(i) = placements.at(ids[i]);
      TRY(CheckPlacements(ids, all));
    }
    if (pose_space != nullptr) places = PlacesOf(*pose_space, PlacementsOrDefault(placements, ids));
  }
  if (places && *places != pose_space->placements()) {
    pose_space = TRY(pose_space->WithPlacements(*places));
  }

  const std::lock_guard lock(state_->mutex);
  TRY(state_->AcceptEdit(etag));
  state_->placements = std::move(placements);
  ++state_->placements_version;
  state_->Touch();
  const std::lock_guard read(state_->reading);
  state_->built = std::move(pose_space);
  return {};
}

}  // namespace posespace
