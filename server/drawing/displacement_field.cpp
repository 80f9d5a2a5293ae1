// SPDX-License-Identifier: Apache-2.0
#include "drawing/displacement_field.h"

#include "geometry/sparse_factor.h"

namespace posespace {

Points SmoothField(const Edges& edges, const std::vector<char>& free, const Points& given,
                   const Eigen::VectorXd& weights) {
  constexpr double kPullToZero = 1e-9;  // keeps the matrix definite where nothing else does
  Points field = Points::Zero(given.rows(), 2);
  std::vector<int> row(given.rows(), -1);
  int rows = 0;
  for (Eigen::Index v = 0; v < given.rows(); ++v) {
    if (free[v] != 0) row[v] = rows++;
  }
  if (rows == 0) return field;

  std::vector<Eigen::Triplet<double>> entries;
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(rows, 2);
  for (Eigen::Index v = 0; v < given.rows(); ++v) {
    if (row[v] < 0) continue;
    entries.emplace_back(row[v], row[v], weights[v] + kPullToZero);
    right.row(row[v]) = weights[v] * given.row(v);
  }
  for (Eigen::Index e = 0; e < edges.rows(); ++e) {
    const int a = row[edges(e, 0)], b = row[edges(e, 1)];
    if (a >= 0) entries.emplace_back(a, a, 1.0);
    if (b >= 0) entries.emplace_back(b, b, 1.0);
    if (a < 0 || b < 0) continue;
    entries.emplace_back(a, b, -1.0);
    entries.emplace_back(b, a, -1.0);
  }
  SparseFactor::Matrix matrix(rows, rows);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const auto factor = SparseFactor::Factor(matrix);
  if (!factor) return field;
  const Eigen::MatrixXd solution = factor->Solve(right);
  if (!solution.allFinite()) return field;
  for (Eigen::Index v = 0; v < given.rows(); ++v) {
    if (row[v] >= 0) field.row(v) = solution.row(row[v]);
  }
  return field;
}

}  // namespace posespace
