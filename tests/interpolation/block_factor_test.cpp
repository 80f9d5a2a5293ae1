// SPDX-License-Identifier: Apache-2.0
#include "interpolation/block_factor.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <vector>

#include "tests/interpolation/sample_meshes.h"

namespace posespace {
namespace {

using Sparse = Eigen::SparseMatrix<double>;

// A spring network over the edges, each unknown also tied to 0.
Sparse Springs(int count, const std::vector<std::pair<int, int>>& edges, std::mt19937* random) {
  std::vector<Eigen::Triplet<double>> entries;
  for (int k = 0; k < count; ++k) entries.emplace_back(k, k, 0.1);
  for (const auto& [a, b] : edges) {
    const double stiffness = Uniform(0.5, 2.0, random);
    entries.emplace_back(a, a, stiffness);
    entries.emplace_back(b, b, stiffness);
    entries.emplace_back(a, b, -stiffness);
    entries.emplace_back(b, a, -stiffness);
  }
  Sparse matrix(count, count);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

std::vector<std::pair<int, int>> GridEdges(int columns, int rows) {
  std::vector<std::pair<int, int>> edges;
  for (int i = 0; i < columns; ++i) {
    for (int j = 0; j < rows; ++j) {
      if (i > 0) edges.emplace_back(i * rows + j, (i - 1) * rows + j);
      if (j > 0) edges.emplace_back(i * rows + j, i * rows + j - 1);
    }
  }
  return edges;
}

float Coefficient(const BlockFactor& factor, std::size_t matrix, int rows, int columns, int row,
                  int column) {
  int begin = 0;
  while (row >= begin + SlabRows(PaddedRows(rows) - begin)) {
    begin += SlabRows(PaddedRows(rows) - begin);
  }
  const int slab = SlabRows(PaddedRows(rows) - begin);
  return factor.coefficients[matrix + static_cast<std::size_t>(begin) * columns +
                             static_cast<std::size_t>(column) * slab + (row - begin)];
}

// The two passes as the header writes them.
Eigen::VectorXd Solve(const BlockFactor& factor, const Eigen::VectorXd& right) {
  const auto count = static_cast<Eigen::Index>(factor.order.size());
  Eigen::VectorXd r(count), z(count), x(count);
  for (Eigen::Index p = 0; p < count; ++p) r[p] = right[factor.order[p]];
  for (const auto& block : factor.blocks) {
    const int rows = block.columns + block.below;
    for (int row = 0; row < rows; ++row) {
      double sum = 0.0;
      for (int c = 0; c < block.columns; ++c) {
        sum += Coefficient(factor, block.forward, rows, block.columns, row, c) * r[block.first + c];
      }
      if (row < block.columns) {
        z[block.first + row] = sum;
      } else {
        r[factor.rows[block.rows + row - block.columns]] -= sum;
      }
    }
  }
  for (auto block = factor.blocks.rbegin(); block != factor.blocks.rend(); ++block) {
    for (int row = 0; row < block->columns; ++row) {
      double sum = 0.0;
      for (int c = 0; c < block->below; ++c) {
        sum += Coefficient(factor, block->backward, block->columns, block->below, row, c) *
               z[factor.rows[block->rows + c]];
      }
      z[block->first + row] -= sum;
    }
  }
  for (Eigen::Index p = 0; p < count; ++p) x[factor.order[p]] = z[p];
  return x;
}

TEST(BlockFactor, SolvesWhatADenseFactorSolves) {
  std::mt19937 random(1);
  for (const auto& [columns, rows] : {std::pair(1, 1), {2, 1}, {40, 1}, {7, 7}, {25, 12}}) {
    const int count = columns * rows;
    const Sparse matrix = Springs(count, GridEdges(columns, rows), &random);
    const auto factor = BlockFactor::Factor(matrix);
    ASSERT_TRUE(factor);
    const Eigen::VectorXd right =
        Eigen::VectorXd::NullaryExpr(count, [&] { return Uniform(-1, 1, &random); });
    const Eigen::VectorXd expected = Eigen::MatrixXd(matrix).llt().solve(right);
    EXPECT_LT((Solve(*factor, right) - expected).norm(), 2e-6 * expected.norm());
  }
}

TEST(BlockFactor, PutsEachUnknownIntoOneBlockAndRowsBehindIt) {
  std::mt19937 random(2);
  const auto factor = BlockFactor::Factor(Springs(400, GridEdges(20, 20), &random));
  ASSERT_TRUE(factor);
  std::vector<std::int32_t> order = factor->order;
  std::sort(order.begin(), order.end());
  for (int k = 0; k < 400; ++k) EXPECT_EQ(order[k], k);
  int next = 0;
  for (const auto& block : factor->blocks) {
    EXPECT_EQ(block.first, next);
    next += block.columns;
    for (int k = 0; k < block.below; ++k) {
      EXPECT_GE(factor->rows[block.rows + k], k == 0 ? next : factor->rows[block.rows + k - 1] + 1);
    }
  }
  EXPECT_EQ(next, 400);
}

TEST(BlockFactor, KeepsUnconnectedPartsApart) {
  std::mt19937 random(3);
  // Three grids of 12, 1 and 30 unknowns, their numbers interleaved.
  std::vector<std::pair<int, int>> edges;
  std::vector<int> numbers(43);
  for (int k = 0; k < 43; ++k) numbers[k] = k * 10 % 43;
  for (const auto& [a, b] : GridEdges(4, 3)) edges.emplace_back(numbers[a], numbers[b]);
  for (const auto& [a, b] : GridEdges(6, 5)) edges.emplace_back(numbers[13 + a], numbers[13 + b]);
  const auto factor = BlockFactor::Factor(Springs(43, edges, &random));
  ASSERT_TRUE(factor);
  ASSERT_EQ(factor->components.size(), 3u);
  std::vector<int> part(43);
  for (int k = 0; k < 43; ++k) part[numbers[k]] = k < 12 ? 0 : k < 13 ? 1 : 2;
  for (std::size_t c = 0; c < 3; ++c) {
    const int end = c < 2 ? factor->components[c + 1] : 43;
    for (int p = factor->components[c]; p < end; ++p) {
      EXPECT_EQ(part[factor->order[p]], part[factor->order[factor->components[c]]]);
    }
  }
}

TEST(BlockFactor, RefusesAMatrixThatIsNotPositiveDefinite) {
  Sparse matrix(2, 2);
  const std::vector<Eigen::Triplet<double>> entries{{0, 0, 1}, {1, 1, 1}, {0, 1, 2}, {1, 0, 2}};
  matrix.setFromTriplets(entries.begin(), entries.end());
  const auto factor = BlockFactor::Factor(matrix);
  ASSERT_FALSE(factor);
  EXPECT_EQ(factor.error().code, ErrorCode::kInternal);
}

}  // namespace
}  // namespace posespace
