// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_DRAWING_DISPLACEMENT_FIELD_H_
#define POSESPACE_DRAWING_DISPLACEMENT_FIELD_H_

#include <vector>

#include "geometry/mesh.h"

namespace posespace {

// The smooth field over the vertices of a mesh that follows given displacements where their weights
// say so: the minimum of
//   sum over edges |u_a - u_b|^2 + sum over free vertices weight_v |u_v - given_v|^2,
// zero at vertices that are not free.  Weights are not negative; a part of the mesh without a fixed
// vertex and without weight gets zero.
// Requires  given V x 2 finite, weights and free of length V.  Cost: one sparse factorisation.
Points SmoothField(const Edges& edges, const std::vector<char>& free, const Points& given,
                   const Eigen::VectorXd& weights);

}  // namespace posespace

#endif  // POSESPACE_DRAWING_DISPLACEMENT_FIELD_H_
