// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_POSE_LATTICE_H_
#define POSESPACE_INTERPOLATION_POSE_LATTICE_H_

#include <vector>

#include "geometry/mesh.h"

namespace posespace {

// A near-equilateral triangulation of the rectangle around placements, with a vertex on each.
//
// Rows of equal triangles; halves of one along two sides make these straight.  Near poses that are
// close together the lattice is halved until a pose's neighbour is over two edges away (one level
// to the next by bisected triangles), then the vertex nearest to each pose is moved onto it and its
// neighbours are relaxed.  Mirrored placements give a mirrored lattice, but for ties.
struct PoseLattice {
  Points vertices;
  Triangles triangles;             // all positive
  std::vector<int> pose_vertices;  // the vertex on each placement
  Point size = Point::Zero();      // the rectangle is [0, x] x [0, y]
  double spacing = 0.0;            // edge length away from close poses
};

// Requires  placements (N x 2) in [margin, size - margin] for a margin of many spacings, no two
//           nearer than 1e-3; 0 < spacing << size.
PoseLattice TessellateAround(const Points& placements, const Point& size, double spacing);

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_POSE_LATTICE_H_
