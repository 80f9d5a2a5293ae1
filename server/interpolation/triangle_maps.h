// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_TRIANGLE_MAPS_H_
#define POSESPACE_INTERPOLATION_TRIANGLE_MAPS_H_

#include <Eigen/Core>
#include <vector>

#include "geometry/mesh.h"

namespace posespace {

// The shape of triangles that poses are measured against.
enum class RestShape {
  kMean,       // the mean over the poses of their metrics E'E
  kFirstPose,  // pose 0
};

// How every pose maps every rest triangle: a rotation and a symmetric stretch.
//
// Each rest triangle is turned so that pose 0 maps it without rotation; column i of the matrices is
// pose i.  Triangles run along the columns, so that a blend is a matrix-vector product.
struct TriangleMaps {
  Eigen::MatrixXd gradients;  // T x 6: the rest gradient (x, y) of each corner's hat function
  Eigen::VectorXd areas;      // T, of the rest triangles
  Eigen::VectorXd masses;     // T: the areas, more where some pose makes the triangle small
  Eigen::MatrixXd rotations;  // T x N, radians, continuous over each part of the mesh
  Eigen::MatrixXd stretches;  // 3 T x N: all xx, then all xy, then all yy
};

// For each triangle the number of its part: triangles that hang together over shared edges.
std::vector<int> EdgeConnectedParts(const Triangles& triangles);

// Measures all poses.  Rotations are unwrapped breadth first over triangles that share an edge:
// neighbours in a valid mesh differ by less than half a turn, so the result does not depend on the
// order of the search.  The whole turns common to a part are arbitrary.
//
// Requires  a valid mesh in which each triangle has positive area in some pose.
TriangleMaps MeasureTriangles(const CompatibleMesh& mesh, RestShape rest_shape);

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_TRIANGLE_MAPS_H_
