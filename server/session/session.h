// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_SESSION_SESSION_H_
#define POSESPACE_SESSION_SESSION_H_

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "geometry/result.h"
#include "session/build_job.h"
#include "session/limits.h"
#include "session/pose_space.h"

namespace posespace {

// Source of a drawing.
struct ImageSource {
  std::vector<std::uint8_t> data;  // a picture file
  int threshold = 128;             // alpha from which a pixel is painted, 1 .. 255
};
struct PolygonSource {
  Points outer;
  std::vector<Points> holes;
  std::vector<std::uint8_t> texture;  // a picture file, or empty
};
using ShapeSource = std::variant<ImageSource, PolygonSource>;

// One place of the character: shape id -> point, drawing pixels.
using Correspondence = std::map<std::string, Point>;

// shape id -> point of pose space.
using Placements = std::map<std::string, Point>;

// What a build may vary; see BuildOptions in session_service.proto.
struct BuildRequest {
  double tolerance = 0.03;
  double target_edge_length = 0.08;
};

// What one look at a session shows.  A copy.
struct SessionView {
  std::string id;
  std::string display_name;
  std::map<std::string, std::string> labels;
  std::vector<std::string> shape_ids;  // in the order of upload
  std::vector<Correspondence> correspondences;
  Placements placements;
  bool placements_are_default = true;
  std::string etag;
  std::chrono::system_clock::time_point created;
  std::chrono::system_clock::time_point updated;
  std::string revision;                // empty before the first build
  std::optional<BuildStatus> build;    // the latest
};

// An id as sessions and shapes have it: 1-63 of letters, digits, '_', '.', '-', beginning with a
// letter or digit.  Fails with kInvalidId, naming `what` and the id.
Result<void> CheckId(const std::string& what, const std::string& id);

// Where N drawings lie when nobody placed them: one at (0, 0), more on the unit circle, in the order
// of upload, pose k at angle 2 pi k / N from (1, 0).
Points DefaultPlacements(int count);

// The small mutable thing that a caller edits: drawings, correspondences, placements, and the state
// of its build.  Thread-safe; decoding and tracing run outside its lock.  Readers of the built pose
// space take a shared pointer and never wait for an edit or a build.
class Session {
 public:
  Session(std::string id, std::string display_name, std::map<std::string, std::string> labels,
          const Limits& limits);

  const std::string& id() const { return id_; }
  SessionView View() const;

  // Decodes and traces a drawing and keeps it.  The same source again under the same id is answered as
  // before; another one needs `replace`.
  // Fails  kShapeExists, kTooManyShapes, kInvalidId, and as DecodeImage and TraceOutline or
  //        OutlineFromRings do, with the shape's name in the message.
  Result<std::shared_ptr<const Drawing>> PutShape(const std::string& shape_id, ShapeSource source,
                                                  bool replace);
  Result<std::shared_ptr<const Drawing>> FindShape(const std::string& shape_id) const;
  std::vector<std::shared_ptr<const Drawing>> Shapes() const;
  Result<void> DeleteShape(const std::string& shape_id);

  // Replaces all correspondences after checking them against the outlines: all faults at once.
  // An empty etag means any.
  Result<void> SetCorrespondences(std::vector<Correspondence> tuples, const std::string& etag);

  // Replaces all placements; empty returns to the default.  A built session gets a new weight field
  // at once when every drawing of its pose space is placed.
  Result<void> SetPlacements(Placements placements, const std::string& etag);

  // Starts a build on `pool`, or attaches to the running or finished one of the same inputs.  A build of
  // other inputs cancels a running one.
  Result<BuildStatus> StartBuild(const BuildRequest& request, BuildPool& pool);

  // The latest build, if any.
  std::shared_ptr<BuildJob> LatestBuild() const;

  // The built pose space.  Fails with kSessionNotBuilt; the message says why the latest build failed, if
  // it did.
  Result<std::shared_ptr<const PoseSpace>> Built() const;

  // Cancels a running build; the session is about to go.
  void Close();
  bool closed() const;

 private:
  struct State;
  const std::string id_;
  const Limits limits_;
  const std::shared_ptr<State> state_;  // shared with running builds, which publish into it
};

}  // namespace posespace

#endif  // POSESPACE_SESSION_SESSION_H_
