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

std::int64_t PixelsOfOthers(const std::vector<std::shared_ptr<const Drawing>>& drawings,
                            const std::string& shape_id) {
  std::int64_t pixels = 0;
  for (const auto& other : drawings) {
    if (other->id != shape_id) pixels += PixelsOf(*other);
  }
  return pixels;
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
    const State::Content& content = state_->content;
    view.shape_ids = content.ShapeIds();
    view.correspondences = content.correspondences;
    view.placements = PlacementsOrDefault(content.placements, view.shape_ids);
    view.placements_are_default = content.placements.empty();
    view.etag = state_->Etag();
    view.updated = content.updated;
    const std::lock_guard read(state_->reading);
    if (state_->built != nullptr) view.revision = state_->built->revision();
    latest = state_->latest;
  }
  if (latest != nullptr) view.build = latest->Status();
  return view;
}

std::int64_t Session::MemoryBytes() const {
  std::int64_t bytes = state_->drawing_bytes;
  if (const auto built = state_->BuiltOrNull()) bytes += built->MemoryBytes();
  return bytes;
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
  // Requires `mutex`.
  const auto precheck = [&](const std::string& digest) -> Result<std::shared_ptr<const Drawing>> {
    TRY(state_->AcceptEdit(""));
    const State::Content& content = state_->content;
    const std::ptrdiff_t at = content.Find(shape_id);
    if (at >= 0 && content.drawings[at]->digest == digest) return content.drawings[at];
    if (at >= 0 && !replace) {
      return Error{ErrorCode::kShapeExists,
                   "shape '" + shape_id + "' is there with another drawing; replace overwrites it",
                   {{"shape_id", "is taken by another drawing"}}};
    }
    if (at < 0 && std::ssize(content.drawings) >= limits_.max_shapes) {
      return Error{ErrorCode::kTooManyShapes,
                   "session '" + id_ + "' has " + std::to_string(limits_.max_shapes) +
                       " drawings, as many as may be",
                   {}};
    }
    return std::shared_ptr<const Drawing>();
  };

  const std::string straight = SourceDigest(source), flipped = FlippedDigest(straight);
  const std::string& digest = flip ? flipped : straight;
  std::int64_t pixels_left = limits_.max_session_pixels;
  {
    const std::lock_guard lock(state_->mutex);
    if (auto known = TRY(precheck(digest))) return known;
    pixels_left -= PixelsOfOthers(state_->content.drawings, shape_id);
  }
  Drawing read = TRY(ReadDrawing(shape_id, source, limits_, pixels_left));
  const double mirror_sum = MirrorSum(source, read);
  if (flip) read = Flipped(std::move(read), mirror_sum);
  const auto drawing = std::make_shared<const Drawing>(Packed(std::move(read)));

  const std::lock_guard edit(state_->editing);
  {
    const std::lock_guard lock(state_->mutex);
    if (auto known = TRY(precheck(digest))) return known;
  }
  State::Content next = state_->Current();
  // Others may have come while this one was read; polygons are painted whatever is left.
  const std::int64_t pixels = PixelsOf(*drawing) + PixelsOfOthers(next.drawings, shape_id);
  if (pixels > limits_.max_session_pixels) {
    const std::string message = "shape '" + shape_id + "': with it the session's pictures have " +
                                std::to_string(pixels) + " pixels, more than the limit of " +
                                std::to_string(limits_.max_session_pixels);
    return Error{ErrorCode::kImageTooLarge, message, {{"shape_id", message}}};
  }
  if (const std::ptrdiff_t at = next.Find(shape_id); at >= 0) {
    if (next.drawings[at]->digest == (flip ? straight : flipped)) {
      FlipMarks(next.correspondences, shape_id, mirror_sum);
    }
    next.drawings[at] = drawing;
  } else {
    next.drawings.push_back(drawing);
  }
  TRY(state_->Commit(std::move(next), state_->CurrentProduct()));
  return drawing;
}

Result<std::shared_ptr<const Drawing>> Session::FindShape(const std::string& shape_id) const {
  const std::lock_guard lock(state_->mutex);
  const std::ptrdiff_t at = state_->content.Find(shape_id);
  if (at < 0) return ShapeNotFound(id_, shape_id);
  return state_->content.drawings[at];
}

std::vector<std::shared_ptr<const Drawing>> Session::Shapes() const {
  return state_->Current().drawings;
}

Result<void> Session::DeleteShape(const std::string& shape_id) {
  const std::lock_guard edit(state_->editing);
  State::Content next = TRY(state_->ContentToEdit(""));
  const std::ptrdiff_t at = next.Find(shape_id);
  if (at < 0) return ShapeNotFound(id_, shape_id);
  next.drawings.erase(next.drawings.begin() + at);
  next.placements.erase(shape_id);
  for (Correspondence& tuple : next.correspondences) tuple.erase(shape_id);
  std::erase_if(next.correspondences, [](const Correspondence& tuple) { return tuple.empty(); });
  return state_->Commit(std::move(next), state_->CurrentProduct());
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
  State::Content next = TRY(state_->ContentToEdit(etag));
  TRY(CheckTuples(tuples, next.ShapeIds()));
  if (!tuples.empty()) {
    TRY(CheckLandmarks(MatchingShapesOf(next.drawings), LandmarksOf(tuples, next.drawings)));
  }
  next.correspondences = std::move(tuples);
  return state_->Commit(std::move(next), state_->CurrentProduct());
}

Result<void> Session::SetPlacements(Placements placements, const std::string& etag) {
  const std::lock_guard edit(state_->editing);
  State::Content next = TRY(state_->ContentToEdit(etag));
  State::Product product = state_->CurrentProduct();
  const std::vector<std::string> ids = next.ShapeIds();
  if (!placements.empty()) {
    TRY(CheckPlaced(ids, placements));
    Points all(std::ssize(ids), 2);
    for (std::size_t i = 0; i < ids.size(); ++i) all.row(i) = placements.at(ids[i]);
    TRY(CheckPlacements(ids, all));
  }
  if (auto& pose_space = product.pose_space; pose_space != nullptr) {
    const auto places = PlacesOf(*pose_space, PlacementsOrDefault(placements, ids));
    if (places && *places != pose_space->placements()) {
      pose_space = TRY(pose_space->WithPlacements(*places));
    }
  }
  next.placements = std::move(placements);
  ++next.placements_version;
  return state_->Commit(std::move(next), std::move(product));
}

}  // namespace posespace
