// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_SESSION_H_
#define POSESPACE_SESSION_SESSION_H_

#include <chrono>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "geometry/result.h"
#include "session/build_job.h"
#include "session/build_pool.h"
#include "session/ids.h"
#include "session/limits.h"
#include "session/placements.h"
#include "session/pose_space.h"
#include "session/upload.h"

namespace posespace {

// One place of the character: shape id -> point, drawing pixels.
using Correspondence = std::map<std::string, Point>;

// What a build may vary; see BuildOptions in session_service.proto.
struct BuildRequest {
  double tolerance = 0.03;           // 0.001 .. 0.2
  double target_edge_length = 0.08;  // 0.02 .. 1
};

// What automatic matching would do with a session's drawings and marks.
struct Suggestion {
  std::vector<std::string> shape_ids;  // in the order of upload; the rest is by this order
  std::vector<double> confidence;      // as in MatchedOutlines
  FlipProposal proposal;
  std::vector<Points> arcs;  // as of SampleTogether (matched_places.h)
  std::string etag;          // of the session that was looked at
};

// What one look at a session shows.  A copy.
struct SessionView {
  std::string id;
  std::string display_name;
  std::map<std::string, std::string> labels;
  std::vector<std::string> shape_ids;  // in the order of upload
  std::vector<Correspondence> correspondences;
  Placements placements;  // set or default; a drawing uploaded after the setting has none
  bool placements_are_default = true;
  std::string etag;
  std::chrono::system_clock::time_point created;
  std::chrono::system_clock::time_point updated;
  std::string revision;              // empty before the first build
  std::optional<BuildStatus> build;  // the latest
};

// The small mutable thing that a caller edits: drawings, correspondences, placements, and the state
// of its build.  Thread-safe; decoding and tracing run outside its locks.  Edits of one session
// wait for each other; View() waits for no more than a copy; readers of the built pose space take a
// shared pointer and never wait for an edit or a build.
//
// The etag changes with every edit and with every new revision.  An empty etag in a condition means
// any.  Edits of a session that was closed fail with kSessionNotFound.
class Session {
 public:
  Session(std::string id, std::string display_name, std::map<std::string, std::string> labels,
          const Limits& limits);

  const std::string& id() const { return id_; }
  SessionView View() const;
  std::string etag() const;

  // Decodes and traces a drawing, flips it if asked (flip.h), and keeps it.  The same source again
  // under the same id is answered as before; another one needs `replace`, and takes the old one's
  // place in the order.  Marks and placement stay with the id, and marks move with a drawing that
  // is only flipped; those that a new drawing does not bear are refused by the next build. Fails
  // kShapeExists, kTooManyShapes, kInvalidId, kImageTooLarge (also for all drawings
  //        together), and as ReadDrawing (upload.h).
  Result<std::shared_ptr<const Drawing>> PutShape(const std::string& shape_id, ShapeSource source,
                                                  bool replace, bool flip = false);
  Result<std::shared_ptr<const Drawing>> FindShape(const std::string& shape_id) const;
  std::vector<std::shared_ptr<const Drawing>> Shapes() const;

  // Removes a drawing, its marks and its placement.  Fails with kShapeNotFound.
  Result<void> DeleteShape(const std::string& shape_id);

  // Replaces all correspondences after checking them against the outlines: all faults at once.
  // Fails  kTooManyLandmarks, kInvalidOption (a tuple without a mark), kShapeNotFound,
  //        kEtagMismatch, and as CheckLandmarks (boundary_matching.h).
  Result<void> SetCorrespondences(std::vector<Correspondence> tuples, const std::string& etag);

  // Replaces all placements; empty returns to the default.  A built session gets a new weight field
  // at once when every drawing of its pose space is placed.
  // Fails  as CheckPlaced and CheckPlacements (placements.h); kEtagMismatch.
  Result<void> SetPlacements(Placements placements, const std::string& etag);

  // What a build would match, at `samples` places; nothing is changed.  Runs on the caller's
  // thread, outside the locks, as long as a build's matching. Fails  kNoShapes, kSessionNotFound
  // (closed), and as MatchBoundaries.
  Result<Suggestion> Suggest(int samples, Progress* progress) const;

  // Starts a build on `pool`, or attaches to the running or finished one of the same inputs.  A
  // build of other inputs cancels a running one; a failed or cancelled one is tried again.
  // Fails  kNoShapes, kInvalidOption (options; a drawing without a place), and as
  //        BuildPool::Submit; then a running build goes on.
  Result<BuildStatus> StartBuild(const BuildRequest& request, BuildPool& pool);

  // The latest build, if any.
  std::shared_ptr<BuildJob> LatestBuild() const;

  // The built pose space.  Fails with kSessionNotBuilt; the message says why the latest build
  // failed, if it did.
  Result<std::shared_ptr<const PoseSpace>> Built() const;

  // Cancels a running build; the session is about to go.
  void Close();
  // The same on a condition.  Fails  kEtagMismatch, kSessionNotFound (closed before).
  Result<void> CloseIf(const std::string& etag);
  bool closed() const;

 private:
  struct State;
  const std::string id_;
  const Limits limits_;
  const std::shared_ptr<State> state_;  // shared with running builds, which publish into it
};

}  // namespace posespace

#endif  // POSESPACE_SESSION_SESSION_H_
