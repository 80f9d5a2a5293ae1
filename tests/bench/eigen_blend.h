// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_TESTS_BENCH_EIGEN_BLEND_H_
#define POSESPACE_TESTS_BENCH_EIGEN_BLEND_H_

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>

#include "interpolation/rigid_blend.h"

namespace posespace {

// The rigid blend as one writes it with Eigen, in double: what batch_blend.h is measured against.
// The same method, gauge, shear limit and count of folds; buffers are kept, sums are matrix
// products, and the solve is SimplicialLDLT's for both coordinates at once.
class EigenBlend {
 public:
  explicit EigenBlend(const RigidModel& model);

  // Into vertices(); returns the number of folds.
  int Solve(const Eigen::VectorXd& weights, int refits);
  const FloatPoints& vertices() const { return placed_; }

 private:
  void AssembleAndSolve();
  void RefitRotations();

  const RigidModel& model_;
  Eigen::SparseMatrix<double> divergence_;  // V x 2 T: targets to right-hand sides
  Eigen::SparseMatrix<double> gradient_;    // 2 T x V: vertices to maps
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor_;
  Eigen::ArrayXd angles_, stretch_, cosines_, sines_;
  Eigen::MatrixXd targets_, right_, vertices_, maps_;
  FloatPoints placed_;
};

}  // namespace posespace

#endif  // POSESPACE_TESTS_BENCH_EIGEN_BLEND_H_
