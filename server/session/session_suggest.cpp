// SPDX-License-Identifier: Apache-2.0
// What a session's build would match, for a person to see beforehand.
#include <utility>

#include "mapping/matched_places.h"
#include "session/session_state.h"

namespace posespace {

MatchingOptions MatchingOptionsOf(Rotation rotation) {
  return rotation == Rotation::kAny ? ForAnyRotation() : MatchingOptions();
}

Result<Suggestion> Session::Suggest(const SuggestRequest& request, Progress* progress) const {
  Suggestion suggestion;
  std::vector<std::shared_ptr<const Drawing>> drawings;
  std::vector<Landmark> landmarks;
  {
    const std::lock_guard lock(state_->mutex);
    TRY(state_->AcceptEdit(""));
    drawings = state_->content.drawings;
    landmarks = LandmarksOf(state_->content.correspondences, drawings);
    suggestion.shape_ids = state_->content.ShapeIds();
    suggestion.etag = state_->Etag();
  }
  if (drawings.empty()) {
    return Error{ErrorCode::kNoShapes, "session '" + id_ + "' has no drawing to match", {}};
  }
  auto matched = TRY(MatchBoundaries(MatchingShapesOf(drawings), landmarks,
                                     MatchingOptionsOf(request.rotation), progress));
  suggestion.confidence = std::move(matched.confidence);
  suggestion.proposal = std::move(matched.proposal);
  suggestion.arcs = SampleTogether(matched.outlines, request.samples);
  return suggestion;
}

}  // namespace posespace
