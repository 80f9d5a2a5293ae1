// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_INTERIOR_MOVES_H_
#define POSESPACE_DRAWING_INTERIOR_MOVES_H_

#include <vector>

#include "geometry/mesh.h"

namespace posespace {

// Moves vertices of one pose of a mesh and keeps it valid: every triangle stays positive (exact),
// and the star of no vertex gets a smaller angle than min(what it was given with, 8 degrees).
// One owner; not shared.
class InteriorMoves {
 public:
  // Requires  every triangle is positive in `pose`.
  InteriorMoves(const CompatibleMesh& mesh, const Points& pose);

  const Points& pose() const { return pose_; }

  // By vertex: true for those inside the mesh that are no landmarks.  Only they may move.
  const std::vector<char>& free() const { return free_; }

  // Moves a free vertex if that is allowed, and says whether it did.
  bool Move(int vertex, const Point& to);

 private:
  bool IsAllowed(int vertex) const;

  const Triangles* triangles_;
  Points pose_;
  std::vector<char> free_;
  std::vector<std::vector<int>> around_;  // triangles at each vertex
  std::vector<double> least_;             // angle of each triangle, radians
};

}  // namespace posespace

#endif  // POSESPACE_DRAWING_INTERIOR_MOVES_H_
