// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_FOLD_REPAIR_H_
#define POSESPACE_INTERPOLATION_FOLD_REPAIR_H_

#include <Eigen/Core>
#include <functional>

#include "geometry/mesh.h"

namespace posespace {

// The triangles that a mesh should have.
struct TargetTriangles {
  Eigen::MatrixXd gradients;  // T x 6: the gradient (x, y) of each corner's hat function
  Eigen::VectorXd areas;      // T, positive
};

// Unfolds a mesh: moves vertices as little as it must so that each triangle is positive and as
// near to its target as the others allow.
//
// With K_t the map from target triangle t, minimises  sum_t area_t f(K_t)  over all vertices,
//
//   f(K) = (tr K'K + det^2 K + 1) / chi(det K),   chi(d) = (d + sqrt(e^2 + d^2)) / 2,
//
// which rises without bound before a triangle can fold; e > 0 lets folded ones through, and
// shrinks while they unfold.  f is least for rotations.  Triangles become positive; parts of the
// mesh may still lie across each other.
//
// `precondition` is an approximate inverse of the problem's matrix for V x 2 right-hand sides, such
// as GradientFit::SolveNormal.
//
// Returns   vertices with as few folds as it found, never more than `start` has.
// Cost      some ten to a hundred steps, each some times a blend: fewer the larger the mesh, so
//           that the largest takes a fraction of a second.
// Follows   Garanzha, Kaporin, Kudryavtseva, Protais, Ray, Sokolov 2021; quasi-Newton steps as
//           Liu, Nocedal 1989.
Points Unfolded(const Triangles& triangles, const TargetTriangles& targets, const Points& start,
                const std::function<Eigen::MatrixXd(const Eigen::MatrixXd&)>& precondition);

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_FOLD_REPAIR_H_
