// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_BLOCK_FACTOR_H_
#define POSESPACE_INTERPOLATION_BLOCK_FACTOR_H_

#include <Eigen/SparseCore>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/result.h"

namespace posespace {

// A symmetric positive definite sparse matrix, factored in double into small dense blocks that are
// kept as float, for solving many right-hand sides fast.
//
// Unknowns are reordered into places, and runs of places form blocks: nodes of an elimination tree.
// With D the pivot of a block (what is left of its diagonal) and B what is left of the rows below,
//
//   forwards,  blocks in order:    z_block = D^-1 r_block,   r_below -= B D^-1 r_block
//   backwards, blocks reversed:    x_block = z_block - (B D^-1)' x_below
//
// Both steps are products with dense matrices: no division, no chain of dependent rows within a
// block.  The forward matrix stacks D^-1 on B D^-1; the backward matrix is (B D^-1)'.
//
// A dense matrix of R rows and C columns is cut into slabs of 16 rows, then one of 8 and one of 4
// as they fit, the last padded with zeros; a slab stores column after column.  So the slab that
// begins at row r begins at coefficient r C.
//
// Immutable once made.
struct BlockFactor {
  struct Block {
    std::int32_t first;    // place
    std::int32_t columns;  // places first, first + 1, ... are this block
    std::int32_t below;    // how many places below it couples with
    std::int32_t rows;     // index of the first of those in `rows`
    std::size_t forward;   // index of its matrices in `coefficients`
    std::size_t backward;
  };

  std::vector<std::int32_t> order;  // the unknown at each place
  std::vector<Block> blocks;
  std::vector<std::int32_t> rows;  // places, ascending within a block
  std::vector<float> coefficients;
  std::vector<std::int32_t> components;  // the first place of each unconnected part of the matrix

  // Fails  kInternal when the matrix is not positive definite.
  static Result<BlockFactor> Factor(const Eigen::SparseMatrix<double>& matrix);
};

// The number of rows that a dense matrix is padded to.
constexpr int PaddedRows(int rows) { return (rows + 3) / 4 * 4; }

// The number of rows of the slab that begins where `rows` of the padded rows are left.
constexpr int SlabRows(int rows) { return rows >= 16 ? 16 : rows >= 8 ? 8 : 4; }

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_BLOCK_FACTOR_H_
