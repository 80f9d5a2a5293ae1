// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_INTERIOR_MOVES_H_
#define POSESPACE_DRAWING_INTERIOR_MOVES_H_

#include <vector>

#include "geometry/mesh.h"

namespace posespace {

// Moves vertices of one pose of a mesh and keeps it valid: every triangle stays positive (exact),
// the star of no vertex gets a smaller angle than min(what it was given with, 8 degrees), and no
// triangle is stretched or squeezed, in any direction, to more than kMostStretch times its size or
// less than one part in so many: what is drawn in it would no longer look like itself.
// One owner; not shared.
class InteriorMoves {
 public:
  static constexpr double kMostStretch = 2.5;

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
  std::vector<Eigen::Matrix2d> inverse_;  // of two sides of each triangle as given, in columns
};

}  // namespace posespace

#endif  // POSESPACE_DRAWING_INTERIOR_MOVES_H_
