// SPDX-License-Identifier: Apache-2.0
#include "geometry/sparse_factor.h"

namespace posespace {

Result<SparseFactor> SparseFactor::Factor(const Matrix& matrix) {
  auto factor = std::make_shared<Eigen::SimplicialLDLT<Matrix>>(matrix);
  if (factor->info() != Eigen::Success || !(factor->vectorD().minCoeff() > 0.0)) {
    return Error{ErrorCode::kInternal, "a matrix that must be positive definite is not", {}};
  }
  return SparseFactor(std::move(factor));
}

}  // namespace posespace
