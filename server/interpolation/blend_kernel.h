// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_BLEND_KERNEL_H_
#define POSESPACE_INTERPOLATION_BLEND_KERNEL_H_

#include <cstddef>
#include <cstdint>

#include "interpolation/block_factor.h"

// The arithmetic of batch_blend.h: rigid_blend.h's rigid method in float, by whatever vector
// instructions the processor has.
//
// Poses lie in lanes ("a group"), or one pose is spread over lanes of triangles and rows ("alone").
// Both do the same operations on the same numbers in the same order, so the same pose has the same
// bits either way; with fused multiply-add (AVX2, AVX-512, NEON) also on every processor.

namespace posespace {

// Triangles are stored sixteen at a time: number by number, sixteen of each.
constexpr int kTriangleBlock = 16;
constexpr int kGradientRows = 5;

// What a pose space's blends read.  Lengths are in units of the drawings' size; every array is
// aligned to cache lines.
struct BlendTables {
  int num_poses;
  int num_vertices;
  int num_blocks;  // of triangles
  int num_parts;

  // Per block 4 N + kGradientRows rows of sixteen: of pose 0 the rotation less the pose's mean one,
  // and the stretch xx, xy, yy times the mass; of the other poses the same; then the gradients of
  // corner 1 (x, y) and of corner 2, and the mass: the rest triangle's share of the area.  Blocks
  // are filled up with zeros and corners of a real triangle.
  const float* triangles;
  const std::int32_t* corners;  // per block 3 rows of sixteen: places of the corners

  // The contributions that each place sums, in the order of triangles: numbers
  // (block * 3 + corner) * 16 + triangle, place p's from incident_begin[p] on.
  const std::int32_t* incident;
  const std::int32_t* incident_begin;

  // Boundary edges (a, b), part by part, a part's from boundary_begin[part] on; and for each part
  // the place that its centroid is measured from, and its places.
  const std::int32_t* boundary;
  const std::int32_t* boundary_begin;
  const std::int32_t* part_origin;
  const std::int32_t* part_begin;

  int polishes;  // how often to solve again, before refits, for what rounding left over
  const BlockFactor* factor;
  const float* coefficients;  // factor->coefficients, aligned
};

// Memory for one blend, or one group of them; what is not named here belongs to the kernel.
struct BlendScratch {
  float* rotation_weights;  // N rows of lanes
  float* stretch_weights;   // N rows of lanes
  double* moments;          // per part 3 rows of lanes: area and its first moments, see Solve
  float* placing;           // 2 + 2 parts rows of lanes: see Place
  float* clear;             // a row of lanes: greater than 0 where certainly no triangle is folded
  float* x;                 // a row of lanes a place, and one to spare, each
  float* y;
  float* z_x;
  float* z_y;
  float* step_x;
  float* step_y;
  float* triangles;  // 5 rows of lanes a triangle; alone, 6 more, and 2 a place and 64 to spare
};

// Solves for x and y, places' coordinates (in z_x, z_y), and each part's moments: with o its
// origin, sums over its boundary edges (a, b) of cross = (a - o) x (b - o) and of
// cross * ((a - o) + (b - o)).
//
// Then each vertex is placed at  ( c x - s y + t_x,  s x + c y + t_y ), with placing = c, s and
// then t_x, t_y of each part, and `clear` found from the float coordinates.  out[lane] takes x0 y0
// x1 y1
// ... in the order of the mesh's vertices; lanes >= count are left out.
struct BlendKernel {
  int lanes;  // of a group
  void (*solve_group)(const BlendTables&, int refits, const BlendScratch&);
  void (*place_group)(const BlendTables&, int count, const BlendScratch&, float* const* out);
  void (*solve_alone)(const BlendTables&, int refits, const BlendScratch&);  // rows of one lane
  void (*place_alone)(const BlendTables&, const BlendScratch&, float* out);
  const char* instructions;  // "AVX2", for people
};

// The fastest that this processor has.
const BlendKernel& BestBlendKernel();

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_BLEND_KERNEL_H_
