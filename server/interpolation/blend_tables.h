// SPDX-License-Identifier: Apache-2.0
#ifndef POSESPACE_INTERPOLATION_BLEND_TABLES_H_
#define POSESPACE_INTERPOLATION_BLEND_TABLES_H_

#include <hwy/aligned_allocator.h>

#include <vector>

#include "geometry/result.h"
#include "interpolation/blend_kernel.h"
#include "interpolation/rigid_model.h"

namespace posespace {

// Memory that begins at a cache line.
template <typename T>
using AlignedArray = hwy::AlignedFreeUniquePtr<T[]>;

// A pose space's numbers as the kernel reads them, laid out once.  Immutable.
struct BlendLayout {
  BlockFactor factor;
  AlignedArray<float> coefficients, triangle_numbers;
  AlignedArray<std::int32_t> corners;
  std::vector<std::int32_t> incident, incident_begin, boundary, boundary_begin, part_origin,
      part_begin;
  std::vector<int> model_part;  // of the tables' parts, the model's numbers
  std::vector<int> place_of;    // of the mesh's vertices
  double size = 0.0;            // drawing pixels a unit: the root of the rest triangles' area
  BlendTables tables = {};      // points into the above, and at `factor`

  BlendLayout() = default;
  BlendLayout(const BlendLayout&) = delete;
  BlendLayout& operator=(const BlendLayout&) = delete;

  // Fails  kInternal when the problem is singular in double.
  Result<void> Fill(const RigidModel& model);

  int PartOf(int vertex) const;  // which of the tables' parts
};

}  // namespace posespace

#endif  // POSESPACE_INTERPOLATION_BLEND_TABLES_H_
