// SPDX-License-Identifier: Apache-2.0
#include "interpolation/block_factor.h"

#include <Eigen/Cholesky>
#include <Eigen/OrderingMethods>
#include <algorithm>
#include <utility>

namespace posespace {
namespace {

using Matrix = Eigen::SparseMatrix<double>;
using Indices = std::vector<std::int32_t>;

// About how many cycles a block costs, one right-hand side alone: every slab streams its columns
// after a start, and each row below is gathered and scattered.  Chosen by measurement; decides only
// how blocks are cut.
double Cost(int columns, int below) {
  const auto slabs = [](int rows) {
    int count = 0;
    for (int left = PaddedRows(rows); left > 0; left -= SlabRows(left)) ++count;
    return count;
  };
  constexpr double kStart = 4.0, kRow = 2.0, kBlock = 12.0;
  return kBlock + kRow * below + slabs(columns + below) * (kStart + columns) +
         slabs(columns) * (kStart + below);
}

// The elimination tree's nodes in elimination order: which unknowns each eliminates together, and
// which it couples with later.
struct Node {
  Indices columns;
  Indices below;
  int parent = -1;
};

// The rows below the diagonal of each column of the factor, in the given order of elimination.
std::vector<Indices> FactorPattern(const Matrix& matrix, const Indices& place_of,
                                   const Indices& order) {
  const int count = static_cast<int>(order.size());
  std::vector<Indices> pattern(order.size());
  std::vector<Indices> children(order.size());
  Indices marked(order.size(), -1);
  for (int j = 0; j < count; ++j) {
    Indices& rows = pattern[j];
    const auto add = [&](int row) {
      if (row <= j || marked[row] == j) return;
      marked[row] = j;
      rows.push_back(row);
    };
    for (Matrix::InnerIterator entry(matrix, order[j]); entry; ++entry) add(place_of[entry.row()]);
    for (const int child : children[j]) {
      for (const int row : pattern[child]) add(row);
    }
    std::sort(rows.begin(), rows.end());
    if (!rows.empty()) children[rows.front()].push_back(j);
  }
  return pattern;
}

// Merges columns along the elimination tree wherever the merged block is cheaper.  A block takes on
// its child's columns and needs no further rows below.
std::vector<Node> MergeColumns(std::vector<Indices> pattern) {
  const int count = static_cast<int>(pattern.size());
  std::vector<Node> nodes(pattern.size());
  std::vector<Indices> children(pattern.size());
  for (int j = 0; j < count; ++j) {
    Node& node = nodes[j];
    node.below = std::move(pattern[j]);
    if (!node.below.empty()) node.parent = node.below.front();
    Indices kept;
    for (const int child : children[j]) {
      const int own = static_cast<int>(node.columns.size()) + 1;
      const int its = static_cast<int>(nodes[child].columns.size());
      const int below = static_cast<int>(node.below.size());
      const double apart =
          Cost(its, static_cast<int>(nodes[child].below.size())) + Cost(own, below);
      if (Cost(own + its, below) > apart) {
        kept.push_back(child);
        continue;
      }
      node.columns.insert(node.columns.end(), nodes[child].columns.begin(),
                          nodes[child].columns.end());
      nodes[child].columns.clear();
      for (const int grandchild : children[child]) {
        nodes[grandchild].parent = j;
        kept.push_back(grandchild);
      }
    }
    node.columns.push_back(j);
    std::sort(node.columns.begin(), node.columns.end());
    children[j] = std::move(kept);
    if (node.parent >= 0) children[node.parent].push_back(j);
  }

  // Children before parents, each tree in one run.
  std::vector<Node> sorted;
  Indices number(pattern.size(), -1), roots, stack;
  for (int j = 0; j < count; ++j) {
    if (nodes[j].parent >= 0 || nodes[j].columns.empty()) continue;
    roots.clear();
    stack.assign(1, j);
    while (!stack.empty()) {
      const int next = stack.back();
      stack.pop_back();
      roots.push_back(next);
      stack.insert(stack.end(), children[next].begin(), children[next].end());
    }
    for (auto next = roots.rbegin(); next != roots.rend(); ++next) {
      number[*next] = static_cast<int>(sorted.size());
      sorted.push_back(std::move(nodes[*next]));
    }
  }
  for (Node& node : sorted) node.parent = node.parent < 0 ? -1 : number[node.parent];
  return sorted;
}

// Appends a dense matrix as BlockFactor stores it and returns where it begins.
std::size_t Append(const Eigen::MatrixXd& matrix, std::vector<float>* coefficients) {
  const std::size_t begin = (coefficients->size() + 15) / 16 * 16;  // a cache line
  coefficients->resize(begin);
  const int rows = static_cast<int>(matrix.rows());
  for (int r = 0, slab; r < PaddedRows(rows); r += slab) {
    slab = SlabRows(PaddedRows(rows) - r);
    for (Eigen::Index c = 0; c < matrix.cols(); ++c) {
      for (int k = r; k < r + slab; ++k) {
        coefficients->push_back(k < rows ? static_cast<float>(matrix(k, c)) : 0.0f);
      }
    }
  }
  return begin;
}

}  // namespace

Result<BlockFactor> BlockFactor::Factor(const Matrix& matrix) {
  // An order that fills little, refined to one in which each block is one run of places.
  Eigen::PermutationMatrix<Eigen::Dynamic> fill_reducing;
  Eigen::AMDOrdering<int>()(matrix, fill_reducing);
  const Indices first_order(fill_reducing.indices().begin(), fill_reducing.indices().end());
  Indices place_of(first_order.size());
  for (std::size_t p = 0; p < first_order.size(); ++p) {
    place_of[first_order[p]] = static_cast<int>(p);
  }
  std::vector<Node> nodes = MergeColumns(FactorPattern(matrix, place_of, first_order));

  BlockFactor factor;
  Indices moved(first_order.size());  // from places of the first order
  for (const Node& node : nodes) {
    const int first = static_cast<int>(factor.order.size());
    factor.blocks.push_back({first, static_cast<int>(node.columns.size()),
                             static_cast<int>(node.below.size()),
                             static_cast<int>(factor.rows.size()), 0, 0});
    factor.rows.resize(factor.rows.size() + node.below.size());
    for (const int column : node.columns) {
      moved[column] = static_cast<int>(factor.order.size());
      factor.order.push_back(first_order[column]);
    }
  }
  for (std::size_t b = 0; b < nodes.size(); ++b) {
    Block& block = factor.blocks[b];
    const auto rows = factor.rows.begin() + block.rows;
    std::transform(nodes[b].below.begin(), nodes[b].below.end(), rows,
                   [&](int place) { return moved[place]; });
    std::sort(rows, rows + block.below);
    if (block.below == 0) {
      factor.components.push_back(block.first + block.columns);  // where it ends, the next begins
    }
  }
  factor.components.insert(factor.components.begin(), 0);
  factor.components.pop_back();
  for (std::size_t p = 0; p < factor.order.size(); ++p) {
    place_of[factor.order[p]] = static_cast<int>(p);
  }

  // Multifrontal: each block's front takes the matrix's own entries and what its children leave.
  std::vector<std::vector<int>> children(nodes.size());
  std::vector<Eigen::MatrixXd> left(nodes.size());
  Indices local(first_order.size());
  for (std::size_t b = 0; b < nodes.size(); ++b) {
    Block& block = factor.blocks[b];
    const int size = block.columns + block.below;
    const auto* const rows = factor.rows.data() + block.rows;
    for (int k = 0; k < block.columns; ++k) local[block.first + k] = k;
    for (int k = 0; k < block.below; ++k) local[rows[k]] = block.columns + k;

    Eigen::MatrixXd front = Eigen::MatrixXd::Zero(size, size);
    for (int k = 0; k < block.columns; ++k) {
      for (Matrix::InnerIterator entry(matrix, factor.order[block.first + k]); entry; ++entry) {
        const int place = place_of[entry.row()];
        if (place >= block.first) front(local[place], k) += entry.value();
      }
    }
    for (const int child : children[b]) {
      const Block& its = factor.blocks[child];
      const auto* const its_rows = factor.rows.data() + its.rows;
      for (int c = 0; c < its.below; ++c) {
        for (int r = 0; r < its.below; ++r) {
          front(local[its_rows[r]], local[its_rows[c]]) += left[child](r, c);
        }
      }
      left[child].resize(0, 0);
    }

    const Eigen::LLT<Eigen::MatrixXd> pivot(front.topLeftCorner(block.columns, block.columns));
    if (pivot.info() != Eigen::Success) {
      return Error{ErrorCode::kInternal, "a matrix that must be positive definite is not", {}};
    }
    Eigen::MatrixXd forward(size, block.columns);
    forward.topRows(block.columns) =
        pivot.solve(Eigen::MatrixXd::Identity(block.columns, block.columns));
    const auto coupling = front.bottomLeftCorner(block.below, block.columns);
    forward.bottomRows(block.below) = coupling * forward.topRows(block.columns);
    left[b] = front.bottomRightCorner(block.below, block.below) -
              forward.bottomRows(block.below) * coupling.transpose();
    block.forward = Append(forward, &factor.coefficients);
    block.backward = Append(forward.bottomRows(block.below).transpose(), &factor.coefficients);
    if (nodes[b].parent >= 0) children[nodes[b].parent].push_back(static_cast<int>(b));
  }
  return factor;
}

}  // namespace posespace
