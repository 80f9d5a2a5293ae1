// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_GRADIENT_FIT_H_
#define POSESPACE_INTERPOLATION_GRADIENT_FIT_H_

#include <Eigen/Core>
#include <vector>

#include "geometry/mesh.h"
#include "geometry/result.h"
#include "geometry/sparse_factor.h"

namespace posespace {

// The parts of a mesh: vertices that hang together over triangles.
struct VertexParts {
  std::vector<int> part_of;  // of each vertex
  int count = 0;
};
VertexParts PartsOf(const Triangles& triangles, int num_vertices);

// The matrix of min_V sum_t mass_t |J_t V - target_t|^2, J_t the linear map from rest triangle t:
// sum_t mass_t J_t'J_t, and a spring to 0 at the first vertex of each part.
//
// Requires  as GradientFit::Prepare.
SparseFactor::Matrix NormalMatrix(const Triangles& triangles, const VertexParts& parts,
                                  const Eigen::MatrixXd& gradients, const Eigen::VectorXd& masses);

// Finds the mesh whose triangles' maps are nearest to given ones:
// min_V sum_t mass_t |J_t V - target_t|^2, J_t the linear map from rest triangle t.
//
// Immutable; share freely.
// Follows   Baxter, Barla, Anjyo 2009, section 4.2; Alexa, Cohen-Or, Levin 2000.
class GradientFit {
 public:
  // Requires  gradients T x 6, of the rest triangles' hat functions (triangle_maps.h); masses T,
  //           positive; each vertex in some triangle.
  // Fails     kInternal when the problem is singular in double.
  static Result<GradientFit> Prepare(const Triangles& triangles, const VertexParts& parts,
                                     const Eigen::MatrixXd& gradients,
                                     const Eigen::VectorXd& masses);

  // V x 2 for T x 4 targets (xx, xy, yx, yy); the first vertex of each part lies at 0.
  Eigen::MatrixXd Solve(const Eigen::MatrixXd& targets) const;

  // V x 2 for a right-hand side of the problem's matrix (NormalMatrix).
  Eigen::MatrixXd SolveNormal(const Eigen::MatrixXd& right) const { return factor_.Solve(right); }

  // T x 4: mass_t J_t of V x 2 vertices.
  void WeightedMaps(const Points& vertices, Eigen::MatrixXd* maps) const;

 private:
  GradientFit(Triangles triangles, Eigen::Index num_vertices, Eigen::MatrixXd gradients,
              SparseFactor factor)
      : triangles_(std::move(triangles)),
        num_vertices_(num_vertices),
        weighted_gradients_(std::move(gradients)),
        factor_(std::move(factor)) {}

  Triangles triangles_;
  Eigen::Index num_vertices_;
  Eigen::MatrixXd weighted_gradients_;  // T x 6, mass_t times the gradients
  SparseFactor factor_;                 // of sum_t mass_t J_t'J_t
};

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_GRADIENT_FIT_H_
