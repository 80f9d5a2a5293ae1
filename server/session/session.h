// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_SESSION_H_
#define POSESPACE_SESSION_SESSION_H_

#include <map>
#include <memory>
#include <string>
#include <vector>

#include "geometry/result.h"
#include "session/build_pool.h"
#include "session/ids.h"
#include "session/limits.h"
#include "session/placements.h"
#include "session/pose_space.h"
#include "session/session_view.h"
#include "session/upload.h"
#include "store/store.h"

namespace posespace {

// How drawings may be turned against each other; see Rotation in session_service.proto.
enum class Rotation { kUpright, kAny };

// What a build may vary; see BuildOptions in session_service.proto.
struct BuildRequest {
  double tolerance = 0.03;               // 0.001 .. 0.2
  double target_edge_length = 0.08;      // 0.02 .. 1
  bool align = true;                     // inner vertices to what is drawn there
  std::optional<int> max_vertices = {};  // of the mesh, 3 .. Limits::max_mesh_vertices, the default
  Rotation rotation = Rotation::kUpright;
};

// What a look at the matching may vary; see SuggestCorrespondencesRequest.
struct SuggestRequest {
  int samples = 64;  // 1 .. 1024
  Rotation rotation = Rotation::kUpright;
};

// What automatic matching would do with a session's drawings and marks.
struct Suggestion {
  std::vector<std::string> shape_ids;  // in the order of upload; the rest is by this order
  std::vector<double> confidence;      // as in MatchedOutlines
  FlipProposal proposal;
  std::vector<Points> arcs;  // as of SampleTogether (matched_places.h)
  std::string etag;          // of the session that was looked at
};

// What a session is created with.
struct NewSession {
  std::string id = {};            // empty: an unguessable one is chosen (128 random bits)
  std::string display_name = {};  // up to 256 bytes
  std::map<std::string, std::string> labels = {};  // up to 64, keys and values up to 256 bytes
  std::string request_id = {};                     // up to 256 bytes
};

// The small mutable thing that a caller edits: drawings, correspondences, placements, and the state
// of its build.  Thread-safe; decoding and tracing run outside its locks.  Edits of one session
// wait for each other; View() waits for no more than a copy; readers of the built pose space take a
// shared pointer and never wait for an edit or a build.
//
// With a store, what a call changed is kept there before the call returns, and what a build made
// before the build is said to have succeeded; what cannot be kept has not happened, and the call
// fails with kStoreUnavailable.  A session loaded again is the same, its etag and blends included;
// of its builds it knows the one behind its pose space.  Calls that edit wait for the store;
// reading ones never do.
//
// The etag changes with every edit and with every new revision.  An empty etag in a condition means
// any.  Edits of a session that was closed fail with kSessionNotFound.
class Session {
 public:
  // A session that ends with its object.
  Session(std::string id, std::string display_name, std::map<std::string, std::string> labels,
          const Limits& limits);

  // A new session, kept in a store.  Fails with kSessionExists, kStoreUnavailable.
  static Result<std::shared_ptr<Session>> Create(NewSession request, const Limits& limits,
                                                 std::shared_ptr<Store> store);

  // A kept session with its drawings and pose space.  Damaged bytes of a pose space cost no more
  // than it: the session loads, and Built() says so until it is built again.
  // Fails  kSessionNotFound, kStoreUnavailable, kSnapshotCorrupt (its record, or a drawing).
  // Cost   some 10 ms, of which a pose space is most.
  static Result<std::shared_ptr<Session>> Load(const std::string& id, const Limits& limits,
                                               std::shared_ptr<Store> store);

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

  // What a build would match; nothing is changed.  Runs on the caller's
  // thread, outside the locks, as long as a build's matching. Fails  kNoShapes, kSessionNotFound
  // (closed), and as MatchBoundaries.
  Result<Suggestion> Suggest(const SuggestRequest& request, Progress* progress) const;

  // Starts a build on `pool`, or attaches to the running or finished one of the same inputs.  A
  // build of other inputs cancels a running one; a failed or cancelled one is tried again.
  // Fails  kNoShapes, kInvalidOption (options; a drawing without a place), and as
  //        BuildPool::Submit; then a running build goes on.
  Result<BuildStatus> StartBuild(const BuildRequest& request, BuildPool& pool);

  // The latest build, if any.
  std::shared_ptr<BuildJob> LatestBuild() const;

  // The built pose space.  Fails with kSessionNotBuilt; the message says why the latest build
  // failed, if it did; with kSnapshotCorrupt when it was built, but its stored bytes are damaged.
  Result<std::shared_ptr<const PoseSpace>> Built() const;

  // Cancels a running build; the object is about to go.
  void Close();
  // Removes the session from its store and closes it.
  // Fails  kEtagMismatch, kSessionNotFound (closed before), kStoreUnavailable.
  Result<void> Delete(const std::string& etag);
  bool closed() const;

  // About how much memory its drawings and pose space take.  Waits for no more than a copy.
  std::int64_t MemoryBytes() const;

  // True while a build waits or runs: the session is needed though nobody holds it.
  bool is_building() const;

 private:
  struct State;
  Session(std::shared_ptr<State> state, const Limits& limits);

  const std::string id_;
  const Limits limits_;
  const std::shared_ptr<State> state_;  // shared with running builds, which publish into it
};

}  // namespace posespace

#endif  // POSESPACE_SESSION_SESSION_H_
