// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_GEOMETRY_POLYGON_H_
#define POSESPACE_GEOMETRY_POLYGON_H_

#include <optional>
#include <utility>

#include "geometry/mesh.h"
#include "geometry/progress.h"

// Exact tests on points, segments and rings.  Every answer is exact for the doubles given
// (CGAL's filtered predicates); no epsilon decides a sign.  All functions are pure.

namespace posespace {

// The sign of cross(b - a, c - a): +1 when (a, b, c) is positive, -1 negative, 0 collinear.
int Orientation(const Point& a, const Point& b, const Point& c);

// True when closed segments ab and cd share a point.
bool SegmentsMeet(const Point& a, const Point& b, const Point& c, const Point& d);

// True when p lies on the closed segment ab.
bool IsOnSegment(const Point& p, const Point& a, const Point& b);

// Signed area of a ring, in double; > 0 when positively oriented.
double SignedArea(const Points& ring);

// Area centroid of a ring with non-zero area, in double.
Point AreaCentroid(const Points& ring);

// Length of a closed ring, in double.
double Perimeter(const Points& ring);

// The first pair of edges (i, j), i < j, that meet where they must not, or nothing when the ring
// is simple.  Edge k goes from row k to row k + 1.  Neighbouring edges must share their common
// point only.  Cost O(K^2) exact tests behind a bounding-box filter along x; a cancelled search
// finds nothing, and its caller asks `progress` whether that counts.
std::optional<std::pair<int, int>> FindCrossing(const Points& ring,
                                                const Progress* progress = nullptr);
inline bool IsSimple(const Points& ring) { return !FindCrossing(ring).has_value(); }

// Where p lies: +1 inside the ring, 0 on it, -1 outside (even-odd rule, exact).
int Locate(const Point& p, const Points& ring);

// Where a compatible mesh fails to be one.
struct MeshDefect {
  int pose;
  int triangle;  // a triangle that is not positive, or -1
  int edge_a;    // two edges of the outer boundary loop that cross, or -1
  int edge_b;
};

// The first pose and triangle that is not positive, or the first boundary loop that is not simple;
// nothing when the mesh is valid in every pose.
std::optional<MeshDefect> FindDefect(const CompatibleMesh& mesh);

}  // namespace posespace

#endif  // POSESPACE_GEOMETRY_POLYGON_H_
