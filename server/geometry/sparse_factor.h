// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_GEOMETRY_SPARSE_FACTOR_H_
#define POSESPACE_GEOMETRY_SPARSE_FACTOR_H_

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <memory>

#include "geometry/result.h"

namespace posespace {

// A symmetric positive definite matrix, factored once and solved many times (LDL^T, double).
// Immutable after Factor(): share freely between threads.
class SparseFactor {
 public:
  using Matrix = Eigen::SparseMatrix<double>;

  // Fails with kInternal when the matrix is not positive definite.
  static Result<SparseFactor> Factor(const Matrix& matrix);

  // X with A X = rhs, for any number of columns.
  Eigen::MatrixXd Solve(const Eigen::MatrixXd& rhs) const { return factor_->solve(rhs); }

 private:
  explicit SparseFactor(std::shared_ptr<const Eigen::SimplicialLDLT<Matrix>> factor)
      : factor_(std::move(factor)) {}
  std::shared_ptr<const Eigen::SimplicialLDLT<Matrix>> factor_;
};

}  // namespace posespace

#endif  // POSESPACE_GEOMETRY_SPARSE_FACTOR_H_
