// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_TRIANGLE_LOCATOR_H_
#define POSESPACE_INTERPOLATION_TRIANGLE_LOCATOR_H_

#include <Eigen/Core>
#include <vector>

#include "geometry/mesh.h"

namespace posespace {

// A triangle and the place of a point in it.
struct TrianglePlace {
  int triangle;
  Eigen::Vector3d barycentric;  // sums to one
};

// Finds the triangle of a triangulated rectangle [0, width] x [0, height] that holds a point: a
// grid names a triangle close by, from there a walk crosses the edge that the point lies farthest
// beyond.
//
// Immutable; share freely.
class TriangleLocator {
 public:
  // Requires  positive triangles that fill the rectangle; cell > 0, about an edge's length.
  TriangleLocator(Points vertices, Triangles triangles, const Point& size, double cell);

  // The place of a point of the rectangle; rounding may leave a coordinate just below 0.
  // Cost  O(1) where edges are about as long as a cell.
  TrianglePlace Find(const Point& point) const;

 private:
  Eigen::Vector3d Barycentric(const Point& point, int triangle) const;
  TrianglePlace Walk(const Point& point, int start) const;
  int CellOf(const Point& point) const;

  Points vertices_;
  Triangles triangles_;
  Triangles across_;  // the triangle opposite each corner, or -1
  int columns_, rows_;
  double cell_;
  std::vector<int> start_;  // per cell
};

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_TRIANGLE_LOCATOR_H_
