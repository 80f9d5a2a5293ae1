// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_CLOUGH_TOCHER_H_
#define POSESPACE_INTERPOLATION_CLOUGH_TOCHER_H_

#include <Eigen/Core>
#include <array>

#include "geometry/mesh.h"

namespace posespace {

// What the value at a point takes of each corner: value = sum_k c[k][0] f_k + c[k][1] df_k/dx +
// c[k][2] df_k/dy.
using CornerShares = std::array<std::array<double, 3>, 3>;

// The reduced Clough-Tocher element: the C1 piecewise cubic over a triangulation that takes given
// values and gradients at its vertices, split at each triangle's centroid, its normal derivative
// linear along each edge.  It reproduces linear functions; the shares of the values sum to one.
//
// Requires  a positive triangle and barycentric coordinates that sum to one.
// Follows   Farin, Triangular Bernstein-Bezier patches, 1986, section 7.
CornerShares CloughTocher(const std::array<Point, 3>& triangle, const Eigen::Vector3d& barycentric);

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_CLOUGH_TOCHER_H_
