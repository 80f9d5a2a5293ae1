// SPDX-License-Identifier: Apache-2.0
// How a session's inputs become its pose space: builds are started, attached to, replaced.
#include <utility>

#include "session/session_state.h"

namespace posespace {
namespace {

Result<void> CheckRange(const std::string& field, double value, double least, double greatest) {
  if (value >= least && value <= greatest) return {};
  const std::string message = field + " is " + std::to_string(value) + ", not " +
                              std::to_string(least) + " to " + std::to_string(greatest);
  return Error{ErrorCode::kInvalidOption, message, {{field, message}}};
}

Result<void> CheckMaxVertices(int value, const Limits& limits) {
  if (value >= 3 && value <= limits.max_mesh_vertices) return {};
  const std::string field = "options.max_vertices";
  const std::string message = field + " is " + std::to_string(value) + ", not 3 to " +
                              std::to_string(limits.max_mesh_vertices);
  return Error{ErrorCode::kInvalidOption, message, {{field, message}}};
}

Result<MappingOptions> OptionsOf(const BuildRequest& request, const Limits& limits) {
  TRY(CheckRange("options.tolerance", request.tolerance, 0.001, 0.2));
  TRY(CheckRange("options.target_edge_length", request.target_edge_length, 0.02, 1.0));
  MappingOptions options;
  options.matching = MatchingOptionsOf(request.rotation);
  options.simplification.tolerance = request.tolerance;
  options.improvement.target_edge_length = request.target_edge_length;
  const int max_vertices = request.max_vertices.value_or(limits.max_mesh_vertices);
  TRY(CheckMaxVertices(max_vertices, limits));
  options.triangulation.max_vertices = max_vertices;
  options.improvement.max_vertices = max_vertices;
  return options;
}

}  // namespace

Result<BuildStatus> Session::StartBuild(const BuildRequest& request, BuildPool& pool) {
  const std::lock_guard edit(state_->editing);
  BuildInputs inputs;
  inputs.options = TRY(OptionsOf(request, limits_));
  inputs.align = request.align;
  const State::Content content = TRY(state_->ContentToEdit(""));
  if (content.drawings.empty()) {
    return Error{ErrorCode::kNoShapes, "session '" + id_ + "' has no drawing to build from", {}};
  }
  const std::vector<std::string> ids = content.ShapeIds();
  const Placements placements = PlacementsOrDefault(content.placements, ids);
  TRY(CheckPlaced(ids, placements));
  inputs.placements.resize(std::ssize(ids), 2);
  for (std::size_t i = 0; i < ids.size(); ++i) inputs.placements.row(i) = placements.at(ids[i]);
  inputs.drawings = content.drawings;
  inputs.landmarks = LandmarksOf(content.correspondences, inputs.drawings);

  const auto previous = state_->Latest();
  const auto built = state_->BuiltOrNull();
  const std::string revision = RevisionDigest(inputs);
  if (previous != nullptr && previous->revision() == revision && !previous->cancelled()) {
    BuildStatus status = previous->Status();
    status.attached = true;
    const bool current = built != nullptr && built->revision() == revision;
    if (!status.ended() || (status.state == BuildState::kSucceeded && current)) return status;
  }

  // What is built already, or comes from it by new placements alone, is not built again.  The
  // number is kept first: no later build, of whatever process, has it, too.
  const std::int64_t number = state_->builds + 1;
  const std::string build_id = std::to_string(number);
  const bool is_built = built != nullptr && built->revision() == revision;
  TRY(state_->Keep(content, {built, is_built ? build_id : state_->build_id}, number));
  state_->builds = number;
  std::shared_ptr<BuildJob> job;
  if (is_built) {
    state_->build_id = build_id;
    job = std::make_shared<BuildJob>(build_id, built, state_->build_changes);
  } else {
    const auto publish = [weak = std::weak_ptr(state_), placed = content.placements_version](
                             const BuildStatus& status) -> Result<void> {
      const auto state = weak.lock();
      return state == nullptr ? Result<void>() : state->Publish(status, placed);
    };
    job = std::make_shared<BuildJob>(build_id, std::move(inputs), publish, built,
                                     state_->build_changes);
    TRY(pool.Submit(job));
  }
  {
    // A job that is done by now waits with its result for `editing`, and finds itself the latest.
    const std::lock_guard lock(state_->mutex);
    if (!state_->closed) {
      const std::lock_guard read(state_->reading);
      state_->latest = job;
    }
  }
  if (previous != nullptr) previous->Cancel();
  if (closed()) {
    job->Cancel();
    return Error{ErrorCode::kSessionNotFound, "session '" + id_ + "' has been deleted", {}};
  }
  return job->Status();
}

std::shared_ptr<BuildJob> Session::LatestBuild() const { return state_->Latest(); }

Result<std::shared_ptr<const PoseSpace>> Session::Built() const {
  if (auto built = state_->BuiltOrNull()) return built;
  {
    const std::lock_guard lock(state_->reading);
    if (state_->lost) return *state_->lost;
  }
  std::string message = "session '" + id_ + "' has not been built";
  if (const auto latest = state_->Latest()) {
    const BuildStatus status = latest->Status();
    message += status.error ? ": " + status.error->message : ": its build is still running";
  }
  return Error{ErrorCode::kSessionNotBuilt, std::move(message), {}};
}

void Session::Close() {
  {
    const std::lock_guard lock(state_->mutex);
    state_->closed = true;
  }
  if (const auto latest = state_->Latest()) latest->Cancel();
}

Result<void> Session::Delete(const std::string& etag) {
  {
    const std::lock_guard edit(state_->editing);
    TRY(state_->ContentToEdit(etag));
    if (state_->store != nullptr) TRY(state_->store->Remove(id_));
    const std::lock_guard lock(state_->mutex);
    state_->closed = true;
  }
  if (const auto latest = state_->Latest()) latest->Cancel();
  return {};
}

bool Session::closed() const { return state_->closed; }

bool Session::is_building() const {
  const auto latest = state_->Latest();
  return latest != nullptr && !latest->ended();
}

}  // namespace posespace
