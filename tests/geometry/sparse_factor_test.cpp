// SPDX-License-Identifier: Apache-2.0
#include "geometry/sparse_factor.h"

#include <gtest/gtest.h>

namespace posespace {
namespace {

SparseFactor::Matrix Tridiagonal(int n, double diagonal) {
  SparseFactor::Matrix matrix(n, n);
  for (int i = 0; i < n; ++i) {
    matrix.insert(i, i) = diagonal;
    if (i > 0) matrix.insert(i, i - 1) = -1.0;
    if (i + 1 < n) matrix.insert(i, i + 1) = -1.0;
  }
  return matrix;
}

TEST(SparseFactor, SolvesSeveralRightHandSidesAtOnce) {
  const auto matrix = Tridiagonal(50, 2.5);
  const auto factor = SparseFactor::Factor(matrix);
  ASSERT_TRUE(factor);
  const Eigen::MatrixXd expected = Eigen::MatrixXd::Random(50, 3);
  EXPECT_LT((factor->Solve(matrix * expected) - expected).cwiseAbs().maxCoeff(), 1e-12);
}

TEST(SparseFactor, RefusesAMatrixThatIsNotPositiveDefinite) {
  EXPECT_FALSE(SparseFactor::Factor(Tridiagonal(50, 1.0)));
  EXPECT_FALSE(SparseFactor::Factor(Tridiagonal(50, -3.0)));
}

}  // namespace
}  // namespace posespace
