// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_GEOMETRY_MESH_H_
#define POSESPACE_GEOMETRY_MESH_H_

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

// Every convention of the kernel, once:
//
//   Drawing coordinates   pixels of the source drawing, x right, y DOWN, as bitmaps and SVG have
//   it.
//                         Pixel (i, j) covers the square [i, i+1] x [j, j+1].
//   Positive              a triangle (a, b, c) is positive when cross(b - a, c - a) > 0 in these
//                         coordinates; an outer ring is positively oriented when its signed area
//                         is > 0 (clockwise to the eye), a hole when it is < 0.
//   Rings                 are closed without repeating the first point.
//   Angles                radians.     Indices   from 0.
//   Size of a drawing     the square root of its outline's area; tolerances are relative to it.
//   Topology              is decided by exact predicates (polygon.h), geometry computed in double.

namespace posespace {

using Point = Eigen::Vector2d;
using Points = Eigen::Matrix<double, Eigen::Dynamic, 2, Eigen::RowMajor>;           // K x 2
using Triangles = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 3, Eigen::RowMajor>;  // T x 3

// One list of triangles that is valid in N drawings at once.
//
// Every pose has V rows; row v is the same place of the character in each.  Every triangle is
// positive in every pose and each boundary loop is a simple polygon there: no pose folds over.
struct CompatibleMesh {
  Triangles triangles;
  std::vector<Points> poses;               // N of V x 2, drawing pixels
  std::vector<std::vector<int>> boundary;  // loops of vertex indices, outer loop first
  std::vector<int> landmarks;              // vertex of each user landmark, in the user's order

  int num_vertices() const { return poses.empty() ? 0 : static_cast<int>(poses[0].rows()); }
  int num_triangles() const { return static_cast<int>(triangles.rows()); }
  int num_poses() const { return static_cast<int>(poses.size()); }
};

// cross(b - a, c - a): twice the triangle's signed area, in double.
inline double Cross(const Point& a, const Point& b, const Point& c) {
  return (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
}

// The smallest angle of triangle (a, b, c), radians; 0 when it has no area.
double MinAngle(const Point& a, const Point& b, const Point& c);

// The smallest angle of the mesh over all triangles and poses, radians.
double MinAngle(const CompatibleMesh& mesh);

// For each edge, the triangles beside it: row e is (a, b, left, right), a < b, right -1 at the
// boundary.  Rows are sorted by (a, b).
using Edges = Eigen::Matrix<std::int32_t, Eigen::Dynamic, 4, Eigen::RowMajor>;
Edges EdgesOf(const Triangles& triangles);

}  // namespace posespace

#endif  // POSESPACE_GEOMETRY_MESH_H_
